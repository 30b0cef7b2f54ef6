#include "base/forked_child.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <new>
#include <stdexcept>
#include <thread>
#include <vector>

#include "isowave/error.h"

namespace isowave {
namespace {

using testing::HasSubstr;

bool noChildIsLeft() { return ::waitpid(-1, nullptr, WNOHANG) < 0; }

TEST(ForkedChild, GivesBackEveryByte) {
    std::string bytes(5'000'000, 'x');
    for (std::size_t i = 0; i < bytes.size(); i += 97) bytes[i] = static_cast<char>(i % 251);
    const ChildAnswer answer = runInChild([&] { return bytes; });
    EXPECT_EQ(answer.failure, "");
    EXPECT_TRUE(answer.bytes == bytes);
    EXPECT_EQ(runInChild([] { return std::string(); }).failure, "");
}

TEST(ForkedChild, ChangesNothingHere) {
    int value = 1;
    EXPECT_EQ(runInChild([&] { return value = 2, std::to_string(value); }).bytes, "2");
    EXPECT_EQ(value, 1);
}

TEST(ForkedChild, SaysWhichSignalEndedIt) {
    EXPECT_THAT(runInChild([]() -> std::string { std::abort(); }).failure, HasSubstr("signal 6 (Aborted)"));
    EXPECT_THAT(runInChild([] { return std::raise(SIGSEGV), std::string("not reached"); }).failure,
                HasSubstr("signal 11 (Segmentation fault)"));
    EXPECT_TRUE(noChildIsLeft());
}

TEST(ForkedChild, TakesNoAnswerFromAChildThatExits) {
    EXPECT_EQ(runInChild([]() -> std::string { ::_exit(0); }).failure, "ended itself with code 0");
}

// A null page is read in earnest; the compiler may not see that it is.
TEST(ForkedChild, OutlivesABadPointer) {
    volatile int* volatile nowhere = nullptr;
    const std::string failure = runInChild([&] { return std::to_string(*nowhere); }).failure;
    EXPECT_NE(failure, "");  // a sanitizer ends the process itself, so signal 11 is not promised
}

TEST(ForkedChild, HasALimitOfMemory) {
    const ChildLimits limits{.memoryBytes = 200'000'000};
    const auto allocate = [](std::size_t bytes) {
        return [bytes] {
            std::vector<char*> blocks;
            for (std::size_t i = 0; i < bytes / 1'000'000; ++i) {
                blocks.push_back(static_cast<char*>(std::malloc(1'000'000)));
                if (!blocks.back()) throw std::bad_alloc();
                blocks.back()[i] = 1;
            }
            return std::to_string(blocks.size());
        };
    };
    EXPECT_EQ(runInChild(allocate(50'000'000), limits).bytes, "50");
    EXPECT_EQ(runInChild(allocate(2'000'000'000), limits).failure, "needs more than 200 MB of memory");
}

TEST(ForkedChild, HasALimitOfTime) {
    const ChildLimits limits{.seconds = 1};
    const auto loop = []() -> std::string {
        volatile bool forever = true;
        while (forever) {
        }
        return {};
    };
    EXPECT_EQ(runInChild(loop, limits).failure, "took longer than 1 s");
    EXPECT_TRUE(noChildIsLeft());
}

TEST(ForkedChild, DoesNotWaitForOneThatSleeps) {
    const auto sleep = [] { return ::sleep(1000), std::string(); };
    const std::time_t start = std::time(nullptr);
    EXPECT_EQ(runInChild(sleep, {.seconds = 1}).failure, "took longer than 1 s");
    EXPECT_LT(std::time(nullptr) - start, 60);  // 5 s by the clock
    EXPECT_TRUE(noChildIsLeft());
}

TEST(ForkedChild, PassesOnWhatIsThrown) {
    try {
        runInChild([]() -> std::string { throw InputError("a.dcm", "is bent"); });
        FAIL();
    } catch (const InputError& e) {
        EXPECT_STREQ(e.what(), "a.dcm: is bent");
    }
    EXPECT_EQ(runInChild([]() -> std::string { throw std::runtime_error("no"); }).failure, "says: no");
}

TEST(ForkedChild, IsSilent) {
    testing::internal::CaptureStderr();
    const ChildAnswer answer = runInChild([] { return std::to_string(::write(2, "assertion", 9)); });
    EXPECT_EQ(answer.bytes, "9");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ForkedChild, CanBeAskedForBySeveralThreads) {
    std::vector<std::string> answers(4);
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < answers.size(); ++i)
        threads.emplace_back([&, i] { answers[i] = runInChild([i] { return std::to_string(i); }).bytes; });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(answers, (std::vector<std::string>{"0", "1", "2", "3"}));
}

}  // namespace
}  // namespace isowave
