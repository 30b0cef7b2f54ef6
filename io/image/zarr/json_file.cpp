#include "io/image/zarr/json_file.h"

#include "base/read_file.h"
#include "isowave/error.h"

namespace isowave::imageio {

nlohmann::json readJsonObject(const std::filesystem::path& file) {
    constexpr std::uintmax_t kMostBytes = 64 << 20;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored) &&
        std::filesystem::file_size(file, ignored) > kMostBytes)
        throw InputError(file.string(), "is larger than 64 MB; expected a few lines of JSON");
    // Depth is bounded, so that brackets without end do not end the stack.
    const auto shallow = [](int depth, nlohmann::json::parse_event_t, nlohmann::json&) { return depth < 64; };
    nlohmann::json keys = nlohmann::json::parse(readFile(file, "JSON"), shallow, /*allow_exceptions*/ false);
    if (!keys.is_object())
        throw InputError(file.string(), keys.is_discarded() ? "is no JSON; it is truncated or damaged"
                                                            : "is no JSON object; expected {...}");
    return keys;
}

}  // namespace isowave::imageio
