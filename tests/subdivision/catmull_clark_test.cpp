// Catmull-Clark backwards, one step: the published numbers (O section 6), every kind of vertex, all variants.
#include "subdivision/meshes/catmull_clark.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "subdivision/meshes/hierarchy.h"
#include "tests/subdivision/mesh_zoo.h"

namespace isowave::subdivision {
namespace {

using namespace mesh_zoo;

constexpr CatmullClarkVariant kVariants[] = {CatmullClarkVariant::refined, CatmullClarkVariant::trial,
                                             CatmullClarkVariant::unscaled, CatmullClarkVariant::tensor};

// P by O(4) to O(6) and by looking through all faces for each point: nothing of Adjacency, no alpha.
std::vector<Vec3> plainSubdivision(const PolygonMesh& mesh) {
    using Edge = std::pair<Index, Index>;
    std::map<Edge, std::vector<std::size_t>> edges;
    std::vector<Edge> order;
    std::vector<Vec3> facePoints;
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        const auto face = mesh.face(f);
        Vec3 sum;
        for (std::size_t k = 0; k < face.size(); ++k) {
            sum += mesh.points[face[k]];
            const Edge edge = std::minmax(face[k], face[(k + 1) % face.size()]);
            if (!edges.count(edge)) order.push_back(edge);
            edges[edge].push_back(f);
        }
        facePoints.push_back((1.0 / double(face.size())) * sum);
    }
    std::set<Edge> sharp;
    for (const auto& [edge, faces] : edges)
        if (faces.size() == 1) sharp.insert(edge);
    for (const Crease& c : mesh.creases) sharp.insert(std::minmax(c.a, c.b));

    std::vector<Vec3> points;
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
        Vec3 neighbours, faces, curve;
        int n = 0, sharpEdges = 0, faceCount = 0;
        for (const auto& [edge, of] : edges) {
            if (edge.first != v && edge.second != v) continue;
            const Vec3 other = mesh.points[edge.first == v ? edge.second : edge.first];
            ++n;
            neighbours += other;
            if (!sharp.count(edge)) continue;
            ++sharpEdges;
            curve += other;
        }
        for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
            const auto face = mesh.face(f);
            if (std::find(face.begin(), face.end(), v) == face.end()) continue;
            faces += facePoints[f];
            ++faceCount;
        }
        const bool pinned = std::find(mesh.pinned.begin(), mesh.pinned.end(), v) != mesh.pinned.end();
        if (pinned || sharpEdges > 2 || faceCount == 1)
            points.push_back(mesh.points[v]);
        else if (sharpEdges == 2)
            points.push_back(0.75 * mesh.points[v] + 0.125 * curve);
        else
            points.push_back((n - 2.0) / n * mesh.points[v] + 1.0 / n / n * (neighbours + faces));
    }
    for (const Edge& edge : order) {
        const Vec3 ends = mesh.points[edge.first] + mesh.points[edge.second];
        points.push_back(sharp.count(edge)
                             ? 0.5 * ends
                             : 0.25 * (ends + facePoints[edges[edge][0]] + facePoints[edges[edge][1]]));
    }
    points.insert(points.end(), facePoints.begin(), facePoints.end());
    return points;
}

TEST(CatmullClark, SubdividesAsTheRulesSay) {
    for (const auto& [name, mesh] : all()) {
        const CatmullClarkStep step(mesh, CatmullClarkVariant::trial);
        EXPECT_LT(distance(step.subdivide(mesh.points), plainSubdivision(mesh)), 1e-14)
            << name;  // seen 9e-16
        PolygonMesh fine = step.fineMesh();
        fine.points = step.subdivide(mesh.points);
        EXPECT_TRUE(defects(fine).empty()) << name << ": " << defects(fine).front();
        EXPECT_EQ(fine.faceCount(), mesh.corners.size()) << name;
    }
}

TEST(CatmullClark, KeepsTheCanonicalOrderThatStepsPromise) {
    for (const auto& [name, mesh] : all()) {
        const CatmullClarkStep step(mesh, CatmullClarkVariant::refined);
        const PolygonMesh fine = step.fineMesh();
        for (std::size_t c = 0; c < mesh.corners.size(); ++c)
            ASSERT_EQ(fine.corners[fine.faceBegin[c]], mesh.corners[c]) << name;
    }
}

// ---- the identities of mesh_scheme.h ----

TEST(CatmullClark, OfASubdivisionHasNoDetailsAndTheSameBase) {
    for (const auto& [name, mesh] : injective()) {
        for (const auto variant : kVariants) {
            const CatmullClarkStep step(mesh, variant);
            Random random(7);
            const auto base = random.vectors(mesh.vertexCount());
            const auto parts = step.decompose(step.subdivide(base));
            EXPECT_LT(distance(parts.coarse, base), 1e-12) << name;  // seen 1e-14
            EXPECT_LT(largest(parts.stored), 1e-12) << name;         // seen 1e-14
        }
    }
}

