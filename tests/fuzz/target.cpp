#include "tests/fuzz/target.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace isowave::fuzz {
namespace fs = std::filesystem;

void require(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "finding: %s\n", what);
    std::abort();
}

namespace {

std::string& keptMessage() {
    static std::string message;
    return message;
}

}  // namespace

const std::string& lastMessage() { return keptMessage(); }

void requireOneLine(const std::string& message) {
    keptMessage() = message;
    const auto control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; };
    const bool good =
        !message.empty() && message.size() < 4096 && std::none_of(message.begin(), message.end(), control);
    if (!good) std::fprintf(stderr, "message: %s\n", message.c_str());
    require(good, "a message that is not one line of printable text");
}

namespace {

struct Folder {
    fs::path path;

    Folder() {
        const fs::path shared = "/dev/shm";
        path = (fs::is_directory(shared) ? shared : fs::temp_directory_path()) /
               ("isowave-fuzz-" + std::to_string(::getpid()));
        fs::create_directories(path);
        std::ofstream voxels(path / "voxels.raw", std::ios::binary);
        for (int i = 0; i < 4096; ++i) voxels.put(static_cast<char>(i * 7));
    }
    ~Folder() {
        std::error_code error;
        fs::remove_all(path, error);
    }
};

}  // namespace

const fs::path& scratchFolder() {
    static const Folder folder;
    return folder.path;
}

void requireNamed(const std::string& message, const std::string& object) {
    const bool named =
        message.find(object) != message.npos || (object.starts_with(scratchFolder().string()) &&
                                                 message.find(scratchFolder().string()) != message.npos);
    if (!named) std::fprintf(stderr, "message: %s\n", message.c_str());
    require(named, "a message that does not name the file");
}

fs::path fileOf(std::string_view bytes, const std::string& name) {
    fs::path path = scratchFolder() / name;
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.flush();
    require(file.good(), "the scratch file cannot be written");
    return path;
}

}  // namespace isowave::fuzz
