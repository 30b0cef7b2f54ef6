#include "hold/until_stopped.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "isowave/error.h"

namespace isowave {
namespace {

using namespace std::chrono_literals;

// A body with a loop of its own; adds 1 to `broken` where that loop ended before its end.
void work(std::atomic<bool>& inside, std::atomic<int>& broken) {
    std::vector<char> done(400, 0);
    tbb::parallel_for(std::size_t{0}, done.size(), [&](std::size_t k) {
        inside = true;
        std::this_thread::sleep_for(100us);
        done[k] = 1;
    });
    broken += std::count(done.begin(), done.end(), 0) > 0;
}

// The first body throws as soon as another one is in its loop, or after a second where there is one thread.
void throwInTheFirst(std::atomic<int>& broken) {
    std::atomic<bool> inside = false;
    forEachUntilStopped(16, {}, [&](std::size_t i) {
        if (i > 0) return work(inside, broken);
        for (int wait = 0; wait < 100 && !inside; ++wait) std::this_thread::sleep_for(10ms);
        throw InputError("a.stl", "is bent");
    });
}

TEST(ForEachUntilStopped, LetsLoopsInOtherBodiesComeToTheirEndWhenOneThrows) {
    std::atomic<int> broken = 0;
    EXPECT_THROW(throwInTheFirst(broken), InputError);
    EXPECT_EQ(broken, 0);
}

TEST(ForEachUntilStopped, BeginsNoBodyOnceAStopIsAskedFor) {
    std::atomic<int> begun = 0;
    Progress progress;
    progress.stopRequested = [&] { return begun > 0; };
    EXPECT_THROW(forEachUntilStopped(1000, progress, [&](std::size_t) { ++begun; }), Cancelled);
    EXPECT_LT(begun, 1000);
}

TEST(ForEachUntilStopped, CallsEveryBodyOnce) {
    std::vector<std::atomic<int>> calls(100);
    forEachUntilStopped(100, {}, [&](std::size_t i) { ++calls[i]; });
    for (const auto& count : calls) EXPECT_EQ(count, 1);
}

}  // namespace
}  // namespace isowave