TEST(CatmullClark, OfAnAlternatingComponentIsTheSameUpToTheKernel) {
    for (const auto& [name, mesh] : ambiguous()) {
        for (const auto variant : kVariants) {
            const CatmullClarkStep step(mesh, variant);
            EXPECT_EQ(step.ambiguousComponents(), 1u) << name;
            Random random(8);
            const auto fine = step.subdivide(random.vectors(mesh.vertexCount()));
            const auto parts = step.decompose(fine);
            EXPECT_LT(largest(parts.stored), 1e-12) << name;
            EXPECT_LT(distance(step.subdivide(parts.coarse), fine), 1e-12) << name;
            // These shapes are symmetric, so nearest to the fine vertices is the base itself.
            EXPECT_LT(distance(step.decompose(step.subdivide(mesh.points)).coarse, mesh.points), 1e-12)
                << name;
        }
    }
}

TEST(CatmullClark, PutsRandomPointsBackTogether) {
    for (const auto& [name, mesh] : all()) {
        for (const auto variant : kVariants) {
            const CatmullClarkStep step(mesh, variant);
            Random random(9);
            const auto fine = random.vectors(step.fineSize());
            const auto parts = step.decompose(fine);
            EXPECT_EQ(parts.coarse.size() + parts.stored.size(), fine.size()) << name;
            EXPECT_LT(distance(step.reconstruct(parts.coarse, parts.stored), fine), 1e-12)
                << name;  // seen 4e-14
        }
    }
}

// The same the other way round: whatever is stored is found again, so nothing that is stored is superfluous.
TEST(CatmullClark, FindsWhateverWasStored) {
    for (const auto& [name, mesh] : all()) {
        const CatmullClarkStep step(mesh, CatmullClarkVariant::refined);
        Random random(10);
        const auto coarse = random.vectors(step.coarseSize());
        const auto stored = random.vectors(step.fineSize() - step.coarseSize());
        const auto parts = step.decompose(step.reconstruct(coarse, stored));
        EXPECT_LT(distance(parts.coarse, coarse), 1e-11) << name;  // seen 2e-13
        EXPECT_LT(distance(parts.stored, stored), 1e-11) << name;  // seen 2e-13
    }
}

TEST(CatmullClark, OfTheCubeHasRank7AndOfTheTetrahedronFullRank) {
    const auto rankOf = [](const PolygonMesh& mesh) {
        const CatmullClarkStep step(mesh, CatmullClarkVariant::trial);
        Eigen::MatrixXd P(Eigen::Index(step.fineSize()), Eigen::Index(step.coarseSize()));
        for (std::size_t v = 0; v < step.coarseSize(); ++v) {
            std::vector<Vec3> unit(step.coarseSize());
            unit[v].x = 1;
            const auto column = step.subdivide(unit);
            for (std::size_t i = 0; i < column.size(); ++i) P(Eigen::Index(i), Eigen::Index(v)) = column[i].x;
        }
        return Eigen::FullPivLU<Eigen::MatrixXd>(P).rank();
    };
    EXPECT_EQ(rankOf(cube()), 7);
    EXPECT_EQ(rankOf(tetrahedron()), 4);
    EXPECT_EQ(rankOf(prism(3)), 6);
    EXPECT_EQ(rankOf(prism(6)), 11);
    for (const auto& [name, mesh] : injective())
        EXPECT_EQ(rankOf(mesh), Eigen::Index(mesh.vertexCount())) << name;
}

// ---- the published numbers ----

constexpr Index kSide = 16;

// Row of the fine-to-coarse map at the middle of a closed regular mesh, as weights on the 2 kSide x 2 kSide fine grid,
// [0][0] at the vertex itself. `map` takes fine points and returns coarse ones.
template <class Map>
std::map<std::pair<int, int>, double> rowAt(const CatmullClarkStep& step, Index vertex, Map map) {
    const PolygonMesh fine = step.fineMesh();
    const Adjacency adjacency(fine);
    // Walk out from the vertex: i steps straight ahead, then j to the left.
    std::map<std::pair<int, int>, double> row;
    const auto left = [&](Index c) { return adjacency.nextAround(c); };
    const auto opposite = [&](Index c) { return left(left(c)); };
    const auto straight = [&](Index c) { return opposite(left(adjacency.next(c))); };
    const Index east = adjacency.outgoing(vertex);
    for (int i = -4; i <= 4; ++i) {
        Index along = i < 0 ? opposite(east) : east;
        for (int k = 0; k < std::abs(i); ++k) along = straight(along);
        const Index up = i < 0 ? opposite(left(along)) : left(along);
        for (int j = -4; j <= 4; ++j) {
            Index at = j < 0 ? opposite(up) : up;
            for (int k = 0; k < std::abs(j); ++k) at = straight(at);
            std::vector<Vec3> unit(step.fineSize());
            unit[adjacency.vertex(at)].x = 1;
            const double weight = map(unit)[vertex].x;
            if (std::abs(weight) > 1e-13) row[{i, j}] = weight;
        }
    }
    return row;
}

