#include "wavelets/interval/runs.h"

namespace isowave::wavelets {

void joinRuns(std::span<const Run> runs, std::vector<Interval>& out) {
    out.clear();
    for (const Run& run : runs) {
        // x & 1 is the parity of negative x too (two's complement, as C++20 requires).
        const std::int64_t first = (run.first & 1) ? run.first : run.first - 1;
        const std::int64_t last = (run.last & 1) ? run.last : run.last + 1;
        if (!out.empty() && first - out.back().last <= kJoin)
            out.back().last = last;
        else
            out.push_back({first, last});
    }
}

}  // namespace isowave::wavelets
