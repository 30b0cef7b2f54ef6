#include "tests/fuzz/solids/shapes.h"

#include <algorithm>
#include <cmath>

#include "isowave/isowave.h"
#include "isowave/openvdb.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/solids/written.h"
#include "tests/zoo/box.h"
#include "tests/zoo/mesh_check.h"

namespace isowave::fuzz {
namespace {

// ---- what comes out

void requireSound(const TriangleMesh& mesh) {
    const std::string wrong = zoo::whatIsWrongWith(mesh);
    require(wrong.empty(), ("a mesh is not closed and 2-manifold: " + wrong).c_str());
    for (const Point& p : mesh.points)
        for (const double x : p) require(std::isfinite(x), "a vertex that is not finite");
}

// Every known control point of a, in b.
void requireEqual(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b, double tolerance) {
    require(a.activeVoxelCount() == b.activeVoxelCount(), "the pyramid restores other control points");
    const auto other = b.getConstAccessor();
    for (auto c = a.cbeginValueOn(); c; ++c) {
        float value = 0;
        require(other.probeValue(c.getCoord(), value), "the pyramid does not restore a control point");
        require(std::abs(double(*c) - double(value)) <= tolerance,
                "a control point comes back with another value");
    }
}

void checkPyramid(const Solid& solid, Bytes& bytes) {
    constexpr double kLossless = 1e-5;  // of K; tests/wavelets/random_shapes_test.cpp sees 1e-6
    const Pyramid pyramid = analyse(solid);
    requireEqual(*gridOf(fieldOf(solid)), *gridOf(pyramid.field(0)), kLossless * pyramid.K());
    constexpr int kRefines[] = {1, 1, 2, 4};
    for (int step = 0; step <= pyramid.stepCount(); ++step) {
        const FieldMeshOptions options{.refine = step > 2 ? kRefines[bytes.between(0, 3)] : 1,
                                       .iso = bytes.between(-2, 2) * 0.2 * pyramid.K()};
        requireSound(pyramid.field(step).polygonize(options));
    }
}

bool isMore(const SolidCounts& now, const SolidCounts& before) {
    return now.parts > before.parts || now.handles > before.handles || now.cavities > before.cavities;
}

LevelOptions levelOptions(Bytes& bytes) {
    LevelOptions options;
    if (bytes.between(0, 3) == 3) options.refine = 1 << bytes.between(0, 2);
    if (bytes.between(0, 7) == 7) options.hold = Holding::shift;
    if (bytes.between(0, 7) == 7) options.maxGenus = bytes.between(0, 2);
    if (bytes.between(0, 7) == 7) options.maxParts = bytes.between(1, 2);
    if (bytes.between(0, 7) == 7) options.relax = bytes.between(1, 3);
    options.keepSpecks = bytes.between(0, 7) == 7;
    options.features = bytes.between(0, 15) == 15;
    options.deviation = bytes.between(0, 15) == 15;
    return options;
}

// The promise is that of the default; options may ask for something else.
void checkLadder(const Solid& solid, Bytes& bytes) {
    const LevelOptions options = levelOptions(bytes);
    const bool falls = options.hold == Holding::local && !options.keepSpecks;
    const Ladder ladder = makeLadder(solid, options);
    const Writing writing(bytes);
    std::optional<SolidCounts> before;
    for (const Level& level : ladder.levels) {
        requireSound(level.mesh);
        requireWritten(level.mesh, writing);
        const SolidCounts counts = countsOf(level.report.topology);
        if (falls && before && isMore(counts, *before))
            require(level.report.limitsMissed.has_value(), "a level has more than the one before, unsaid");
        before = counts;
    }
}

void checkFit(const Solid& solid) {
    if (!solid.fit() || !solid.fit()->repairAgreed) return;
    require(solid.fit()->disagreeing == 0, "the fit's signs are not the input's, though the repair agreed");
}

void checkSolid(const Solid& solid, Bytes& bytes) {
    checkFit(solid);
    checkPyramid(solid, bytes);
    checkLadder(solid, bytes);
}

// ---- a lattice

struct Box {
    std::array<int, 3> low{}, high{};
    bool holds(const std::array<int, 3>& p) const {
        for (int a = 0; a < 3; ++a)
            if (p[a] < low[a] || p[a] > high[a]) return false;
        return true;
    }
};

Box boxIn(const std::array<std::int64_t, 3>& size, Bytes& bytes) {
    Box box;
    for (int a = 0; a < 3; ++a) {
        box.low[a] = bytes.between(0, static_cast<int>(size[a]) - 1);
        box.high[a] = bytes.between(box.low[a], static_cast<int>(size[a]) - 1);
    }
    return box;
}

template <class F>
void forVoxels(Image& image, const F& set) {
    std::size_t i = 0;
    for (int z = 0; z < image.size[2]; ++z)
        for (int y = 0; y < image.size[1]; ++y)
            for (int x = 0; x < image.size[0]; ++x) set(std::array{x, y, z}, image.values[i++]);
}

// Boxes put together and taken away, then grey values or single voxels as the bytes say.
Image imageOf(Bytes& bytes) {
    constexpr int kLargest = 9;
    Image image;
    for (std::int64_t& n : image.size) n = bytes.between(2, kLargest);
    for (int a = 0; a < 3; ++a) image.indexToWorld.axis[a][a] = 1 + bytes.between(0, 2) * 0.5;
    image.componentType = "int16";
    image.integral = true;
    image.format = "bytes";
    image.values.assign(static_cast<std::size_t>(image.voxelCount()), 0);
    for (int k = bytes.between(0, 6); k-- > 0;) {
        const float value = bytes.between(0, 2) == 0 ? 0.0f : 1.0f;
        const Box box = boxIn(image.size, bytes);
        forVoxels(image, [&](const auto& p, float& v) { v = box.holds(p) ? value : v; });
    }
    const bool grey = bytes.flag(), noise = bytes.flag();
    if (grey)
        forVoxels(image, [&](const auto&, float& v) {
            v = std::round(100 * v + static_cast<float>(bytes.next() - 128));
        });
    if (!grey && noise) forVoxels(image, [&](const auto&, float& v) { v = bytes.flag() ? 1 - v : v; });
    return image;
}

SolidOptions imageOptions(Bytes& bytes) {
    constexpr FitMethod kFits[] = {FitMethod::mask, FitMethod::binary, FitMethod::distance};
    SolidOptions options;
    options.iso = 0.5 + bytes.between(-1, 1) * 0.25;
    options.invert = bytes.between(0, 7) == 7;
    if (const int fit = bytes.between(0, 3); fit < 3) options.fit = kFits[fit];
    return options;
}

Answer latticeSolid(std::string_view input) {
    return answerOf("image", [&] {
        Bytes bytes(input);
        const SolidOptions options = imageOptions(bytes);
        checkSolid(open(imageOf(bytes), options), bytes);
    });
}

// ---- a triangle mesh

void add(TriangleMesh& mesh, const std::vector<Point>& points, const std::vector<Triangle>& triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), points.begin(), points.end());
    for (const auto& [a, b, c] : triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}

Point pointOf(Bytes& bytes) {
    Point point;
    for (double& x : point) x = bytes.between(0, 20) * 0.5;
    return point;
}

void addTetrahedron(TriangleMesh& mesh, Bytes& bytes) {
    const std::vector<Point> points{pointOf(bytes), pointOf(bytes), pointOf(bytes), pointOf(bytes)};
    add(mesh, points, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
}

void addBox(TriangleMesh& mesh, Bytes& bytes) {
    const Point a = pointOf(bytes), b = pointOf(bytes);
    std::vector<Point> points;
    for (int i = 0; i < 8; ++i)
        points.push_back({i & 1 ? b[0] : a[0], i & 2 ? b[1] : a[1], i & 4 ? b[2] : a[2]});
    add(mesh, points, {zoo::kBoxTriangles.begin(), zoo::kBoxTriangles.end()});
}

// Bodies of either orientation, which may lie in each other, touch, overlap or have no volume; now and then a triangle is missing
// or turned.
TriangleMesh meshOf(Bytes& bytes) {
    TriangleMesh mesh;
    for (int k = bytes.between(1, 6); k-- > 0;)
        bytes.flag() ? addBox(mesh, bytes) : addTetrahedron(mesh, bytes);
    if (bytes.between(0, 3) == 3)
        mesh.triangles.erase(mesh.triangles.begin() + bytes.next() % mesh.triangles.size());
    if (bytes.between(0, 3) == 3) std::swap(mesh.triangles.back()[0], mesh.triangles.back()[1]);
    return mesh;
}

Answer meshSolid(std::string_view input) {
    return answerOf("mesh", [&] {
        Bytes bytes(input);
        SolidOptions options;
        options.voxels = bytes.between(6, 14);
        if (const int more = bytes.between(0, 7); more == 6)
            options.closeHoles = 20;
        else if (more == 7)
            options.thicken = 2;
        if (bytes.between(0, 7) == 7) options.fit = FitMethod::binary;
        checkSolid(open(meshOf(bytes), options), bytes);
    });
}

}  // namespace

std::vector<Target> shapeTargets() { return {{"lattice-solid", latticeSolid}, {"mesh-solid", meshSolid}}; }

}  // namespace isowave::fuzz
