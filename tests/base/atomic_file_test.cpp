#include "base/atomic_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "isowave/error.h"
#include "temp_folder.h"

namespace isowave {
namespace {

TEST(AtomicFile, AppearsOnlyAtCommit) {
    const test::TempFolder folder("commit");
    {
        AtomicFile file(folder / "a.txt");
        file.stream() << "hello";
        EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
        file.commit();
    }
    EXPECT_EQ(std::filesystem::file_size(folder / "a.txt"), 5u);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(AtomicFile, LeavesNothingWithoutCommit) {
    const test::TempFolder folder("drop");
    { AtomicFile(folder / "a.txt").stream() << "hello"; }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(AtomicFile, KeepsTheOldFileWhenTheNewOneFails) {
    const test::TempFolder folder("old");
    std::ofstream(folder / "a.txt") << "old";
    { AtomicFile(folder / "a.txt").stream() << "new one"; }
    EXPECT_EQ(std::filesystem::file_size(folder / "a.txt"), 3u);
}

// Larger than what the disk is asked to begin with at a time; a byte at the front is written again at the
// end.
TEST(AtomicFile, HoldsEveryByteOfALargeFile) {
    const test::TempFolder folder("large");
    std::string expected;
    AtomicFile file(folder / "a");
    for (int piece = 0; piece < 20; ++piece) {
        const std::string bytes(1'000'003, static_cast<char>('a' + piece));
        expected += bytes;
        file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    }
    file.stream().seekp(5);
    file.stream() << 'Z';
    expected[5] = 'Z';
    file.commit();
    std::ifstream in(folder / "a", std::ios::binary);
    EXPECT_TRUE(std::string(std::istreambuf_iterator<char>(in), {}) == expected);
}

TEST(AtomicFile, RefusesAMissingFolderAndAFolder) {
    const test::TempFolder folder("missing");
    EXPECT_THROW(AtomicFile(folder / "no" / "a.txt"), OperationError);
    EXPECT_THROW(AtomicFile{folder.path()}, OperationError);
}

TEST(AtomicFile, FollowsALinkAndKeepsIt) {
    const test::TempFolder folder("link");
    std::ofstream(folder / "target.txt") << "old";
    std::filesystem::create_symlink("target.txt", folder / "link.txt");
    AtomicFile file(folder / "link.txt");
    file.stream() << "new one";
    file.commit();
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.txt"));
    EXPECT_EQ(std::filesystem::file_size(folder / "target.txt"), 7u);
}

TEST(AtomicFile, FollowsLinksToWhatIsNotThereYet) {
    const test::TempFolder folder("dangling");
    std::filesystem::create_directory(folder / "sub");
    std::filesystem::create_symlink("sub/second.txt", folder / "first.txt");
    std::filesystem::create_symlink(folder / "target.txt", folder / "sub/second.txt");
    AtomicFile file(folder / "first.txt");
    file.stream() << "hello";
    file.commit();
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "first.txt"));
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "sub/second.txt"));
    EXPECT_EQ(std::filesystem::file_size(folder / "target.txt"), 5u);
    // Links that lead back to themselves, and into folders that are not there, are places like any other.
    std::filesystem::create_symlink("circle.txt", folder / "circle.txt");
    std::filesystem::create_symlink("none/a.txt", folder / "none.txt");
    EXPECT_THROW(AtomicFile(folder / "circle.txt"), OperationError);
    EXPECT_THROW(AtomicFile(folder / "none.txt"), OperationError);
}

TEST(AtomicFile, WritesToAPipeOrDeviceInsteadOfReplacingIt) {
    const test::TempFolder folder("device");
    std::filesystem::create_symlink("/dev/null", folder / "null");
    AtomicFile file(folder / "null");
    file.stream() << "gone";
    file.commit();
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "null"));
    // A place whose very name cannot be looked at is refused like any other.
    EXPECT_THROW(AtomicFile(folder / std::string(5000, 'x')), OperationError);
}

TEST(AtomicFile, SaysThatTheDiskIsFull) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
    const test::TempFolder folder("full");
    // The temporary name is a link to /dev/full: every flush fails as on a full disk.
    const auto temporary = folder / ("a.txt.part-" + std::to_string(::getpid()));
    std::filesystem::create_symlink("/dev/full", temporary);
    AtomicFile file(folder / "a.txt");
    file.stream() << "hello";
    EXPECT_THROW(file.commit(), OperationError);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
}

TEST(TempFolder, IsOfThisProcessAndGoneAfterwards) {
    std::filesystem::path path;
    {
        const test::TempFolder folder("a"), other("b");
        path = folder.path();
        EXPECT_NE(path, other.path());
        EXPECT_NE(path.string().find(std::to_string(::getpid())), std::string::npos);
        std::ofstream(folder / "file") << "content";
        EXPECT_TRUE(std::filesystem::exists(path / "file"));
    }
    EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace isowave
