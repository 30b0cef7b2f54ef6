// The terminal: results on standard output, remarks and a progress line on standard error, and Ctrl-C.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "isowave/progress.h"
#include "tools/overall.h"
#include "tools/stage_log.h"
#include "tools/talk.h"

namespace isowave::tools {

// From now on the first SIGINT or SIGTERM only sets a flag, which every Progress of a Console passes on as a
// wish to stop; a second one kills. A write beyond the file size limit becomes an error instead of a signal.
void installSignalHandlers();

class Console {
  public:
    explicit Console(const Talk& talk);
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
    // All of them so far, also those that --quiet keeps from being shown: for reports.
    const std::vector<std::string>& remarks() const { return remarks_; }
    // Why a part of the work failed while the rest goes on, one line to standard error at once.
    void complain(std::string_view line);
    // The work is done: shows the remarks that waited and, with --verbose, seconds and memory by stage.
    void finish();
    // Takes the progress line away.
    void clearProgress();
    // The job is number `index` (from 0 on) of `count`, which the progress line takes into account.
    void startPart(std::size_t index, std::size_t count);

    // Reports to the progress line, where there is one; asks to stop after a signal; passes remarks on to say().
    // REQUIRES: the Console outlives it.
    Progress progress();

  private:
    void showRemarks();
    void show(std::string_view stage, double done);
    void draw(const ProgressFacts& facts);
    void printLine(const ProgressFacts& facts);

    using Time = std::chrono::steady_clock::time_point;
    Talk talk_;
    bool terminal_;
    std::string waiting_;
    std::vector<std::string> remarks_;
    std::mutex mutex_;
    Time begin_ = std::chrono::steady_clock::now();
    Overall overall_;
    std::optional<StageLog> log_;  // of --verbose
    bool lineShown_ = false;
    std::string stagePrinted_;
    std::optional<Time> lastShown_;
};

}  // namespace isowave::tools
