#include "subdivision/meshes/hierarchy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <numeric>

#include "isowave/error.h"

namespace isowave::subdivision {
namespace {

// The steps from the base upwards, each over the connectivity that the one below makes.
struct Steps {
    std::vector<std::unique_ptr<SubdivisionStep>> list;
    PolygonMesh finest;  // connectivity alone; its points are 0 or the base's
};

Steps stepsFrom(const PolygonMesh& base, const MeshScheme& scheme, std::string_view variant, int count,
                const Progress& progress) {
    Steps steps;
    steps.finest = base;
    for (int k = 0; k < count; ++k) {
        progress("connecting", double(k) / count);
        steps.list.push_back(scheme.step(steps.finest, variant));
        steps.finest = steps.list.back()->fineMesh();
    }
    return steps;
}

// Which corner of the given mesh each corner of the canonical finest mesh is. Level by level from the base, where
// both are the same mesh: a step's fine face c and the recovered fine corner of c belong together, and so does what
// is around them.
std::vector<Index> canonicalToGiven(const PolygonMesh& given, const std::vector<Coarsening>& coarsenings,
                                    const MeshScheme& scheme, std::string_view variant,
                                    const Progress& progress) {
    PolygonMesh mesh = coarsenings.back().coarse;
    std::vector<Index> corner(mesh.corners.size());
    std::iota(corner.begin(), corner.end(), Index{0});
    for (std::size_t k = coarsenings.size(); k-- > 0;) {
        progress("matching", double(coarsenings.size() - 1 - k) / double(coarsenings.size()));
        PolygonMesh fine = scheme.step(mesh, variant)->fineMesh();
        std::vector<CornerPair> known(corner.size());
        for (std::size_t c = 0; c < corner.size(); ++c)
            known[c] = {fine.faceBegin[c], coarsenings[k].fineCorner[corner[c]]};
        corner = correspondingCorners(Adjacency(fine), Adjacency(k == 0 ? given : coarsenings[k - 1].coarse),
                                      known);
        assert(!corner.empty() && "recover() returned a mesh that does not refine to the one it was given");
        mesh = std::move(fine);
    }
    return corner;
}

FinestOrder orderOf(const PolygonMesh& canonical, const PolygonMesh& given,
                    const std::vector<Index>& corner) {
    FinestOrder order;
    order.vertex.resize(canonical.vertexCount());
    for (std::size_t c = 0; c < corner.size(); ++c)
        order.vertex[canonical.corners[c]] = given.corners[corner[c]];
    for (std::size_t f = 0; f < canonical.faceCount(); ++f)
        order.firstCorner.push_back(corner[canonical.faceBegin[f]]);
    const auto counts = [](const std::vector<Index>& list, auto expected) {
        for (std::size_t i = 0; i < list.size(); ++i)
            if (list[i] != expected(i)) return false;
        return true;
    };
    if (counts(order.vertex, [](std::size_t i) { return i; }) &&
        counts(order.firstCorner, [&](std::size_t f) { return canonical.faceBegin[f]; }))
        return {};
    return order;
}

// The canonical finest mesh with its vertices and faces where they were. All its faces have the same size.
PolygonMesh reordered(const PolygonMesh& mesh, const FinestOrder& order) {
    if (order.empty()) return mesh;
    const std::size_t size = mesh.faceSize(0);
    PolygonMesh result;
    result.faceBegin = mesh.faceBegin;
    result.points.resize(mesh.vertexCount());
    for (std::size_t v = 0; v < mesh.vertexCount(); ++v) result.points[order.vertex[v]] = mesh.points[v];
    result.corners.resize(mesh.corners.size());
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        const std::size_t begin = order.firstCorner[f] / size * size, turn = order.firstCorner[f] % size;
        for (std::size_t k = 0; k < size; ++k)
            result.corners[begin + (turn + k) % size] = order.vertex[mesh.corners[f * size + k]];
    }
    for (const Crease& c : mesh.creases)
        result.creases.push_back({order.vertex[c.a], order.vertex[c.b], c.sharpness});
    for (const Index v : mesh.pinned) result.pinned.push_back(order.vertex[v]);
    return result;
}

// Which fine edges lie along which base edge? Let every base edge be a crease: `count` steps make 2^count creases of each,
// in the order of the base's.
void addCreases(const PolygonMesh& given, const std::vector<Index>& corner, const MeshScheme& scheme,
                int count, double degrees, PolygonMesh& base) {
    PolygonMesh all = base;
    all.creases.clear();
    const Adjacency coarse(base);
    for (Index e = 0; e < coarse.edges(); ++e)
        all.creases.push_back({coarse.vertex(coarse.edgeCorner(e)), coarse.target(coarse.edgeCorner(e)), 1});
    const PolygonMesh finest = stepsFrom(all, scheme, scheme.variants.front(), count, {}).finest;

    std::vector<Index> ofVertex(finest.vertexCount());
    for (std::size_t c = 0; c < corner.size(); ++c) ofVertex[finest.corners[c]] = given.corners[corner[c]];
    const Adjacency fine(given);
    const auto folded = edgeSharpness(fine, creasesByAngle(given, fine, degrees));
    const auto marked = edgeSharpness(coarse, base.creases);
    const std::size_t pieces = std::size_t{1} << count;
    for (Index e = 0; e < coarse.edges(); ++e) {
        std::size_t sharp = 0;
        for (std::size_t k = e * pieces; k < (e + 1) * pieces; ++k) {
            const Crease& piece = finest.creases[k];
            if (folded[fine.edgeBetween(ofVertex[piece.a], ofVertex[piece.b])] > 0) ++sharp;
        }
        if (2 * sharp > pieces && marked[e] == 0) base.creases.push_back(all.creases[e]);
    }
}

void requireDetails(const std::vector<Vec3>& details, const SubdivisionStep& step, int number) {
    const std::size_t expected = step.fineSize() - step.coarseSize();
    if (details.size() == expected) return;
    throw InputError(fmt::format(
        "the details of step {} are {}, but this base needs {} there; they belong to another base", number,
        details.size(), expected));
}

}  // namespace

