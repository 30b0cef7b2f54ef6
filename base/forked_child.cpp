// The answer on the pipe: one letter (R result, I InputError, F failure), 8 bytes of length, the text. An answer that
// breaks off counts for nothing: then the way in which the child ended says what happened.
#include "base/forked_child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <mutex>
#include <new>

#include "isowave/error.h"

namespace isowave {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kResult = 'R', kInputError = 'I', kFailure = 'F';
constexpr int kClockFactor = 5;  // a machine may be busy with other things

std::int64_t mappedBytes() {
    std::int64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * ::sysconf(_SC_PAGESIZE);
}

std::string tooMuchMemory(const ChildLimits& limits) {
    return fmt::format("needs more than {} MB of memory", limits.memoryBytes / 1'000'000);
}
std::string tooLong(const ChildLimits& limits) {
    return fmt::format("took longer than {} s", limits.seconds);
}

// ---- in the child

void limitTo(int resource, rlim_t value) {
    rlimit limit{};
    ::getrlimit(resource, &limit);
    limit.rlim_cur = std::min(value, limit.rlim_max);
    ::setrlimit(resource, &limit);
}

// Limits, default signals, and no voice.
void becomeChild(const ChildLimits& limits, std::int64_t mapped) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGXCPU, SIGPIPE, SIGTERM})
        ::signal(signal, SIG_DFL);
    ::signal(SIGINT, SIG_IGN);
    if (const int nowhere = ::open("/dev/null", O_WRONLY); nowhere >= 0) {
        ::dup2(nowhere, STDOUT_FILENO);
        ::dup2(nowhere, STDERR_FILENO);
    }
    limitTo(RLIMIT_CORE, 0);
    limitTo(RLIMIT_CPU, static_cast<rlim_t>(limits.seconds));
    limitTo(RLIMIT_AS, static_cast<rlim_t>(mapped + limits.memoryBytes));
}

void writeAll(int pipe, const void* data, std::size_t size) {
    for (const char* at = static_cast<const char*>(data); size > 0;) {
        const ssize_t put = ::write(pipe, at, size);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) ::_exit(1);
        at += put;
        size -= static_cast<std::size_t>(put);
    }
}

void answer(int pipe, char kind, const std::string& text) {
    const std::uint64_t length = text.size();
    writeAll(pipe, &kind, 1);
    writeAll(pipe, &length, sizeof length);
    writeAll(pipe, text.data(), text.size());
}

[[noreturn]] void runAsChild(int pipe, const std::function<std::string()>& work, const ChildLimits& limits) {
    try {
        answer(pipe, kResult, work());
    } catch (const InputError& e) {
        answer(pipe, kInputError, e.what());
    } catch (const std::bad_alloc&) {
        answer(pipe, kFailure, tooMuchMemory(limits));
    } catch (const std::exception& e) {
        answer(pipe, kFailure, std::string("says: ") + e.what());
    } catch (...) {
        answer(pipe, kFailure, "threw what is no exception");
    }
    ::_exit(0);
}

// ---- in the parent

// Everything up to the end of the pipe. False when the time was up before.
bool readAll(int pipe, Clock::time_point end, std::string& bytes) {
    constexpr std::size_t kBlock = 1 << 16;
    for (std::size_t size = 0;;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
        if (left <= 0) return false;
        pollfd ready{pipe, POLLIN, 0};
        const int count = ::poll(&ready, 1, static_cast<int>(std::min<std::int64_t>(left, 1 << 30)));
        if (count == 0 || (count < 0 && errno == EINTR)) continue;
        if (size + kBlock > bytes.size()) bytes.resize(std::max(size + kBlock, 2 * size));
        const ssize_t got = ::read(pipe, bytes.data() + size, bytes.size() - size);
        if (got < 0 && errno == EINTR) continue;
        if (got > 0) size += static_cast<std::size_t>(got);
        if (got <= 0) return bytes.resize(size), true;
    }
}

int waitFor(pid_t child) {
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
}

std::string howItEnded(int status, const ChildLimits& limits) {
    if (!WIFSIGNALED(status)) return fmt::format("ended itself with code {}", WEXITSTATUS(status));
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU) return tooLong(limits);
    return fmt::format("was ended by signal {} ({})", signal, ::strsignal(signal));
}

ChildAnswer answerIn(const std::string& bytes, int status, const ChildLimits& limits) {
    std::uint64_t length = 0;
    constexpr std::size_t kHead = 1 + sizeof length;
    if (bytes.size() >= kHead) std::memcpy(&length, bytes.data() + 1, sizeof length);
    if (bytes.size() < kHead || bytes.size() - kHead != length) return {"", howItEnded(status, limits)};
    const char kind = bytes[0];
    std::string text = bytes.substr(kHead);
    if (kind == kInputError) throw InputError(text);
    if (kind == kFailure) return {"", std::move(text)};
    return {std::move(text), ""};
}

}  // namespace

ChildAnswer runInChild(const std::function<std::string()>& work, const ChildLimits& limits) {
    // One at a time: a second child would hold the first one's pipe open.
    static std::mutex oneAtATime;
    const std::lock_guard lock(oneAtATime);
    int ends[2];
    if (::pipe(ends) != 0) throw OperationError(fmt::format("no pipe can be made: {}", ::strerror(errno)));
    const std::int64_t mapped = mappedBytes();
    const pid_t child = ::fork();
    if (child == 0) {
        ::close(ends[0]);
        becomeChild(limits, mapped);
        runAsChild(ends[1], work, limits);
    }
    const int error = errno;
    ::close(ends[1]);
    std::string bytes;
    bool inTime = true;
    if (child > 0) {
        inTime = readAll(ends[0], Clock::now() + std::chrono::seconds(limits.seconds * kClockFactor), bytes);
        if (!inTime) ::kill(child, SIGKILL);
    }
    ::close(ends[0]);
    if (child < 0) throw OperationError(fmt::format("no child process can be made: {}", ::strerror(error)));
    const int status = waitFor(child);
    if (!inTime) return {"", tooLong(limits)};
    return answerIn(bytes, status, limits);
}

}  // namespace isowave
