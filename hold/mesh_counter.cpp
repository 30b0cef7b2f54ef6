#include "hold/mesh_counter.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "base/disjoint_sets.h"
#include "hold/lattice_patch.h"
#include "polygonize/knot_insertion.h"
#include "polygonize/specks.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;

bool hasBothSigns(const PaddedBlock& points) {
    const bool first = points.values[0] < 0;
    return std::any_of(std::begin(points.values), std::end(points.values),
                       [&](float c) { return (c < 0) != first; });
}

SurfacePieces piecesOf(const PaddedBlock& points, const Coord& origin) {
    return hasBothSigns(points) ? surfacePieces(points, origin) : SurfacePieces{};
}

// The pieces, one of each block, that share a vertex; each pair once.
std::vector<std::pair<std::uint16_t, std::uint16_t>> shared(const std::vector<SurfacePieces::OnFace>& a,
                                                            const std::vector<SurfacePieces::OnFace>& b) {
    std::vector<std::pair<std::uint16_t, std::uint16_t>> pairs;
    for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end();) {
        if (i->vertex == j->vertex)
            pairs.emplace_back(i++->piece, j++->piece);
        else if (i->vertex < j->vertex)
            ++i;
        else
            ++j;
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

Coord aheadOf(const Coord& origin, int axis, int blocks) {
    Coord next = origin;
    next[axis] += blocks * kBlock;
    return next;
}

}  // namespace

MeshCounter::MeshCounter(const BSplineField& field, int refine, double smallestPart, const Progress& progress)
    : refine_(refine), smallest_(smallestPart / nodeVolume(field.transform()) * std::pow(double(refine), 3)) {
    BSplineField finer;
    const BSplineField* fine = &field;
    for (int done = 1; done < refine; done *= 2) {
        finer = insertKnotsAtSurface(*fine, 0, progress);
        fine = &finer;
    }
    const std::vector<Coord> origins = variedBlocks(fine->controlPoints->tree());
    std::vector<SurfacePieces> surfaces(origins.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, origins.size(), 16), [&](const auto& range) {
        progress.check();
        PaddedBlock points;
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            points.gather(fine->controlPoints->getConstUnsafeAccessor(), origins[i]);
            surfaces[i] = piecesOf(points, origins[i]);
        }
    });
    for (std::size_t i = 0; i < origins.size(); ++i)
        if (!surfaces[i].pieces.empty()) blocks_[findOrAdd(origins[i])].surface = std::move(surfaces[i]);
    for (std::size_t i = 0; i < blocks_.size(); ++i) link(i);
}

std::size_t MeshCounter::find(const Coord& origin) const {
    const auto found = byOrigin_.find(origin);
    return found == byOrigin_.end() ? kNone : found->second;
}
std::size_t MeshCounter::findOrAdd(const Coord& origin) {
    const auto [found, isNew] = byOrigin_.emplace(origin, blocks_.size());
    if (isNew) blocks_.push_back({origin, {}, {}});
    return found->second;
}

void MeshCounter::link(std::size_t block) {
    Block& here = blocks_[block];
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t next = find(aheadOf(here.origin, axis, 1));
        here.ahead[axis].clear();
        if (next != kNone)
            here.ahead[axis] =
                shared(here.surface.onFace[2 * axis + 1], blocks_[next].surface.onFace[2 * axis]);
    }
}

