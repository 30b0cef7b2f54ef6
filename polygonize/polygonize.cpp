// polygonize = sample -> cross -> place -> connect, each a parallel pass over blocks of 8x8x8 lattice points.
//
//   sample   the sign of every lattice point of the block
//   cross    which of the block's lattice edges the surface crosses, what the field decides in cells whose corners leave a
//            choice, and how many triangles there are
//            (number: prefix sums over the blocks, so that every vertex and triangle has its place)
//   place    one vertex on each crossed edge, and those inside cells
//   connect  triangles between them
// The block of a lattice edge is that of its low end; the block of a cell that of its lowest corner.
// invariant: a sign is computed once and stored; every later pass reads it, so neighbours cannot disagree. The sign in the
// middle of a face is computed by both its cells, exactly.
//
// F here is the field less the iso-value: a ShiftedField hands out its control points, c - iso.
#include "polygonize/polygonize.h"
#include "polygonize/knot_insertion.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <optional>

#include "isowave/error.h"
#include "polygonize/blocks.h"
#include "polygonize/cell_decision.h"
#include "polygonize/vertex_place.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using Word = std::uint64_t;

// A cell whose corners leave a choice, and the field's.
struct DecidedCell {
    std::uint16_t cell = 0;        // 64x + 8y + z in the block
    std::uint16_t firstOnRay = 0;  // its vertices on rays, counted from the block's first
    CellDecision decision;
};

struct Block {
    Coord origin;
    BlockBits inside{};
    std::array<BlockBits, 3> crossed{};  // by axis: the edges that start at the block's lattice points
    // The blocks ahead, 4 dx + 2 dy + dz (0 is this one): an index, or kOutside, kInside for one whose
    // lattice points, with those of its cells, all have that sign and which is not in the list.
    std::array<std::int32_t, 8> ahead{};
    std::int64_t firstVertex = 0, firstTriangle = 0;  // counts until `number` sums them up
    int onEdges = 0;                                  // of its vertices; those on rays follow
    // The number, within the block, of the vertex of a word's lowest crossed edge.
    std::array<std::array<std::uint16_t, kBlock>, 3> firstOfWord{};
    std::vector<DecidedCell> decided;  // in the order of the cells
};
constexpr std::int32_t kOutside = -1, kInside = -2;

template <class Body>
void forEachBlock(std::size_t count, const Progress& progress, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 16), [&](const auto& range) {
        progress.check();
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
    });
}

template <class Body>
void forEachBit(Word word, const Body& body) {
    for (; word != 0; word &= word - 1) body(std::countr_zero(word));
}

// The control points c - iso. Float32's difference is 0 only where c = iso and has the sign of c - iso
// elsewhere (gradual underflow), so the shift moves no sign.
class ShiftedField {
  public:
    ShiftedField(const BSplineField& field, double iso)
        : grid_(*field.controlPoints), iso_(static_cast<float>(iso)) {}

    const openvdb::FloatTree& tree() const { return grid_.tree(); }
    void gather(const Coord& origin, PaddedBlock& block) const {
        block.gather(grid_.getConstUnsafeAccessor(), origin);
        if (iso_ != 0)
            for (float& c : block.values) c -= iso_;
    }
    bool insideAt(const Coord& at) const { return grid_.tree().getValue(at) < iso_; }

  private:
    const openvdb::FloatGrid& grid_;
    float iso_;
};

// ---- sample

[[noreturn]] void throwNotFinite(const PaddedBlock& block, const Coord& origin) {
    for (int x = -1; x < kBlock + 2; ++x)
        for (int y = -1; y < kBlock + 2; ++y)
            for (int z = -1; z < kBlock + 2; ++z)
                if (const float c = block.at(x, y, z); !std::isfinite(c)) {
                    const Coord at = origin.offsetBy(x, y, z);
                    throw InputError("field", "control point (" + std::to_string(at.x()) + ", " +
                                                  std::to_string(at.y()) + ", " + std::to_string(at.z()) +
                                                  ") is " + std::to_string(c) +
                                                  ", not a finite number; fit the field again");
                }
    throw InputError("field", "a control point is not a finite number");
}

enum class Signs { allOutside, allInside, mixed };

