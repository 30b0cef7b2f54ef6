// The head of a packed file: what has to be known before anything can be decoded.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compress/coder/lattice.h"
#include "compress/coder/predictor.h"
#include "volume/vdb.h"

namespace isowave::compress {

struct Head {
    // With a bound: how values were quantised.
    struct Quantised {
        double bound = 0, delta = 0, reach = 0;  // voxels
        double voxelsPerK = 4;
    };
    double K = 1;
    openvdb::Coord origin;
    Size size{};  // of the box of known points
    std::uint64_t points = 0;
    std::optional<Quantised> quantised;   // nothing: lossless
    std::vector<std::int32_t> chunkEnds;  // chunk i has the planes from the end of chunk i - 1 on
    Weights weights;
    openvdb::math::Transform::Ptr transform;
    std::map<std::string, std::string> source;
};

std::string bytesOf(const Head& head);
// Throws std::runtime_error: what is in it makes no sense.
Head headOf(std::string_view bytes);

}  // namespace isowave::compress
