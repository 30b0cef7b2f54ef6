#include "wavelets/line_plan.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace isowave::wavelets {

static_assert(kJoin == 4, "gaps of 1 and 3 are closed");

namespace {

// Position i of the result is position i - s of the line; `before` is the word before.
template <int s>
constexpr Word up(Word w, Word before) {
    return w << s | before >> (64 - s);
}
// Position i + s.
template <int s>
constexpr Word down(Word w, Word after) {
    return w >> s | after << (64 - s);
}

constexpr Word kEven = 0x5555555555555555ULL;

}  // namespace

ISOWAVE_INLINE void LinePlan::makeBy() {
    for (int p = 0; p < planes_; ++p) {
        std::array<LeafLines, kLeavesPerPlane> bytes;
        std::memcpy(bytes.data(), known_.plane(p), sizeof bytes);
        transposeBytes(bytes);
        std::memcpy(known_.plane(p), bytes.data(), sizeof bytes);
    }
    const int count = planes_ * kPlaneWords;
    constexpr int kNext = kPlaneWords;
    const Word* const known = known_.plane(0);
    Word *const joined = joined_.plane(0), *const dilated = dilated_.plane(0),
                *const eroded = eroded_.plane(0);
    for (int i = 0; i < count; ++i) {
        const Word k = known[i], after = known[i + kNext], even = k & kEven;
        joined[i] = k | even << 1 | down<1>(even, after & kEven);
        const Word two = k & down<1>(k, after), twoAfter = after & after >> 1;
        eroded[i] = two & down<2>(two, twoAfter);
    }
    Word lost = 0;
    for (int i = 0; i < count; ++i) {
        const Word j = joined[i], before = joined[i - kNext];
        const Word two = j | up<1>(j, before), twoBefore = before | before << 1;
        dilated[i] = two | up<2>(two, twoBefore);
        const Word e = eroded[i], eBefore = eroded[i - kNext];
        const Word four = e | up<1>(e, eBefore), fourBefore = eBefore | eBefore << 1;
        lost |= known[i] & ~(four | up<2>(four, fourBefore));
    }
    hasShortRun_ = lost != 0;
    for (int i = 0; i < count; ++i) {
        const Word d = dilated[i], after = dilated[i + kNext];
        const Word two = d & down<1>(d, after), twoAfter = after & after >> 1;
        joined[i] = two & down<2>(two, twoAfter);
    }
    // Of every line, known ones in the lower half of a word and stored ones in the upper.
    for (int i = 0; i < count; ++i) {
        const Word j = joined[i], before = joined[i - kNext], after = joined[i + kNext];
        dilated[i] = evenBits(up<1>(j, before) | j | down<1>(j, after)) | evenBits(j & down<3>(j, after))
                                                                              << 32;
    }
    for (int p = 0; p < planes_; ++p) {
        std::array<LeafLines, kLeavesPerPlane> bytes;
        std::memcpy(bytes.data(), dilated_.plane(p), sizeof bytes);
        transposeBytes(bytes);
        std::copy(bytes.begin(), bytes.end(), coarse_.begin() + p * kLeavesPerPlane);
    }
}

ISOWAVE_FOUR void LinePlan::makeByFour() { makeBy(); }
ISOWAVE_EIGHT void LinePlan::makeByEight() { makeBy(); }

// The planes at both ends must be 0, and nothing is ever written there.
void LinePlan::resize(int planes) {
    if (planes == planes_) return;
    for (Planes* each : {&known_, &joined_, &dilated_, &eroded_}) each->reset(planes);
    coarse_.resize(std::size_t(planes) * kLeavesPerPlane);
    planes_ = planes;
}

void LinePlan::make(std::span<const LeafLines> known) {
    assert(known.size() % 2 == 0);
    resize(static_cast<int>((known.size() + kLeavesPerPlane - 1) / kLeavesPerPlane));
    std::memcpy(known_.plane(0), known.data(), known.size_bytes());
    std::memset(known_.plane(0) + known.size() * kLeafDim, 0,
                std::size_t(planes_) * kPlaneWords * sizeof(Word) - known.size_bytes());
    switch (vectors_) {
        case Vectors::two:
            return makeBy();
        case Vectors::four:
            return makeByFour();
        case Vectors::eight:
            return makeByEight();
    }
}

LineRun LinePlan::shortRun() const {
    LineRun found{-1, 0, 0};
    forEachRun(known_, [&](const LineRun& run) {
        if (run.last - run.first < 3 && found.line < 0) found = run;
    });
    return found;
}

}  // namespace isowave::wavelets