// F at a lattice point is a mean of control points, so it has their sign where all agree.
Signs signsOf(const PaddedBlock& block, const Coord& origin) {
    constexpr std::uint32_t kExponent = 0x7f800000;
    unsigned negative = 0, positive = 0, bad = 0;
    for (const float c : block.values) {
        negative |= c < 0;
        positive |= c >= 0;
        bad |= (std::bit_cast<std::uint32_t>(c) & kExponent) == kExponent;
    }
    if (bad) throwNotFinite(block, origin);
    return !negative ? Signs::allOutside : !positive ? Signs::allInside : Signs::mixed;
}

// The blocks on whose cells F can change sign, with the signs of their lattice points, in the order of the
// tree.
std::vector<Block> sample(const ShiftedField& field, const Progress& progress) {
    const std::vector<Coord> candidates = variedBlocks(field.tree());
    struct Sampled {
        Signs signs;
        BlockBits inside;
    };
    std::vector<Sampled> sampled(candidates.size());
    forEachBlock(candidates.size(), progress, [&](std::size_t i) {
        PaddedBlock padded;
        field.gather(candidates[i], padded);
        sampled[i].signs = signsOf(padded, candidates[i]);
        if (sampled[i].signs == Signs::mixed) sampled[i].inside = insideBits(padded);
    });
    std::vector<Block> blocks;
    for (std::size_t i = 0; i < candidates.size(); ++i)
        if (sampled[i].signs == Signs::mixed) {
            blocks.emplace_back();
            blocks.back().origin = candidates[i];
            blocks.back().inside = sampled[i].inside;
        }
    return blocks;
}

// ---- cross

// Block -> its index: one voxel a block.
void linkBlocks(std::vector<Block>& blocks, const ShiftedField& field, const Progress& progress) {
    openvdb::Int32Tree indices(-1);
    {
        openvdb::tree::ValueAccessor<openvdb::Int32Tree> accessor(indices);
        for (std::size_t i = 0; i < blocks.size(); ++i)
            accessor.setValue(blocks[i].origin >> 3, static_cast<std::int32_t>(i));
    }
    forEachBlock(blocks.size(), progress, [&](std::size_t i) {
        Block& block = blocks[i];
        for (int k = 0; k < 8; ++k) {
            const Coord at = (block.origin >> 3).offsetBy(k >> 2, k >> 1 & 1, k & 1);
            block.ahead[k] = indices.getValue(at);
            // Not in the list: the control points in and around it all have one sign, any of them tells.
            if (block.ahead[k] < 0) block.ahead[k] = field.insideAt(at << 3) ? kInside : kOutside;
        }
    });
}

// The signs of a block's lattice points and of those ahead that its cells need.
class NearSigns {
  public:
    NearSigns(const std::vector<Block>& blocks, const Block& block) {
        for (int k = 0; k < 8; ++k) {
            const std::int32_t i = block.ahead[k];
            if (i >= 0)
                near_[k] = blocks[i].inside;
            else
                near_[k].fill(i == kInside ? ~Word{0} : 0);
        }
    }
    // Bit 8y + z: the lattice point (x, y + dy, z + dz) is inside. 0 <= x <= 8; dy, dz are 0 or 1.
    Word plane(int x, int dy, int dz) const {
        const int k = x / kBlock * 4, word = x % kBlock;
        const Word here = alongZ(k, word, dz);
        return dy ? here >> 8 | alongZ(k + 2, word, dz) << 56 : here;
    }

  private:
    Word alongZ(int k, int word, int dz) const {
        constexpr Word kLastZ = 0x8080808080808080u, kFirstZ = 0x0101010101010101u;
        const Word here = near_[k][word];
        return dz ? (here >> 1 & ~kLastZ) | (near_[k + 1][word] & kFirstZ) << 7 : here;
    }
    std::array<BlockBits, 8> near_;
};

// body(x, y, z, pattern) for each of the block's cells with corners on both sides, in the order of the bits.
template <class Body>
void forEachMixedCell(const std::vector<Block>& blocks, const Block& block, const Body& body) {
    const NearSigns signs(blocks, block);
    for (int x = 0; x < kBlock; ++x) {
        std::array<Word, 8> corner;  // dx + 2 dy + 4 dz, as in a pattern
        Word any = 0, all = ~Word{0};
        for (int c = 0; c < 8; ++c) {
            corner[c] = signs.plane(x + (c & 1), c >> 1 & 1, c >> 2);
            any |= corner[c];
            all &= corner[c];
        }
        forEachBit(any & ~all, [&](int bit) {
            unsigned pattern = 0;
            for (int c = 0; c < 8; ++c) pattern |= static_cast<unsigned>(corner[c] >> bit & 1) << c;
            body(x, bit / kBlock, bit % kBlock, pattern);
        });
    }
}

