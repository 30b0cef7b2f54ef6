// What a fit tells about itself.
#pragma once

#include <cstdint>

namespace isowave {

struct FitReport {
    // Lattice points whose sign was compared with the input's: I dilated by one, all those where a known
    // control point has a say.
    std::int64_t latticePoints = 0;
    // Of these, how many disagree in the end. The repair works on those of I and leaves none there unless it
    // gave up; those beside I keep their sign because nothing crosses zero so far from the surface.
    std::int64_t disagreeing = 0;
    int filterPasses = 0;    // Laplacian passes (fitBinary)
    int gradientPasses = 0;  // of the least energy (fitMask)
    int repairPasses = 0;    // passes that changed something
    // The repair stopped because every lattice point of I had its sign by the floor; false: at
    // kMostRepairPasses.
    bool repairAgreed = true;
    double repairFloor = 0;     // of K: what s F has to reach for that
    std::int64_t repaired = 0;  // control points changed by the repair, counted once a pass
};

// Where the repair gives up. White noise at 50 % takes 20 passes: that many times over means that it cannot
// succeed.
inline constexpr int kMostRepairPasses = 1000;

}  // namespace isowave
