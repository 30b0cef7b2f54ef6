#include "tools/console.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
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

constexpr auto kRefresh = std::chrono::milliseconds(100);  // of the bar
constexpr std::chrono::seconds kPlainEvery{10},
    kPlainLeast{1};  // between plain lines: within a stage, and at all

std::size_t terminalWidth() {
    constexpr std::size_t kUsual = 80;
    winsize size{};
    return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col - 1u : kUsual - 1;
}

ProgressStyle styleOf(const Talk& talk, bool terminal) {
    if (talk.progress != ProgressStyle::automatic) return talk.progress;
    return terminal && !talk.quiet ? ProgressStyle::bar : ProgressStyle::none;
}

}  // namespace

void installSignalHandlers() {
    std::signal(SIGINT, requestStop);
    std::signal(SIGTERM, requestStop);
    std::signal(SIGXFSZ, SIG_IGN);  // write() then fails with EFBIG, like a full disk
}

Console::Console(const Talk& talk) : talk_(talk), terminal_(::isatty(STDERR_FILENO) != 0) {
    talk_.progress = styleOf(talk, terminal_);
    if (talk_.verbose) log_.emplace();
}

Console::~Console() { clearProgress(); }

void Console::print(std::string_view text) {
    clearProgress();
    std::cout << text;
}

void Console::flush() {
    if (!std::cout.flush()) throw OperationError("standard output could not be written; is the disk full?");
}

void Console::say(std::string_view line) {
    remarks_.emplace_back(line);
    if (talk_.quiet) return;
    waiting_ += fmt::format("isowave: {}\n", line);
    if (terminal_) showRemarks();
}

void Console::complain(std::string_view line) {
    clearProgress();
    std::cerr << fmt::format("isowave: {}\n", line);
}

void Console::showRemarks() {
    clearProgress();
    std::cerr << waiting_;
    waiting_.clear();
}

void Console::finish() {
    showRemarks();
    if (log_) std::cerr << log_->text();
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
    if (log_ || talk_.progress != ProgressStyle::none)
        progress.report = [this](std::string_view stage, double done) { show(stage, done); };
    return progress;
}

void Console::startPart(std::size_t index, std::size_t count) {
    const std::lock_guard lock(mutex_);
    overall_.startPart(index, count);
}

// Called from several threads: whoever comes while another one writes has nothing to add.
void Console::show(std::string_view stage, double done) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock()) return;
    if (log_) log_->report(stage);
    if (talk_.progress == ProgressStyle::none) return;
    const std::optional<double> whole = overall_.at(stage, done);
    const std::chrono::duration<double> since = std::chrono::steady_clock::now() - begin_;
    const ProgressFacts facts{stage, whole.value_or(done), whole.has_value(), since.count()};
    talk_.progress == ProgressStyle::plain ? printLine(facts) : draw(facts);
}

void Console::draw(const ProgressFacts& facts) {
    const auto now = std::chrono::steady_clock::now();
    if (lineShown_ && lastShown_ && now - *lastShown_ < kRefresh) return;
    lastShown_ = now;
    lineShown_ = true;
    std::fputs(("\r\033[K" + barText(facts, terminalWidth())).c_str(), stderr);
    std::fflush(stderr);
}

// At most a line a second: coarse levels pass through their stages in no time.
void Console::printLine(const ProgressFacts& facts) {
    const auto now = std::chrono::steady_clock::now();
    const auto least = stagePrinted_ == facts.stage ? kPlainEvery : kPlainLeast;
    if (lastShown_ && now - *lastShown_ < least) return;
    lastShown_ = now;
    stagePrinted_ = facts.stage;
    std::cerr << fmt::format("isowave: {}\n", plainText(facts));
}

}  // namespace isowave::tools