constexpr std::uint16_t cellNumber(int x, int y, int z) {
    return static_cast<std::uint16_t>((x * kBlock + y) * kBlock + z);
}

// Counts the block's vertices and triangles, and decides about its cells.
void countCells(const std::vector<Block>& blocks, const ShiftedField& field, Block& block) {
    const CellTable& table = cellTable();
    std::optional<PaddedBlock> padded;
    block.decided.clear();
    std::size_t triangles = 0;
    unsigned onRays = 0;
    forEachMixedCell(blocks, block, [&](int x, int y, int z, unsigned pattern) {
        if (table.isPlain(pattern)) {
            triangles += table.plain(pattern).triangles.size();
            return;
        }
        if (!padded) field.gather(block.origin, padded.emplace());
        const CellDecision decision =
            decide(pattern, [&](int dx, int dy, int dz) { return padded->at(x + dx, y + dy, z + dz); });
        const CellCase& cell = table.at(pattern, decision);
        block.decided.push_back({cellNumber(x, y, z), static_cast<std::uint16_t>(onRays), decision});
        triangles += cell.triangles.size();
        onRays += static_cast<unsigned>(std::popcount(cell.rays));
    });
    block.firstVertex += onRays;
    block.firstTriangle = static_cast<std::int64_t>(triangles);
}

void cross(std::vector<Block>& blocks, const ShiftedField& field, const Progress& progress) {
    forEachBlock(blocks.size(), progress, [&](std::size_t i) {
        Block& block = blocks[i];
        const NearSigns signs(blocks, block);
        for (int x = 0; x < kBlock; ++x) {
            const Word here = signs.plane(x, 0, 0);
            block.crossed[0][x] = here ^ signs.plane(x + 1, 0, 0);
            block.crossed[1][x] = here ^ signs.plane(x, 1, 0);
            block.crossed[2][x] = here ^ signs.plane(x, 0, 1);
        }
        int vertices = 0;
        for (int axis = 0; axis < 3; ++axis)
            for (int x = 0; x < kBlock; ++x) {
                block.firstOfWord[axis][x] = static_cast<std::uint16_t>(vertices);
                vertices += std::popcount(block.crossed[axis][x]);
            }
        block.onEdges = vertices;
        block.firstVertex = vertices;
        countCells(blocks, field, block);
    });
}

// Prefix sums; sizes the mesh.
void number(std::vector<Block>& blocks, TriangleMesh& mesh) {
    std::int64_t vertices = 0, triangles = 0;
    for (Block& block : blocks) {
        block.firstVertex = std::exchange(vertices, vertices + block.firstVertex);
        block.firstTriangle = std::exchange(triangles, triangles + block.firstTriangle);
    }
    constexpr std::int64_t kMost = 0x7fffffff;
    if (vertices > kMost || triangles > kMost)
        throw OperationError("mesh", "would have " + std::to_string(vertices) + " vertices and " +
                                         std::to_string(triangles) +
                                         " triangles, more than 2^31 - 1; take a coarser level");
    mesh.points.resize(static_cast<std::size_t>(vertices));
    mesh.normals.resize(static_cast<std::size_t>(vertices));
    mesh.triangles.resize(static_cast<std::size_t>(triangles));
}

// ---- place

