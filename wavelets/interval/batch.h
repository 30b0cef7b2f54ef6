// Several intervals of one length at a time, one per SIMD lane. A single interval is a chain of dependent
// operations, or a matrix that is read for a few values; eight side by side fill the machine's vectors.
#pragma once

#include <cstddef>
#include <vector>

#include "base/vectors.h"

namespace isowave::wavelets {

// Intervals at a time.
inline constexpr int kLanes = 8;
// Values behind the last of each line that must be readable. They are written back unchanged, so no other
// thread may write them meanwhile.
inline constexpr int kSlack = kLanes - 1;

// Intervals of n coarse intervals, `lanes` of them. Each pointer is to a line, whose values lie one behind
// the other:
//   fine     f_0 .. f_(2n+2)       coarse   c_0 .. c_(n+2)       detail   d_0 .. d_(n-1)
// What is written overlaps nothing that is read.
struct AnalysisBatch {
    int n = 0, lanes = 0;
    const float* fine[kLanes];  // from the accessory value before f_0 to the one behind f_(2n+2)
    float *coarse[kLanes], *detail[kLanes];
};
struct SynthesisBatch {
    int n = 0, lanes = 0;
    const float *coarse[kLanes], *detail[kLanes];
    float left[kLanes], right[kLanes];  // accessory values
    float* fine[kLanes];
};

// Holds scratch memory: one object a thread; no call allocates once the longest interval has been seen.
// Interval by interval, to the bit, it computes what IntervalTransform does, and rounds the results to float.
// REQUIRES: n >= 1, 1 <= lanes <= kLanes.
class BatchTransform {
  public:
    // Tests choose narrower vectors.
    explicit BatchTransform(Vectors vectors = widestVectors()) : vectors_(vectors) {}

    void analyse(const AnalysisBatch& batch);
    void synthesise(const SynthesisBatch& batch);
    // How far each coefficient moves at most, either way -> how far each fine control point does: the sum
    // over the absolute values of the map of synthesise() and of the coefficients. Attained, for one control
    // point at a time. Accessory values do not move.
    void gain(const SynthesisBatch& batch);

  private:
    void start(int n);
    double* row0();
    template <class Pack, bool kWide>
    inline void analyseBy(const AnalysisBatch& batch);
    template <class Pack, bool kWide>
    inline void synthesiseBy(const SynthesisBatch& batch);
    void analyseByFour(const AnalysisBatch& batch);
    void analyseByEight(const AnalysisBatch& batch);
    void synthesiseByFour(const SynthesisBatch& batch);
    void synthesiseByEight(const SynthesisBatch& batch);

    Vectors vectors_;
    std::vector<double> scratch_;  // rows with margins; the same for results; folded
    std::size_t outAt_ = 0, foldedAt_ = 0;
};

}  // namespace isowave::wavelets
