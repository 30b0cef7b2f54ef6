#include "base/read_file.h"

#include <fmt/format.h>

#include <fstream>

#include "isowave/error.h"

namespace isowave {

std::string readFile(const std::filesystem::path& path, std::string_view expected) {
    const std::string name = path.string();
    std::error_code error;
    if (!std::filesystem::exists(path, error)) throw InputError(name, "no such file");
    if (std::filesystem::is_directory(path, error))
        throw InputError(name, fmt::format("is a folder; expected {}", expected));
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw InputError(name, "cannot be opened; check its permissions");
    std::string bytes(std::istreambuf_iterator<char>(stream), {});
    if (bytes.empty()) throw InputError(name, fmt::format("is empty; expected {}", expected));
    if (bytes.starts_with("\x1f\x8b")) throw InputError(name, "is compressed by gzip; gunzip it first");
    return bytes;
}

}  // namespace isowave
