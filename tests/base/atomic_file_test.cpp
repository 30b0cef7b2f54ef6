#include "base/atomic_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "base/error.h"

namespace isowave {
namespace {

std::filesystem::path freshFolder(const std::string& name) {
    const auto folder = std::filesystem::temp_directory_path() / ("isowave_atomic_" + name);
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder;
}

TEST(AtomicFile, AppearsOnlyAtCommit) {
    const auto folder = freshFolder("commit");
    {
        AtomicFile file(folder / "a.txt");
        file.stream() << "hello";
        EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
        file.commit();
    }
    EXPECT_EQ(std::filesystem::file_size(folder / "a.txt"), 5u);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

TEST(AtomicFile, LeavesNothingWithoutCommit) {
    const auto folder = freshFolder("drop");
    { AtomicFile(folder / "a.txt").stream() << "hello"; }
    EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(AtomicFile, KeepsTheOldFileWhenTheNewOneFails) {
    const auto folder = freshFolder("old");
    std::ofstream(folder / "a.txt") << "old";
    { AtomicFile(folder / "a.txt").stream() << "new one"; }
    EXPECT_EQ(std::filesystem::file_size(folder / "a.txt"), 3u);
}

TEST(AtomicFile, RefusesAMissingFolderAndAFolder) {
    const auto folder = freshFolder("missing");
    EXPECT_THROW(AtomicFile(folder / "no" / "a.txt"), OperationError);
    EXPECT_THROW(AtomicFile{folder}, OperationError);
}

TEST(AtomicFile, FollowsALinkAndKeepsIt) {
    const auto folder = freshFolder("link");
    std::ofstream(folder / "target.txt") << "old";
    std::filesystem::create_symlink("target.txt", folder / "link.txt");
    AtomicFile file(folder / "link.txt");
    file.stream() << "new one";
    file.commit();
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.txt"));
    EXPECT_EQ(std::filesystem::file_size(folder / "target.txt"), 7u);
}

TEST(AtomicFile, WritesToAPipeOrDeviceInsteadOfReplacingIt) {
    const auto folder = freshFolder("device");
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
    const auto folder = freshFolder("full");
    // The temporary name is a link to /dev/full: every flush fails as on a full disk.
    const auto temporary = folder / ("a.txt.part-" + std::to_string(::getpid()));
    std::filesystem::create_symlink("/dev/full", temporary);
    AtomicFile file(folder / "a.txt");
    file.stream() << "hello";
    EXPECT_THROW(file.commit(), OperationError);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
}

}  // namespace
}  // namespace isowave
