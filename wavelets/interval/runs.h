// Which positions of a line form an interval: runs of known positions, moved to odd ends and joined.
//
// Interval and the counts below use the notation of interval.h: an interval of n coarse intervals has 2n + 3
// fine control points, n + 3 coarse ones and n details.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace isowave::wavelets {

// Accessory points added beyond either end of an interval; coefficients of each kind rejected at either end.
inline constexpr int kAccessory = 4;
inline constexpr int kRejected = 2;

// Two intervals whose odd ends are at most this far apart become one.
inline constexpr int kJoin = 4;

// A maximal run of known positions, [first, last].
struct Run {
    std::int64_t first, last;
    friend bool operator==(const Run&, const Run&) = default;
};

// An odd-ended interval of fine positions, [first, last]; holds one run or several joined ones.
struct Interval {
    std::int64_t first, last;

    std::int64_t coarseIntervals() const { return (last - first - 2) / 2; }  // n
    std::int64_t fineSize() const { return last - first + 1; }               // 2n + 3
    std::int64_t coarseSize() const { return coarseIntervals() + 3; }
    std::int64_t detailSize() const { return coarseIntervals(); }
    std::int64_t firstCoarse() const { return (first - 1) / 2; }  // exact: first is odd
    std::int64_t lastCoarse() const { return (last + 1) / 2; }
    std::int64_t firstDetail() const { return firstCoarse() + 1; }
    friend bool operator==(const Interval&, const Interval&) = default;
};

// Runs (ascending, separated by at least one unknown position, each of length >= 4) -> intervals: ends moved
// outwards to odd positions, neighbours whose ends are <= kJoin apart joined. Replaces the content of `out`.
void joinRuns(std::span<const Run> runs, std::vector<Interval>& out);

}  // namespace isowave::wavelets
