// A function that runs in a child process with limits, and whose answer comes back as bytes: for parsers of other
// projects that abort, crash, allocate without end or never finish over a damaged file.
//
//   const ChildAnswer answer = runInChild([&] { return decode(bytes); }, {.memoryBytes = 1 << 30});
//   if (!answer.failure.empty()) throw InputError(file, "its pixels cannot be decoded; the decoder " + answer.failure);
//
// The child is a fork: it sees everything that this process holds in memory and nothing is sent to it. What it
// changes is lost but for the bytes that it returns. A caller checks those bytes as it would check a file.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace isowave {

struct ChildLimits {
    std::int64_t memoryBytes = std::int64_t(1) << 30;  // beyond what this process has mapped when it forks
    int seconds = 20;                                  // of processor time; five times as long by the clock
};

// Either bytes or a failure.
struct ChildAnswer {
    std::string bytes;
    // Empty, or what became of the child, to follow "the decoder": "was ended by signal 6 (Aborted)", "took longer
    // than 20 s", "needs more than 1074 MB of memory", "says: " and the text of an exception.
    std::string failure;
};

// Runs work() in a child and waits. An InputError that work() throws is thrown here with the same text; an
// OperationError when no child can be made. The child's standard output and error lead nowhere, it leaves no core
// file, does not hear Ctrl-C and dies with this thread.
// REQUIRES: work() uses one thread and none of oneTBB, since a fork has only the thread that forked, and takes no lock
// that another thread may hold. Children run one after another, also where several threads ask for one.
ChildAnswer runInChild(const std::function<std::string()>& work, const ChildLimits& limits = {});

}  // namespace isowave
