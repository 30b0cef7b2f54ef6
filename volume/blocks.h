// A box of lattice points, block by block: every leaf-sized block that touches it, classified in parallel,
// handed over in one order by one thread.
#pragma once

#include <tbb/parallel_for.h>

#include <cstdint>
#include <string_view>
#include <vector>

#include "isowave/progress.h"
#include "volume/vdb.h"

namespace isowave {

// classify(origin, scratch) -> Result runs in parallel, one scratch = makeScratch() a task; take(origin,
// result) runs in ascending (x, y, z) order on the calling thread. Memory: one slab of blocks at a time.
template <class Result, class Classify, class MakeScratch, class Take>
void forEachBlock(const openvdb::CoordBBox& box, const Progress& progress, std::string_view stage,
                  const Classify& classify, const MakeScratch& makeScratch, const Take& take) {
    const openvdb::Coord low = box.min() & ~7, high = box.max() & ~7;
    const std::int64_t ny = (high[1] - low[1]) / 8 + 1, nz = (high[2] - low[2]) / 8 + 1;
    const auto originOf = [&](int x, std::int64_t i) {
        return openvdb::Coord(x, low[1] + 8 * static_cast<int>(i / nz),
                              low[2] + 8 * static_cast<int>(i % nz));
    };
    for (int x = low[0]; x <= high[0]; x += 8) {
        progress(stage, double(x - low[0]) / std::max(8, high[0] - low[0] + 8));
        std::vector<Result> slab(static_cast<std::size_t>(ny * nz));
        tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, ny * nz, 64), [&](const auto& range) {
            auto scratch = makeScratch();
            for (std::int64_t i = range.begin(); i < range.end(); ++i)
                slab[static_cast<std::size_t>(i)] = classify(originOf(x, i), scratch);
        });
        for (std::int64_t i = 0; i < ny * nz; ++i) take(originOf(x, i), slab[static_cast<std::size_t>(i)]);
    }
    progress(stage, 1);
}

}  // namespace isowave