// Index space -> world; gradients -> normals. VDB's matrices act on row vectors: world = index M, so a
// gradient (a column) goes to M^-1 gradient.
class ToWorld {
  public:
    explicit ToWorld(const openvdb::math::Transform& transform) {
        if (!transform.isLinear())
            throw InputError("field", "its transform is " + transform.mapType() +
                                          ", expected an affine one; resample the grid");
        const auto matrix = transform.baseMap()->getAffineMap()->getMat4();
        linear_ = matrix.getMat3();
        translation_ = matrix.getTranslation();
        const double det = linear_.det();
        if (!std::isfinite(det) || det == 0)
            throw InputError("field", "its transform has determinant " + std::to_string(det) +
                                          ", expected an invertible one; check spacing and orientation");
        mirrors_ = det < 0;
        // The adjugate over the determinant, less the scale: normals are normalised anyway.
        gradient_ = linear_.adjoint() * (mirrors_ ? -1.0 : 1.0);
    }
    bool mirrors() const { return mirrors_; }
    Point point(const Vec3d& index) const {
        const Vec3d p = index * linear_ + translation_;
        return {p[0], p[1], p[2]};
    }
    std::array<float, 3> normal(const Vec3d& gradient) const {
        Vec3d n =
            gradient_ *
            (gradient / std::max({std::abs(gradient[0]), std::abs(gradient[1]), std::abs(gradient[2])}));
        n /= n.length();
        return {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])};
    }

  private:
    openvdb::Mat3d linear_, gradient_;
    Vec3d translation_;
    bool mirrors_ = false;
};

constexpr double kVanishing = 1e-9;  // a gradient, of the control points

// The gradient at the edge's root, or, where it vanishes, the way out along the edge.
Vec3d gradientAt(const EdgeField& f, double t, int axis, bool insideAtLow) {
    Vec3d gradient;
    gradient[axis] = f.value.slope(t);
    gradient[(axis + 1) % 3] = f.alongU(t);
    gradient[(axis + 2) % 3] = f.alongV(t);
    if (!(gradient.length() > kVanishing * f.scale)) {
        gradient = Vec3d(0);
        gradient[axis] = insideAtLow ? 1 : -1;
    }
    return gradient;
}

// Calls put(position in the block, way out along the ray) for each vertex on a ray of a decided cell.
template <class Put>
void placeOnRays(const PaddedBlock& padded, const DecidedCell& decided, unsigned rays,
                 const PolygonizeOptions& options, const Put& put) {
    const std::array<int, 3> cell{decided.cell / (kBlock * kBlock), decided.cell / kBlock % kBlock,
                                  decided.cell % kBlock};
    const DenseControlPoints points = controlPointsOf(padded);
    const Vec3d middle = Vec3d(cell[0], cell[1], cell[2]) + Vec3d(0.5);
    const bool inside = decided.decision.middleInside;
    forEachBit(rays, [&](int c) {
        const Vec3d corner(cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2));
        const double t = rootOnRay(points, cell, middle, corner, inside, options.rootTolerance);
        const double kept = std::clamp(t, options.rootMargin, 1 - options.rootMargin);
        const Vec3d at = middle + (corner - middle) * kept;
        CellField f = fieldIn(points, cell, at);
        if (!(f.gradient.length() > kVanishing * f.scale)) f.gradient = (corner - middle) * (inside ? 1 : -1);
        put(at, f.gradient);
    });
}

// The pattern of a cell of the block.
unsigned patternOf(const NearSigns& signs, const DecidedCell& decided) {
    const int x = decided.cell / (kBlock * kBlock), bit = decided.cell % (kBlock * kBlock);
    unsigned pattern = 0;
    for (int c = 0; c < 8; ++c)
        pattern |= static_cast<unsigned>(signs.plane(x + (c & 1), c >> 1 & 1, c >> 2) >> bit & 1) << c;
    return pattern;
}

void place(const std::vector<Block>& blocks, const ShiftedField& field, const ToWorld& toWorld,
           const PolygonizeOptions& options, const Progress& progress, TriangleMesh& mesh) {
    forEachBlock(blocks.size(), progress, [&](std::size_t i) {
        const Block& block = blocks[i];
        std::size_t vertex = static_cast<std::size_t>(block.firstVertex);
        PaddedBlock padded;
        field.gather(block.origin, padded);
        const auto put = [&](const Vec3d& at, const Vec3d& gradient) {
            mesh.points[vertex] = toWorld.point(block.origin.asVec3d() + at);
            mesh.normals[vertex] = toWorld.normal(gradient);
            ++vertex;
        };
        for (int axis = 0; axis < 3; ++axis)
            for (int x = 0; x < kBlock; ++x)
                forEachBit(block.crossed[axis][x], [&](int bit) {
                    const int y = bit / kBlock, z = bit % kBlock;
                    const bool insideAtLow = (block.inside[x] >> bit & 1) != 0;
                    const EdgeField f = edgeField(controlPointsOf(padded), {x, y, z}, axis);
                    const double t = rootOf(f.value, insideAtLow, options.rootTolerance);
                    Vec3d at(x, y, z);
                    at[axis] += std::clamp(t, options.rootMargin, 1 - options.rootMargin);
                    put(at, gradientAt(f, t, axis, insideAtLow));
                });
        if (block.decided.empty()) return;
        const NearSigns signs(blocks, block);
        for (const DecidedCell& decided : block.decided)
            placeOnRays(padded, decided, cellTable().at(patternOf(signs, decided), decided.decision).rays,
                        options, put);
    });
}

