// A folder for a test's files, and what the tests of isowave/image.h do with them.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "isowave/error.h"
#include "isowave/image.h"

namespace isowave::test {

class ImageFiles : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
        std::replace(name.begin(), name.end(), '/', '_');
        folder =
            std::filesystem::temp_directory_path() / ("isowave_" + name + "_" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder);
    }
    void TearDown() override { std::filesystem::remove_all(folder); }
    std::filesystem::path folder;
};

inline std::string bytesOf(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

// Removed first: ext4 takes a file that is cut to nothing and written again for one worth flushing to the
// disk.
inline std::filesystem::path put(const std::filesystem::path& path, const std::string& bytes) {
    std::filesystem::remove(path);
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path;
}

// The message of the InputError that readImage() throws, which must be one line that begins with the path; ""
// when it succeeds. Anything else escapes and fails the test.
inline std::string refusal(const std::filesystem::path& path, const ImageReadOptions& options = {}) {
    try {
        readImage(path, options);
        return "";
    } catch (const InputError& e) {
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        return e.what();
    }
}

}  // namespace isowave::test