std::map<std::pair<int, int>, double> rowOfA(CatmullClarkVariant variant) {
    const CatmullClarkStep step(torus(kSide, kSide), variant);
    return rowAt(step, kSide * 5 + 5, [&](const auto& fine) { return step.decompose(fine).coarse; });
}

double squaredNorm(const std::map<std::pair<int, int>, double>& row) {
    double sum = 0;
    for (const auto& [at, weight] : row) sum += weight * weight;
    return sum;
}

TEST(CatmullClark, OfARegularMeshHasThePublishedTrialMask) {
    const auto row = rowOfA(CatmullClarkVariant::trial);
    ASSERT_EQ(row.size(), 9u);
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j) EXPECT_NEAR(row.at({i, j}), i && j ? 0.25 : i || j ? -1 : 4, 1e-14);
}

TEST(CatmullClark, OfARegularMeshWithTheTensorVariantIsTheProductOfTwoCurves) {
    const double a[] = {52.0 / 49, 9.0 / 28, -23.0 / 49, 23.0 / 196};  // B(2.11)
    const auto row = rowOfA(CatmullClarkVariant::tensor);
    ASSERT_EQ(row.size(), 49u);
    for (const auto& [at, weight] : row)
        EXPECT_NEAR(weight, a[std::abs(at.first)] * a[std::abs(at.second)], 1e-14);
    const CatmullClarkStep step(torus(kSide, kSide), CatmullClarkVariant::tensor);
    EXPECT_EQ(step.tensorVertices(), std::size_t(kSide * kSide));
}

TEST(CatmullClark, AmplifiesNoiseLessTheWiderItIs) {
    EXPECT_NEAR(squaredNorm(rowOfA(CatmullClarkVariant::trial)), 20.25, 1e-12);
    EXPECT_NEAR(squaredNorm(rowOfA(CatmullClarkVariant::refined)), 7.2, 0.05);
    EXPECT_NEAR(squaredNorm(rowOfA(CatmullClarkVariant::tensor)), 3.2, 0.05);
}

// shift() of one unit detail.
double shiftBy(const CatmullClarkStep& step, Index vertex, Index detail) {
    std::vector<Vec3> unit(step.fineSize());
    unit[detail].x = 1;
    return step.shift(unit)[vertex].x;
}

TEST(CatmullClark, RefinesRegularVerticesByTheWeightsOfOlsenAndSamavati) {
    const PolygonMesh mesh = torus(kSide, kSide);
    const CatmullClarkStep step(mesh, CatmullClarkVariant::refined);
    const Adjacency& adjacency = step.adjacency();
    const auto V = Index(mesh.vertexCount());
    const Index v = 40, c = adjacency.outgoing(v);
    EXPECT_NEAR(shiftBy(step, v, V + adjacency.edge(c)), 297.0 / 1156, 1e-15);
    EXPECT_NEAR(shiftBy(step, v, V + Index(adjacency.edges()) + adjacency.face(c)), 495.0 / 4624, 1e-15);
    EXPECT_EQ(shiftBy(step, v, v), 0) << "d_v is not independent: it must not count twice";
}

TEST(CatmullClark, AtABoundaryIsTheCubicCurve) {
    const PolygonMesh mesh = grid(8, 8);
    const auto V = Index(mesh.vertexCount());
    const Index v = 4, corner = 0;  // on the first side
    const struct {
        CatmullClarkVariant variant;
        double shift;
    } cases[] = {{CatmullClarkVariant::trial, 0},
                 {CatmullClarkVariant::refined, 33.0 / 68},
                 {CatmullClarkVariant::unscaled, 11.0 / 17},
                 {CatmullClarkVariant::tensor, 23.0 / 49}};
    for (const auto& each : cases) {
        const CatmullClarkStep step(mesh, each.variant);
        for (Index d = V; d < step.fineSize(); ++d) {
            const Index e = d - V;
            const bool side = e < step.adjacency().edges() && step.adjacency().isBoundaryEdge(e) &&
                              (step.adjacency().vertex(step.adjacency().edgeCorner(e)) == v ||
                               step.adjacency().target(step.adjacency().edgeCorner(e)) == v);
            EXPECT_NEAR(shiftBy(step, v, d), side ? each.shift : 0, 1e-15);
            EXPECT_EQ(shiftBy(step, corner, d), 0);
        }
        // Trial: [-1/2, 2, -1/2] along the side, nothing from inside; the corner is kept.
        Random random(3);
        auto fine = random.vectors(step.fineSize());
        const auto coarse = step.decompose(fine).coarse;
        EXPECT_EQ(coarse[corner], fine[corner]);
        for (std::size_t i = 0; i < fine.size(); ++i) {
            const auto c = Index(i) - V;
            const bool onSide = i < V ? (i <= 8 || i >= 72 || i % 9 == 0 || i % 9 == 8)
                                      : c < step.adjacency().edges() && step.adjacency().isBoundaryEdge(c);
            if (!onSide) fine[i] += {1, 2, 3};
        }
        EXPECT_LT(length(step.decompose(fine).coarse[v] - coarse[v]), 1e-14)
            << "a side hears nothing from inside";
    }
}

