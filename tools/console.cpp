#include "tools/console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <iostream>

#include "isowave/error.h"

namespace isowave::tools {
namespace {

// Signal handlers can reach nothing but globals; this is the only one of the command.
std::atomic<bool> stopRequested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may write lock-free atomics only");

void requestStop(int signal) {
    stopRequested.store(true, std::memory_order_relaxed);
    std::signal(signal, SIG_DFL);  // the second one kills
}

constexpr auto kRefresh = std::chrono::milliseconds(100);

}  // namespace

void installSignalHandlers() {
    std::signal(SIGINT, requestStop);
    std::signal(SIGTERM, requestStop);
    std::signal(SIGXFSZ, SIG_IGN);  // write() then fails with EFBIG, like a full disk
}

Console::Console(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) != 0) {}

Console::~Console() { clearProgress(); }

void Console::print(std::string_view text) {
    clearProgress();
    std::cout << text;
}

void Console::flush() {
    if (!std::cout.flush()) throw OperationError("standard output could not be written; is the disk full?");
}

void Console::say(std::string_view line) {
    if (quiet_) return;
    waiting_ += fmt::format("isowave: {}\n", line);
    if (terminal_) finish();
}

void Console::finish() {
    clearProgress();
    std::cerr << waiting_;
    waiting_.clear();
}

void Console::clearProgress() {
    const std::lock_guard lock(mutex_);
    if (lineShown_) std::fputs("\r\033[K", stderr);
    lineShown_ = false;
}

Progress Console::progress() {
    Progress progress;
    progress.stopRequested = [] { return stopRequested.load(std::memory_order_relaxed); };
    progress.remark = [this](std::string_view line) { say(line); };
    if (terminal_ && !quiet_)
        progress.report = [this](std::string_view stage, double done) { show(stage, done); };
    return progress;
}

// Called from several threads: whoever comes while another one writes has nothing to add.
void Console::show(std::string_view stage, double done) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock()) return;
    const auto now = std::chrono::steady_clock::now();
    if (lineShown_ && now - lastShown_ < kRefresh) return;
    lastShown_ = now;
    lineShown_ = true;
    std::fputs(fmt::format("\r\033[K{} {:.0f} %", stage, 100 * std::clamp(done, 0.0, 1.0)).c_str(), stderr);
    std::fflush(stderr);
}

}  // namespace isowave::tools