Hierarchy decompose(const PolygonMesh& mesh, const MeshScheme& scheme, const DecomposeOptions& options,
                    const Progress& progress) {
    if (const auto lines = defects(mesh); !lines.empty()) throw InputError(lines.front());
    Hierarchy result{
        std::string(scheme.name), std::string(meshVariant(scheme, options.variant)), mesh, {}, false, {}};
    const auto coarsenings = scheme.recover(mesh, options.levels, progress);
    if (coarsenings.empty()) return result;

    const int count = static_cast<int>(coarsenings.size());
    result.base = coarsenings.back().coarse;
    const auto corner = canonicalToGiven(mesh, coarsenings, scheme, result.variant, progress);
    if (options.creaseAngle) addCreases(mesh, corner, scheme, count, *options.creaseAngle, result.base);
    const Steps steps = stepsFrom(result.base, scheme, result.variant, count, progress);
    result.order = orderOf(steps.finest, mesh, corner);

    std::vector<Vec3> points(mesh.vertexCount());
    for (std::size_t c = 0; c < corner.size(); ++c)
        points[steps.finest.corners[c]] = mesh.points[mesh.corners[corner[c]]];
    result.details.resize(steps.list.size());
    for (std::size_t k = steps.list.size(); k-- > 0;) {
        progress("decomposing", double(steps.list.size() - 1 - k) / double(steps.list.size()));
        auto parts = steps.list[k]->decompose(points);
        result.details[k] = std::move(parts.stored);
        points = std::move(parts.coarse);
    }
    result.base.points = std::move(points);
    return result;
}

