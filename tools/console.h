// The terminal: results on standard output, remarks and a progress line on standard error, and Ctrl-C.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

#include "isowave/progress.h"

namespace isowave::tools {

// From now on the first SIGINT or SIGTERM only sets a flag, which every Progress of a Console passes on as a
// wish to stop; a second one kills. A write beyond the file size limit becomes an error instead of a signal.
void installSignalHandlers();

class Console {
  public:
    // quiet: remarks and progress are dropped; results are not.
    explicit Console(bool quiet);
    ~Console();
    Console(const Console&) = delete;
    Console& operator=(const Console&) = delete;

    // A result, to standard output.
    void print(std::string_view text);
    // Results that were printed are where they should be. Throws OperationError (a full disk behind a pipe).
    void flush();
    // A remark (a decision, a default that was taken), one line to standard error: at once on a terminal,
    // otherwise when finish() is called, so that a run that fails leaves exactly one line there, the reason.
    void say(std::string_view line);
    // The work is done: shows the remarks that waited.
    void finish();
    // Takes the progress line away.
    void clearProgress();

    // Reports to the progress line when standard error is a terminal; asks to stop after a signal; passes remarks on to say().
    // REQUIRES: the Console outlives it.
    Progress progress();

  private:
    void show(std::string_view stage, double done);

    bool quiet_, terminal_;
    std::string waiting_;
    std::mutex mutex_;
    bool lineShown_ = false;
    std::chrono::steady_clock::time_point lastShown_{};
};

}  // namespace isowave::tools
