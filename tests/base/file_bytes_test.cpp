#include "base/file_bytes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <vector>

#include "isowave/error.h"
#include "temp_folder.h"

namespace isowave {
namespace {

// A file of `size` bytes, longer than the stream's buffer where size is.
std::string put(const std::filesystem::path& path, std::size_t size) {
    std::mt19937 random(7);
    std::string bytes(size, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    std::ofstream(path, std::ios::binary) << bytes;
    return bytes;
}

TEST(FileBytes, GivesWhatThereIs) {
    const test::TempFolder folder;
    const std::string whole = put(folder / "a", 1000);
    const FileBytes bytes(folder / "a", "a test file");
    EXPECT_EQ(bytes.size(), 1000);
    std::string got(300, '\0');
    EXPECT_EQ(bytes.read(500, got.data(), 300), 300u);
    EXPECT_EQ(got, whole.substr(500, 300));
    EXPECT_EQ(bytes.read(900, got.data(), 300), 100u);
    EXPECT_EQ(got.substr(0, 100), whole.substr(900));
    EXPECT_EQ(bytes.read(1000, got.data(), 300), 0u);
}

TEST(FileBytes, KnowsTheHolesOfASparseFile) {
    const test::TempFolder folder;
    constexpr std::int64_t kMiddle = 1 << 20, kSize = 2 << 20;
    {
        std::ofstream file(folder / "sparse", std::ios::binary);
        file.seekp(kMiddle);
        file << std::string(kSize - kMiddle, 'x');
    }
    const FileBytes bytes(folder / "sparse", "a test file");
    EXPECT_FALSE(bytes.isHole(kMiddle, kSize));
    EXPECT_FALSE(bytes.isHole(0, kSize));
    EXPECT_FALSE(bytes.isHole(0, kSize + 1)) << "beyond the end";
    // Where the file system has no holes the answer is false, which is always safe.
    char first = 'x';
    if (bytes.isHole(0, kMiddle / 2)) {
        EXPECT_EQ(bytes.read(0, &first, 1), 1u);
        EXPECT_EQ(first, '\0');
    }
}

TEST(FileBytes, RefusesWhatIsNotAFile) {
    const test::TempFolder folder;
    EXPECT_THROW(FileBytes(folder / "none", "a test file"), InputError);
    try {
        FileBytes(folder.path(), "a test file");
        FAIL();
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("is a folder; expected a test file"), std::string::npos);
    }
}

// std::ifstream as the oracle: reads of all lengths, moves from all places, near and far, one byte at a time.
TEST(FileStream, DoesWhatAnIfstreamDoes) {
    const test::TempFolder folder;
    const std::int64_t size = 700'001;  // not a multiple of a block
    put(folder / "a", size);
    const FileBytes bytes(folder / "a", "a test file");
    FileStream stream(bytes);
    std::ifstream oracle(folder / "a", std::ios::binary);
    std::mt19937 random(1);
    std::vector<char> a(1 << 19), b(1 << 19);
    for (int i = 0; i < 20'000; ++i) {
        const std::int64_t at = oracle.tellg();
        ASSERT_EQ(stream.tellg(), std::streampos(at));
        const std::int64_t reach = i % 100 == 0 ? size : 200;
        const std::int64_t to = std::clamp<std::int64_t>(
            at + static_cast<std::int64_t>(random() % (2 * reach)) - reach, 0, size - 1);
        switch (random() % 4) {
            case 0:
                stream.seekg(to), oracle.seekg(to);
                break;
            case 1:
                stream.seekg(to - at, std::ios::cur), oracle.seekg(to - at, std::ios::cur);
                break;
            case 2:
                stream.seekg(to - size, std::ios::end), oracle.seekg(to - size, std::ios::end);
                break;
            default: {
                const auto count =
                    std::min<std::int64_t>(random() % (i % 50 == 0 ? a.size() : 300), size - at);
                stream.read(a.data(), count), oracle.read(b.data(), count);
                ASSERT_EQ(std::string_view(a.data(), count), std::string_view(b.data(), count));
                if (count < size - at) {
                    ASSERT_EQ(stream.get(), oracle.get());
                }
            }
        }
    }
}

TEST(FileStream, ThrowsWhereBytesAreMissing) {
    const test::TempFolder folder;
    put(folder / "a", 100);
    const FileBytes bytes(folder / "a", "a test file");
    char to[64];
    FileStream stream(bytes);
    stream.seekg(90);
    EXPECT_THROW(stream.read(to, 11), std::ios_base::failure);
    FileStream behind(bytes);
    behind.seekg(1000);
    EXPECT_THROW(behind.read(to, 1), std::ios_base::failure);
    FileStream before(bytes);
    EXPECT_THROW(before.seekg(-1), std::ios_base::failure);
}

}  // namespace
}  // namespace isowave
