#include "base/read_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <thread>

#include "isowave/error.h"
#include "temp_folder.h"

namespace isowave {
namespace {

std::string refusal(const std::filesystem::path& path) {
    try {
        readFile(path, "a mesh file");
        return "";
    } catch (const InputError& error) {
        return error.what();
    }
}

TEST(ReadFile, GivesEveryByte) {
    const test::TempFolder folder("read");
    const std::string bytes("a\0\r\n\xff", 5);
    std::ofstream(folder / "a", std::ios::binary) << bytes;
    EXPECT_EQ(readFile(folder / "a", "a mesh file"), bytes);
}

TEST(ReadFile, GivesFilesLargerThanAnyBuffer) {
    const test::TempFolder folder("large");
    std::string bytes(5'000'000, 'x');
    for (std::size_t i = 0; i < bytes.size(); i += 997) bytes[i] = static_cast<char>(i % 251);
    std::ofstream(folder / "a", std::ios::binary) << bytes;
    EXPECT_TRUE(readFile(folder / "a", "a mesh file") == bytes);
}

TEST(ReadFile, ReadsPipes) {
    const test::TempFolder folder("pipe");
    const std::filesystem::path pipe = folder / "p";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    std::thread writer([&] { std::ofstream(pipe, std::ios::binary) << std::string(200'000, 'y'); });
    const std::string bytes = readFile(pipe, "a mesh file");
    writer.join();
    EXPECT_TRUE(bytes == std::string(200'000, 'y'));
}

TEST(ReadFile, SaysWhatStandsWhereAFileShould) {
    const test::TempFolder folder("refuse");
    const auto ends = [&](const char* name, const std::string& words) {
        EXPECT_EQ(refusal(folder / name), (folder / name).string() + ": " + words);
    };
    std::ofstream(folder / "empty").flush();
    std::ofstream(folder / "zipped", std::ios::binary) << "\x1f\x8b\x08 and so on";
    std::filesystem::create_directory(folder / "folder");
    ends("none", "no such file");
    ends("folder", "is a folder; expected a mesh file");
    ends("empty", "is empty; expected a mesh file");
    ends("zipped", "is compressed by gzip; gunzip it first");
}

}  // namespace
}  // namespace isowave
