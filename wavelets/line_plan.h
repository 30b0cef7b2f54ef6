// From what is known along the lines of a column to their intervals (interval/interval.h) and to what the
// coarse step knows and stores. All 64 lines at once, 64 positions a word; the algebra is that of sets of
// positions:
//
//   K   known                                        a run is a maximal row of ones
//   J0  K, and the odd neighbours of its even ends   odd ends: both neighbours of every even point of K
//   J   J0 closed by four in a row                   what is apart by kJoin or less is joined: gaps are 1, 3, 5, ...
//   coarse known    2c-1, 2c or 2c+1 in J            an interval and the accessory points at its ends
//   stored          2c and 2c+3 in J                 n details: without the first two and the last coarse point
//   short runs      K is not K opened by four in a row
#pragma once

#include <span>
#include <vector>

#include "base/vectors.h"
#include "wavelets/interval/runs.h"
#include "wavelets/line_bits.h"

namespace isowave::wavelets {

// A line's positions first .. last.
struct LineRun {
    int line, first, last;
};

class LinePlan {
  public:
    // Tests choose narrower vectors.
    explicit LinePlan(Vectors vectors = widestVectors()) : vectors_(vectors) {}

    // known: leaf by leaf, positions 8k .. 8k + 7 in known[k]. Keeps its memory.
    // REQUIRES: an even number of leaves, of which the first and the last know nothing.
    void make(std::span<const LeafLines> known);

    // Whether a run is shorter than four points; if so, one of them.
    bool hasShortRun() const { return hasShortRun_; }
    LineRun shortRun() const;

    // Calls f(LineRun) for each interval, line by line, ascending.
    template <class F>
    void forEachInterval(const F& f) const {
        forEachRun(joined_, f);
    }

    // Leaf k of the coarse column: positions 8k .. 8k + 7 are fine 16k, 16k + 2, ...
    const LeafLines& coarseKnown(int k) const { return coarse_[coarseAt(k)]; }
    const LeafLines& stored(int k) const { return coarse_[coarseAt(k) + kCoarseLeaves]; }

  private:
    // Lines in planes of 64 positions: word 64p + 8j + i is positions 64p .. 64p + 63 of line 8i + j. Plane
    // -1 and the one behind the last are 0.
    static constexpr int kPlaneWords = kLinesPerLeaf, kLeavesPerPlane = 8,
                         kCoarseLeaves = kLeavesPerPlane / 2;
    class Planes {
      public:
        // All 0.
        void reset(int planes) { words_.assign(std::size_t(planes + 2) * kPlaneWords, 0); }
        Word* plane(int p) { return words_.data() + std::ptrdiff_t(p + 1) * kPlaneWords; }
        const Word* plane(int p) const { return words_.data() + std::ptrdiff_t(p + 1) * kPlaneWords; }

      private:
        std::vector<Word> words_;
    };

    static std::size_t coarseAt(int k) {
        return std::size_t(k / kCoarseLeaves) * kLeavesPerPlane + k % kCoarseLeaves;
    }

    template <class F>
    void forEachRun(const Planes& lines, const F& f) const {
        for (int line = 0; line < kLinesPerLeaf; ++line) {
            const Word* w = lines.plane(0) + (line % kLeafDim * kLeafDim + line / kLeafDim);
            int first = -1;  // of a run that comes from the plane before
            for (int p = 0; p < planes_; ++p, w += kPlaneWords) {
                Word bits = *w;
                if (first >= 0) {
                    const int ones = std::countr_one(bits);
                    if (ones == 64) continue;
                    f(LineRun{line, first, 64 * p + ones - 1});
                    first = -1;
                    bits &= bits + 1;  // without its lowest ones
                }
                while (bits != 0) {
                    const int at = std::countr_zero(bits), ones = std::countr_one(bits >> at);
                    if (at + ones == 64) {  // goes on, or ends here: the next plane says
                        first = 64 * p + at;
                        break;
                    }
                    f(LineRun{line, 64 * p + at, 64 * p + at + ones - 1});
                    bits &= bits + (bits & -bits);  // without its lowest run
                }
            }
        }
    }

    void resize(int planes);
    inline void makeBy();
    void makeByFour();
    void makeByEight();

    Vectors vectors_;
    int planes_ = 0;
    bool hasShortRun_ = false;
    Planes known_, joined_, dilated_, eroded_;
    // Of each plane: four leaves of what is known, four of what is stored.
    std::vector<LeafLines> coarse_;
};

}  // namespace isowave::wavelets