SolidCounts MeshCounter::counts() const {
    std::vector<std::uint32_t> first;
    std::uint32_t pieces = 0;
    for (const Block& block : blocks_) {
        first.push_back(pieces);
        pieces += static_cast<std::uint32_t>(block.surface.pieces.size());
    }
    DisjointSets joined(pieces);  // of all blocks, one after the other
    for (std::size_t i = 0; i < blocks_.size(); ++i)
        for (int axis = 0; axis < 3; ++axis) {
            if (blocks_[i].ahead[axis].empty()) continue;
            const std::uint32_t next = first[find(aheadOf(blocks_[i].origin, axis, 1))];
            for (const auto& [a, b] : blocks_[i].ahead[axis]) joined.join(first[i] + a, next + b);
        }
    std::vector<SurfacePiece> sums(pieces);
    std::vector<bool> isComponent(pieces);
    for (std::size_t i = 0; i < blocks_.size(); ++i)
        for (std::size_t k = 0; k < blocks_[i].surface.pieces.size(); ++k) {
            const std::uint32_t root = joined.of(first[i] + static_cast<std::uint32_t>(k));
            const SurfacePiece& piece = blocks_[i].surface.pieces[k];
            isComponent[root] = true;
            sums[root].twiceEuler += piece.twiceEuler;
            sums[root].volume += piece.volume;
        }
    std::vector<double> volumes;
    std::vector<std::int64_t> twiceEuler;
    for (std::uint32_t i = 0; i < pieces; ++i)
        if (isComponent[i]) {
            volumes.push_back(sums[i].volume);
            twiceEuler.push_back(sums[i].twiceEuler);
        }
    const std::vector<bool> isSpeck =
        smallest_ > 0 ? areSpecks(volumes, smallest_) : std::vector<bool>(volumes.size());
    SolidCounts counts{0, 0, 0};
    for (std::size_t i = 0; i < volumes.size(); ++i) {
        if (isSpeck[i]) continue;
        ++(volumes[i] < 0 ? counts.cavities : counts.parts);
        counts.handles += (4 - twiceEuler[i]) / 4;
    }
    return counts;
}

void MeshCounter::change(const BSplineField& changed, const std::vector<CoordBBox>& boxes) {
    before_.clear();
    std::vector<std::size_t> touched;
    for (const CoordBBox& box : boxes) replaceIn(changed, box, touched);
    std::vector<std::size_t> linked = touched;
    for (const std::size_t block : touched)
        for (int axis = 0; axis < 3; ++axis)
            if (const std::size_t behind = find(aheadOf(blocks_[block].origin, axis, -1)); behind != kNone)
                linked.push_back(behind);
    std::sort(linked.begin(), linked.end());
    linked.erase(std::unique(linked.begin(), linked.end()), linked.end());
    for (const std::size_t block : linked) {
        remember(block);
        link(block);
    }
}

void MeshCounter::remember(std::size_t block) { before_.emplace(block, blocks_[block]); }

void MeshCounter::undo() {
    for (auto& [block, was] : before_) blocks_[block] = std::move(was);
    before_.clear();
}

// F at x depends on the control points nearer than 2 to it on each axis, a cell on its corners and what is between them.
void MeshCounter::replaceIn(const BSplineField& changed, const CoordBBox& box,
                            std::vector<std::size_t>& touched) {
    constexpr int kReach = 2;
    Coord low, high;  // origins of the first block and of the one after the last
    for (int a = 0; a < 3; ++a) {
        low[a] = ((box.min()[a] - kReach) * refine_ - 1) >> 3 << 3;
        high[a] = (((box.max()[a] + kReach) * refine_ + 1) >> 3 << 3) + kBlock;
    }
    CoordBBox around;  // control points that decide about their cells
    for (int a = 0; a < 3; ++a) {
        around.min()[a] = static_cast<int>(std::floor(double(low[a]) / refine_)) - 1;
        around.max()[a] = static_cast<int>(std::ceil(double(high[a]) / refine_)) + 1;
    }
    LatticeFunction c{around.dim(), {}};
    c.values.reserve(static_cast<std::size_t>(around.volume()));
    const auto from = changed.controlPoints->getConstAccessor();
    for (auto at = around.begin(); at; ++at) c.values.push_back(from.getValue(*at));
    const LatticePatch patch(c, around.min(), refine_);
    PaddedBlock points;
    for (int x = low[0]; x < high[0]; x += kBlock)
        for (int y = low[1]; y < high[1]; y += kBlock)
            for (int z = low[2]; z < high[2]; z += kBlock) {
                const Coord origin(x, y, z);
                patch.gather(origin, points);
                SurfacePieces surface = piecesOf(points, origin);
                if (surface.pieces.empty() && find(origin) == kNone) continue;
                const std::size_t block = findOrAdd(origin);
                remember(block);
                blocks_[block].surface = std::move(surface);
                touched.push_back(block);
            }
}

}  // namespace isowave