// ---- connect

// The number of the vertex on an edge of the block's cell (x, y, z).
std::uint32_t vertexOnEdge(const std::vector<Block>& blocks, const Block& block, int x, int y, int z, int e) {
    const CellEdge& edge = cellTable().edge(e);
    const int ex = x + edge.x, ey = y + edge.y, ez = z + edge.z;
    // A crossed edge has its low end in a listed block: an unlisted one's edges have no sign change.
    const Block& owner = blocks[block.ahead[ex / kBlock * 4 + ey / kBlock * 2 + ez / kBlock]];
    const int word = ex % kBlock, bit = ey % kBlock * kBlock + ez % kBlock;
    const Word before = owner.crossed[edge.axis][word] & ((Word{1} << bit) - 1);
    return static_cast<std::uint32_t>(owner.firstVertex + owner.firstOfWord[edge.axis][word] +
                                      std::popcount(before));
}

void connect(const std::vector<Block>& blocks, bool mirrored, const Progress& progress, TriangleMesh& mesh) {
    const CellTable& table = cellTable();
    forEachBlock(blocks.size(), progress, [&](std::size_t i) {
        const Block& block = blocks[i];
        std::size_t out = static_cast<std::size_t>(block.firstTriangle), nextDecided = 0;
        forEachMixedCell(blocks, block, [&](int x, int y, int z, unsigned pattern) {
            const bool plain = table.isPlain(pattern);
            const DecidedCell decided = plain ? DecidedCell{} : block.decided[nextDecided++];
            const CellCase& cell = plain ? table.plain(pattern) : table.at(pattern, decided.decision);
            const auto vertex = [&](std::uint8_t v) {
                if (v < kCellEdges) return vertexOnEdge(blocks, block, x, y, z, v);
                const unsigned before = cell.rays & ((1u << (v - kCellEdges)) - 1);
                return static_cast<std::uint32_t>(block.firstVertex + block.onEdges + decided.firstOnRay +
                                                  std::popcount(before));
            };
            for (const auto& [a, b, c] : cell.triangles)
                mesh.triangles[out++] = mirrored ? Triangle{vertex(a), vertex(c), vertex(b)}
                                                 : Triangle{vertex(a), vertex(b), vertex(c)};
        });
    });
}

}  // namespace

TriangleMesh polygonize(const BSplineField& field, const PolygonizeOptions& options,
                        const Progress& progress) {
    assert(options.refine == 1 || options.refine == 2 || options.refine == 4);
    assert(options.rootMargin >= 0 && options.rootMargin < 0.5 && options.rootTolerance > 0);
    assert(std::abs(options.iso) < field.K);
    if (options.refine > 1) {
        PolygonizeOptions rest = options;
        rest.refine /= 2;
        return polygonize(insertKnotsAtSurface(field, options.iso, progress), rest, progress);
    }
    constexpr std::string_view kStage = "polygonizing";
    const ShiftedField shifted(field, options.iso);
    const ToWorld toWorld(field.transform());
    TriangleMesh mesh;
    progress(kStage, 0);
    std::vector<Block> blocks = sample(shifted, progress);
    progress(kStage, 0.4);
    linkBlocks(blocks, shifted, progress);
    cross(blocks, shifted, progress);
    number(blocks, mesh);
    progress(kStage, 0.5);
    place(blocks, shifted, toWorld, options, progress, mesh);
    progress(kStage, 0.9);
    connect(blocks, toWorld.mirrors(), progress, mesh);
    progress(kStage, 1);
    return mesh;
}

}  // namespace isowave
