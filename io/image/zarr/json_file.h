// The JSON files of a Zarr store.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace isowave::imageio {

// Throws InputError: no such file, larger than 64 MB, no JSON, something else than an object.
nlohmann::json readJsonObject(const std::filesystem::path& file);

}  // namespace isowave::imageio
