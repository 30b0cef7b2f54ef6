// What a command says on standard error besides errors: --quiet, --verbose, --progress.
#pragma once

namespace isowave::tools {

// automatic: a bar on a terminal, nothing elsewhere.
enum class ProgressStyle { automatic, bar, plain, none };

struct Talk {
    bool quiet = false;    // neither progress nor remarks
    bool verbose = false;  // seconds and memory by stage, at the end
    ProgressStyle progress = ProgressStyle::automatic;
};

}  // namespace isowave::tools
