// Several intervals of one length at a time, one a lane: what one interval does is a chain of dependent operations, or a
// matrix that is read for a few values; side by side they fill the machine's vectors.
#pragma once

#include <cstddef>
#include <vector>

namespace isowave::wavelets {

// Holds scratch memory: one object a thread; no call allocates once the longest interval has been seen.
// Lane by lane, to the bit, it computes what IntervalTransform does; a lane's results do not depend on the others, so
// lanes may stay unused.
class IntervalBatch {
  public:
    static constexpr int kLanes = 8;

    IntervalBatch();

    // lanes: how many of them will be filled; the others hold zeros. REQUIRES: n >= 1, 1 <= lanes <= kLanes.
    void start(int n, int lanes);

    // 2n + 5 rows of kLanes:
    //   fine           row 0 left, rows 1 .. 2n+3 f, row 2n+4 right
    //   coefficients   row 2j c_j (0 <= j <= n+2), row 2k+3 d_k (0 <= k < n); rows 1 and 2n+3 mean nothing
    float* rows() { return rows_.data(); }
    // Accessory values for synthesis, one a lane.
    float* left() { return ends_.data(); }
    float* right() { return ends_.data() + kLanes; }

    void analyse();     // fine -> coefficients
    void synthesise();  // coefficients, left() and right() -> fine, but not its rows 0 and 2n+4
    // How far each coefficient moves at most, either way -> how far each fine control point does: the sum over the
    // absolute values of the map of synthesise() and of the coefficients. Attained, for one control point at a time.
    void gain();

  private:
    template <class Pack>
    void analyseBy();
    template <class Pack>
    void synthesiseBy();
    double* loadCoefficients();
    void storeFine(const double* out);
    void analyseByFour();
    void synthesiseByFour();
    double* row0();

    int n_ = 0;
    bool four_ = false;  // this machine has vectors of four doubles
    std::vector<float> rows_, ends_;
    std::vector<double> scratch_;  // rows with margins; the same for results; folded
    std::size_t outAt_ = 0, foldedAt_ = 0;
};

}  // namespace isowave::wavelets
