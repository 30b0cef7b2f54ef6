#include "tests/fuzz/zarr.h"

#include <fstream>

#include "tests/fuzz/image.h"

namespace isowave::fuzz {
namespace {

namespace fs = std::filesystem;

// What stands before the next byte 0, which is taken away.
std::string_view next(std::string_view& bytes) {
    const std::size_t end = std::min(bytes.find('\0'), bytes.size());
    const std::string_view part = bytes.substr(0, end);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    return part;
}

void put(const fs::path& path, std::string_view bytes) {
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary | std::ios::trunc)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

fs::path storeOf(std::string_view bytes) {
    const fs::path store = scratchFolder() / "store.zarr";
    fs::remove_all(store);
    const std::string_view array = next(bytes), attributes = next(bytes);
    const fs::path folder = attributes.empty() ? store : store / "0";
    put(folder / ".zarray", array);
    if (!attributes.empty()) {
        put(store / ".zgroup", R"({"zarr_format": 2})");
        put(store / ".zattrs", attributes);
    }
    for (const char* name : {"0.0", "0.0.0", "0.0.0.0", "0.0.0.0.0", "0/0/0/0/0"}) put(folder / name, bytes);
    return store;
}

Answer read(std::string_view bytes) {
    const fs::path store = storeOf(bytes);
    ImageReadOptions options = imageOptions();
    if (answerOf(store.string(), [&] { readBothWays(store, options); }) == Answer::read) return Answer::read;
    options.channel = options.time = 1;
    options.nan = 0.0f;
    return answerOf(store.string(), [&] { readBothWays(store, options); });
}

}  // namespace

std::vector<Target> zarrTargets() { return {{"zarr", read}}; }

}  // namespace isowave::fuzz
