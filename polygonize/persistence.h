// Which parts, handles and cavities the sets { d <= t } have, from which t to which, and where they begin and
// end: persistent homology of a function on a lattice.
//
// H. Edelsbrunner, D. Letscher, A. Zomorodian: "Topological persistence and simplification", 2002. Computed
// on the discrete gradient of V. Robins, P. J. Wood, A. P. Sheppard: "Theory and algorithms for constructing
// discrete Morse complexes from grayscale digital images", 2011. For d the signed distance to a solid's
// surface it gives the sizes of its grains, throats and pores: O. Delgado-Friedrichs, V. Robins, A. Sheppard:
// "Skeletonization and partitioning of digital images using discrete Morse theory", 2015.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "isowave/progress.h"
#include "volume/vdb.h"

namespace isowave {

// Values at the points of a lattice of size[0] x size[1] x size[2], z fastest.
struct LatticeFunction {
    openvdb::Coord size;
    std::vector<float> values;

    std::int64_t index(int x, int y, int z) const { return (std::int64_t{x} * size[1] + y) * size[2] + z; }
    openvdb::Coord point(std::int64_t index) const {
        return {static_cast<int>(index / size[2] / size[1]), static_cast<int>(index / size[2] % size[1]),
                static_cast<int>(index % size[2])};
    }
};

// A homology class of the sets { values <= t }: it is there for birth <= t < death.
struct PersistentClass {
    static constexpr std::int64_t kNever = -1;
    int dimension = 0;  // 0 a part, 1 a handle, 2 a cavity
    float birth = 0, death = std::numeric_limits<float>::infinity();
    std::int64_t birthPoint = 0;  // lattice point whose value the birth is: a part's deepest point,
                                  // the thinnest place of a handle's ring or a cavity's wall
    std::int64_t deathPoint =
        kNever;  // where it ends: parts meet, a hole is closed in its middle, a cavity filled;
                 // kNever: not up to `last`
};

// The classes that are there at t = `at`, and then up to t = `last`: birth <= at < death. { values <= t } is
// the union of the lattice's points, edges, squares and cubes all of whose corners are <= t. In the order of
// dimension, birth, birthPoint. About 1 us a point with a value <= last.
// REQUIRES: finite values; at <= last; each size >= 1, at most 2^31 cells.
std::vector<PersistentClass> classesAt(const LatticeFunction& function, float at, float last,
                                       const Progress& progress = {});

}  // namespace isowave