TEST(CatmullClark, AlongACreaseHearsNothingFromBesideIt) {
    const PolygonMesh mesh =
        creased(torus(8, 8), {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}, {6, 7}, {7, 0}});
    for (const auto variant : kVariants) {
        const CatmullClarkStep step(mesh, variant);
        Random random(4);
        auto fine = random.vectors(step.fineSize());
        const auto before = step.decompose(fine).coarse;
        std::set<Index> curve{0, 1, 2, 3, 4, 5, 6, 7};
        for (const Crease& c : mesh.creases)
            curve.insert(Index(mesh.vertexCount()) + step.adjacency().edgeBetween(c.a, c.b));
        for (Index i = 0; i < fine.size(); ++i)
            if (!curve.count(i)) fine[i] += random.vector();
        const auto after = step.decompose(fine).coarse;
        for (Index v = 0; v < 8; ++v) EXPECT_LT(length(after[v] - before[v]), 1e-14);
        EXPECT_GT(length(after[9] - before[9]), 0.01) << "the others do hear it";
    }
}

// ---- noise ----

// Heights on a closed N x N grid whose octaves, of random control points each, double in size from one to the next.
std::vector<double> roughHeights(Index N) {
    Random random(5);
    std::vector<double> heights(N * N, 0);
    double size = 1.0 / N;
    for (Index n = N / 2; n >= 2; n /= 2) {
        size *= 2;
        std::vector<double> octave(n * n);
        for (double& h : octave) h = size * random();
        for (Index m = n; m < N;
             m *= 2) {  // one subdivision: the cubic B-spline, along rows and along columns
            std::vector<double> fine(4 * m * m, 0);
            constexpr double kMask[] = {1.0 / 8, 1.0 / 2, 3.0 / 4, 1.0 / 2, 1.0 / 8};
            for (Index j = 0; j < m; ++j)
                for (Index i = 0; i < m; ++i)
                    for (Index b = 0; b < 5; ++b)
                        for (Index a = 0; a < 5; ++a)
                            fine[(2 * j + b + 2 * m - 2) % (2 * m) * 2 * m +
                                 (2 * i + a + 2 * m - 2) % (2 * m)] +=
                                kMask[a] * kMask[b] * octave[j * m + i];
            octave = std::move(fine);
        }
        for (std::size_t k = 0; k < heights.size(); ++k) heights[k] += octave[k];
    }
    return heights;
}

TEST(CatmullClark, LosesTheLessTheWiderItIs) {
    constexpr Index N = 256;
    PolygonMesh mesh = torus(N, N);
    const auto heights = roughHeights(N);
    double size = 0;
    for (std::size_t v = 0; v < heights.size(); ++v) {
        mesh.points[v] = {mesh.points[v].x, mesh.points[v].y, heights[v]};
        size += heights[v] * heights[v];
    }
    std::map<std::string, double> error;
    for (const char* variant : {"trial", "unscaled", "refined", "tensor"}) {
        Hierarchy hierarchy = decompose(mesh, meshScheme("catmull-clark"), variant, 3);
        for (auto& details : hierarchy.details) std::fill(details.begin(), details.end(), Vec3{});
        const auto without = reconstruct(hierarchy).points;
        double sum = 0;
        for (std::size_t v = 0; v < without.size(); ++v)
            sum += (without[v].z - heights[v]) * (without[v].z - heights[v]);
        error[variant] = std::sqrt(sum / size);
        RecordProperty(variant, std::to_string(error[variant]));
    }
    // Of another rough torus was seen:  trial 0.58, unscaled 0.45, refined 0.168, tensor 0.069, that is
    //                                   1 : 0.78 : 0.29 : 0.12.
    EXPECT_LT(error["trial"], 0.6) << error["trial"];
    EXPECT_NEAR(error["unscaled"] / error["trial"], 0.78, 0.15) << error["unscaled"];
    EXPECT_NEAR(error["refined"] / error["trial"], 0.29, 0.06) << error["refined"];
    EXPECT_NEAR(error["tensor"] / error["trial"], 0.12, 0.04) << error["tensor"];
}

}  // namespace
}  // namespace isowave::subdivision