PolygonMesh rebuilt(const Hierarchy& hierarchy, int steps, const Progress& progress,
                    const StepFunction& takeStep) {
    const int count = steps == kAllLevels ? hierarchy.steps() : steps;
    if (count > hierarchy.steps())
        throw InputError(
            fmt::format("holds details for {} levels, but {} were asked for", hierarchy.steps(), count));
    const MeshScheme& scheme = meshScheme(hierarchy.scheme);
    PolygonMesh mesh = hierarchy.base;
    for (int k = 0; k < count; ++k) {
        progress("reconstructing", double(k) / count);
        const auto step = scheme.step(mesh, hierarchy.variant);
        requireDetails(hierarchy.details[k], *step, k + 1);
        PolygonMesh fine = step->fineMesh();
        takeStep(*step, mesh.points, hierarchy.details[k], fine);
        mesh = std::move(fine);
    }
    const bool finest = count == hierarchy.steps() && !hierarchy.truncated;
    return finest ? reordered(mesh, hierarchy.order) : mesh;
}

PolygonMesh reconstruct(const Hierarchy& hierarchy, int steps, const Progress& progress) {
    return rebuilt(
        hierarchy, steps, progress,
        [](const SubdivisionStep& step, const std::vector<Vec3>& coarse, const std::vector<Vec3>& stored,
           PolygonMesh& fine) { fine.points = step.reconstruct(coarse, stored); });
}

PolygonMesh subdivided(const PolygonMesh& mesh, const MeshScheme& scheme, int levels,
                       const Progress& progress) {
    if (const auto lines = defects(mesh); !lines.empty()) throw InputError(lines.front());
    PolygonMesh result = mesh;
    for (int k = 0; k < levels; ++k) {
        progress("subdividing", double(k) / levels);
        if (4 * std::uint64_t{result.corners.size()} >= kNone)
            throw InputError(fmt::format("is too large to be subdivided {} times; {} will do", levels, k));
        const auto step = scheme.step(result, scheme.variants.front());
        PolygonMesh fine = step->fineMesh();
        fine.points = step->subdivide(result.points);
        result = std::move(fine);
    }
    return result;
}

std::vector<Vec3> limitPoints(const PolygonMesh& mesh, const MeshScheme& scheme) {
    if (const auto lines = defects(mesh); !lines.empty()) throw InputError(lines.front());
    if (4 * std::uint64_t{mesh.corners.size()} >= kNone)
        throw InputError(
            fmt::format("has {} corners of faces, too many for limit positions; take it at a "
                        "coarser level",
                        mesh.corners.size()));
    const auto step = scheme.step(mesh, scheme.variants.front());
    return step->limit(step->subdivide(mesh.points));
}

Hierarchy decompose(const PolygonMesh& mesh, std::string_view scheme, const DecomposeOptions& options,
                    const Progress& progress) {
    return decompose(mesh, meshScheme(scheme), options, progress);
}

PolygonMesh subdivided(const PolygonMesh& mesh, std::string_view scheme, int levels,
                       const Progress& progress) {
    return subdivided(mesh, meshScheme(scheme), levels, progress);
}

std::vector<Vec3> limitPoints(const PolygonMesh& mesh, std::string_view scheme) {
    return limitPoints(mesh, meshScheme(scheme));
}

std::vector<std::string> meshSchemeNames() {
    std::vector<std::string> names;
    for (const MeshScheme& scheme : meshSchemes()) names.emplace_back(scheme.name);
    return names;
}

std::vector<std::string> meshVariantNames(std::string_view scheme) {
    const auto& variants = meshScheme(scheme).variants;
    return {variants.begin(), variants.end()};
}

void requireSameConnectivity(const PolygonMesh& base, const PolygonMesh& moved) {
    if (base.vertexCount() != moved.vertexCount() || base.faceCount() != moved.faceCount()) {
        throw InputError(
            fmt::format("has another connectivity: {} vertices and {} faces, but the base has {} and {}; "
                        "move its vertices only",
                        moved.vertexCount(), moved.faceCount(), base.vertexCount(), base.faceCount()));
    }
    for (std::size_t f = 0; f < base.faceCount(); ++f) {
        const auto a = base.face(f), b = moved.face(f);
        if (std::equal(a.begin(), a.end(), b.begin(), b.end())) continue;
        throw InputError(fmt::format(
            "has another connectivity: its face {} has the vertices {}, that of the base {}; keep "
            "the faces and their order",
            f, fmt::join(b, " "), fmt::join(a, " ")));
    }
}

}  // namespace isowave::subdivision
