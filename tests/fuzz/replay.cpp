// The targets over files, in every build:  replay [--read] TARGET FOLDER ...
//
// Runs all files of the folders. --read: these are seeds, and each must be read, not refused; a fuzzer learns nothing from
// seeds that end at the first byte. Exit code 4 where one is refused; a finding ends the program.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

#include "tests/fuzz/target.h"

namespace isowave::fuzz {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> filesIn(const fs::path& folder) {
    std::vector<fs::path> files;
    if (!fs::is_directory(folder)) return files;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

std::string bytesOf(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// How many were refused although they must not be.
int replay(const Target& target, const fs::path& folder, bool mustRead, int& count) {
    int refused = 0;
    for (const fs::path& file : filesIn(folder)) {
        std::printf("%s\n", file.c_str());
        std::fflush(stdout);
        ++count;
        if (target.run(bytesOf(file)) == Answer::refused && mustRead) {
            std::printf("  is refused, but a seed must be read: %s\n", lastMessage().c_str());
            ++refused;
        }
    }
    return refused;
}

int run(int argc, char** argv) {
    const bool mustRead = argc > 1 && std::strcmp(argv[1], "--read") == 0;
    const int first = mustRead ? 2 : 1;
    int refused = 0, count = 0;
    for (const Target& target : targets())
        for (int i = first + 1; i < argc && target.name == argv[first]; ++i)
            refused += replay(target, argv[i], mustRead, count);
    std::printf("%d files, %d refused that must be read\n", count, refused);
    if (mustRead && count == 0) return 1;
    return refused > 0 ? 4 : 0;
}

}  // namespace
}  // namespace isowave::fuzz

int main(int argc, char** argv) { return isowave::fuzz::run(argc, argv); }
