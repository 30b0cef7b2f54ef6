// Base and details: round trips of whole meshes, the file, creases by angle, editing, thresholding.
#include "subdivision/meshes/hierarchy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "isowave/error.h"
#include "subdivision/lattice/grid_files.h"
#include "subdivision/meshes/hierarchy_edit.h"
#include "subdivision/meshes/hierarchy_report.h"
#include "subdivision/meshes/mesh_files.h"
#include "tests/subdivision/mesh_zoo.h"
#include "tests/subdivision/refusal.h"
#include "tests/temp_folder.h"

namespace isowave::subdivision {
namespace {

using namespace mesh_zoo;
using isowave::test::TempFolder;
using testing::HasSubstr;
namespace fs = std::filesystem;

const fs::path kData = ISOWAVE_TEST_DATA;
const MeshScheme& scheme() { return meshScheme("catmull-clark"); }

// A shape, subdivided, with details on every level, in any order.
PolygonMesh detailed(const PolygonMesh& base, int levels, double size, unsigned seed) {
    Random random(seed);
    PolygonMesh mesh = base;
    for (int k = 0; k < levels; ++k, size /= 4) {
        mesh = subdivided(mesh, scheme(), 1);
        for (Vec3& p : mesh.points) p += size * random.vector();
    }
    return shuffled(mesh, seed + 1);
}

std::string bytesOf(const Hierarchy& hierarchy) {
    std::ostringstream stream;
    writeHierarchy(stream, hierarchy);
    return stream.str();
}

// ---- real cages, real terrain ----

TEST(Hierarchy, OfRealCagesSubdividedAndDetailedComesBack) {
    for (const char* name :
         {"catmark_car.obj", "catmark_rook.obj", "catmark_torus.obj", "catmark_toroidal_tet.obj"}) {
        const fs::path folder = std::string(name).find("toroidal") == std::string::npos ? "subdiv" : "meshes";
        const PolygonMesh cage = readPolygonMesh(kData / folder / name);
        ASSERT_TRUE(defects(cage).empty()) << name << ": " << defects(cage).front();
        const double size = diagonal(cage.points);

        const PolygonMesh smooth = shuffled(subdivided(cage, scheme(), 2), 21);
        const Hierarchy exact = decompose(smooth, scheme(), "refined", 2);
        EXPECT_EQ(exact.base.vertexCount(), cage.vertexCount()) << name;
        EXPECT_EQ(exact.base.creases.size(), cage.creases.size()) << name;
        for (const auto& details : exact.details) EXPECT_LT(largest(details), 1e-12 * size) << name;

        const PolygonMesh fine = detailed(cage, 2, 0.0005 * size, 22);
        const Hierarchy found = decompose(fine, scheme(), "refined", 2);
        EXPECT_EQ(found.base.faceCount(), cage.faceCount()) << name;
        EXPECT_EQ(found.base.points.size() + detailCount(found), fine.points.size()) << name;
        const PolygonMesh back = reconstruct(found);
        EXPECT_EQ(back.corners, fine.corners) << name;
        EXPECT_LT(distance(back.points, fine.points), kMeshRoundTrip * size) << name;  // seen 2e-15
    }
}

// Heights of the terrain as an open grid of quads, cut to the largest size that can be halved `levels` times.
PolygonMesh terrain(int levels) {
    const Grid heights = readGrid(kData / "terrain" / "jacksboro.npy");
    const auto size = [&](std::size_t n) { return Index((n - 1) >> levels << levels); };
    return grid(size(heights.columns), size(heights.rows),
                [&](Index i, Index j) { return heights.at(j, i); });
}

TEST(Hierarchy, OfATerrainHasSmallerErrorsTheWiderItsFilter) {
    const PolygonMesh mesh = terrain(3);
    std::map<std::string, double> error;
    for (const char* variant : {"trial", "refined", "tensor"}) {
        Hierarchy hierarchy = decompose(mesh, scheme(), variant, 3);
        EXPECT_LT(distance(reconstruct(hierarchy).points, mesh.points),
                  kMeshRoundTrip * diagonal(mesh.points));
        clearDetails(hierarchy);
        error[variant] = pointError(reconstruct(hierarchy).points, mesh.points).rms;
    }
    EXPECT_LT(error["refined"], 0.7 * error["trial"]);
    EXPECT_LT(error["tensor"], error["refined"]);
}

// ---- levels ----

TEST(Hierarchy, LevelsAreReadWithoutFinerOnes) {
    const TempFolder folder;
    const fs::path file = folder.path() / "h.details";
    const PolygonMesh fine = detailed(cubeWithPyramid(), 3, 0.1, 23);
    const Hierarchy whole = decompose(fine, scheme(), "refined", 3);
    saveHierarchy(file, whole);
    const auto bytes = fs::file_size(file);
    for (int steps = 0; steps <= 3; ++steps) {
        const Hierarchy part = loadHierarchy(file, steps);
        EXPECT_EQ(part.steps(), steps);
        EXPECT_EQ(reconstruct(part).points, reconstruct(whole, steps).points);
        // The file cut right behind what is needed serves as well.
        std::size_t needed = bytes;
        for (int k = 3; k > steps; --k) needed -= 24 * whole.details[k - 1].size();
        if (steps < 3) needed -= 4 * (whole.order.vertex.size() + whole.order.firstCorner.size());
        const fs::path cut = folder.path() / "cut.details";
        fs::copy_file(file, cut, fs::copy_options::overwrite_existing);
        fs::resize_file(cut, needed);
        EXPECT_EQ(reconstruct(loadHierarchy(cut, steps)).points, reconstruct(part).points);
        if (steps < 3) {
            EXPECT_THROW(loadHierarchy(cut), InputError);
        }
    }
    EXPECT_THROW(loadHierarchy(file, 4), InputError);
    EXPECT_THROW(reconstruct(whole, 4), InputError);
}

TEST(Hierarchy, WithNoLevelsIsTheMeshItself) {
    const Hierarchy hierarchy = decompose(tetrahedron(), scheme(), "refined", 0);
    EXPECT_EQ(reconstruct(hierarchy).points, tetrahedron().points);
}

// ---- the file ----

TEST(HierarchyFile, KeepsEverything) {
    const TempFolder folder;
    const fs::path file = folder.path() / "h.details";
    for (const auto& [name, mesh] : all()) {
        const Hierarchy hierarchy = decompose(detailed(mesh, 2, 0.01, 24), scheme(), "tensor", 2);
        saveHierarchy(file, hierarchy);
        const Hierarchy back = loadHierarchy(file);
        EXPECT_EQ(bytesOf(back), bytesOf(hierarchy)) << name;
        EXPECT_EQ(back.details, hierarchy.details) << name;
        EXPECT_EQ(back.order, hierarchy.order) << name;
        EXPECT_EQ(back.base.creases, hierarchy.base.creases) << name;
    }
}

std::string complaintOf(const fs::path& file) {
    return complaint([&] { loadHierarchy(file); });
}

TEST(HierarchyFile, RefusesEveryTruncation) {
    const TempFolder folder;
    const fs::path file = folder.path() / "h.details";
    const std::string bytes = bytesOf(decompose(detailed(tetrahedron(), 1, 0.1, 25), scheme(), "refined", 1));
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        std::ofstream(file, std::ios::binary).write(bytes.data(), std::streamsize(size));
        EXPECT_NE(complaintOf(file), "") << size;
    }
    std::ofstream(file, std::ios::binary) << bytes << "x";
    EXPECT_THAT(complaintOf(file), HasSubstr("1 bytes behind its end"));
}

TEST(HierarchyFile, RefusesEveryChangedByte) {
    const TempFolder folder;
    const fs::path file = folder.path() / "h.details";
    const std::string bytes = bytesOf(decompose(detailed(tetrahedron(), 1, 0.1, 26), scheme(), "refined", 1));
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        std::string changed = bytes;
        changed[at] = char(changed[at] ^ 0x10);
        std::ofstream(file, std::ios::binary) << changed;
        EXPECT_NE(complaintOf(file), "") << at;
    }
}

TEST(HierarchyFile, DoesNotStoreDroppedDetails) {
    const TempFolder folder;
    const fs::path file = folder.path() / "h.details";
    Hierarchy hierarchy = decompose(detailed(tetrahedron(), 4, 0.1, 27), scheme(), "refined", 4);
    const std::size_t whole = bytesOf(hierarchy).size(), all = detailCount(hierarchy);
    for (const std::size_t keep : {all - 1, all / 2, std::size_t{33}, std::size_t{0}}) {
        keepLongest(hierarchy, keep);
        hierarchy.details[1][2] = {0, -0.0, 0};  // to the bit: this is no dropped one
        saveHierarchy(file, hierarchy);
        const Hierarchy back = loadHierarchy(file);
        EXPECT_EQ(bytesOf(back), bytesOf(hierarchy)) << keep;
        EXPECT_EQ(back.details, hierarchy.details) << keep;
        EXPECT_TRUE(std::signbit(back.details[1][2].y));
        EXPECT_EQ(back.order, hierarchy.order) << keep;
        EXPECT_EQ(loadHierarchy(file, 2).details.size(), 2u);
        EXPECT_EQ(loadHierarchy(file, 2).details[1], hierarchy.details[1]);
    }
    // 24 bytes a detail less, but for a bit each and a longer header.
    EXPECT_LT(bytesOf(hierarchy).size() + 24 * all, whole + all / 8 + 1000);
}

TEST(HierarchyFile, WithoutDroppedDetailsRefusesEveryTruncationAndChangedByte) {
    const TempFolder folder;
    const fs::path file = folder.path() / "h.details";
    Hierarchy hierarchy = decompose(detailed(tetrahedron(), 2, 0.1, 28), scheme(), "refined", 2);
    keepLongest(hierarchy, 9);
    const std::string bytes = bytesOf(hierarchy);
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        std::ofstream(file, std::ios::binary).write(bytes.data(), std::streamsize(at));
        EXPECT_NE(complaintOf(file), "") << at;
        std::string changed = bytes;
        changed[at] = char(changed[at] ^ 0x10);
        std::ofstream(file, std::ios::binary) << changed;
        EXPECT_NE(complaintOf(file), "") << at;
    }
}

// ---- creases ----

TEST(Hierarchy, FindsCreasesByAngle) {
    // A cube whose edges are all sharp: 12 base edges fold by 90 degrees at every level.
    PolygonMesh fine = subdivided(
        creased(
            cube(),
            {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}),
        scheme(), 2);
    fine.creases.clear();
    const Hierarchy found = decompose(fine, scheme(), {"refined", 2, 60.0});
    EXPECT_EQ(found.base.creases.size(), 12u);
    EXPECT_LT(distance(found.base.points, cube().points), 1e-12);
    for (const auto& details : found.details) EXPECT_LT(largest(details), 1e-12);
    EXPECT_EQ(decompose(fine, scheme(), {"refined", 2, 120.0}).base.creases.size(), 0u);
    EXPECT_GT(largest(decompose(fine, scheme(), "refined", 2).details[0]), 0.01)
        << "as a smooth surface it needs details";
}

// ---- editing ----

Vec3 turned(const Vec3& p, double a, double b) {
    const Vec3 q{std::cos(a) * p.x - std::sin(a) * p.y, std::sin(a) * p.x + std::cos(a) * p.y, p.z};
    return {q.x, std::cos(b) * q.y - std::sin(b) * q.z, std::sin(b) * q.y + std::cos(b) * q.z};
}

TEST(HierarchyEdit, WithoutAnEditIsTheMesh) {
    for (const auto& [name, mesh] : all()) {
        const PolygonMesh fine = detailed(mesh, 2, 0.05, 27);
        const Hierarchy hierarchy = decompose(fine, scheme(), "refined", 2);
        for (const Frames frames : {Frames::global, Frames::local}) {
            const auto same = reconstructEdited(hierarchy, hierarchy.base.points, kAllLevels, frames);
            EXPECT_LT(distance(same.points, fine.points), 1e-12 * diagonal(fine.points)) << name;
        }
    }
}

TEST(HierarchyEdit, LocalFramesTurnWithTheBaseAndGlobalOnesDoNot) {
    for (const auto& [name, mesh] : injective()) {
        const PolygonMesh fine = detailed(mesh, 2, 0.05, 28);
        const Hierarchy hierarchy = decompose(fine, scheme(), "refined", 2);
        auto base = hierarchy.base.points;
        auto expected = fine.points;
        for (Vec3& p : base) p = turned(p, 0.7, 0.4) + Vec3{3, -2, 1};
        for (Vec3& p : expected) p = turned(p, 0.7, 0.4) + Vec3{3, -2, 1};
        const double size = diagonal(fine.points);
        EXPECT_LT(distance(reconstructEdited(hierarchy, base, kAllLevels, Frames::local).points, expected),
                  1e-12 * size)
            << name;  // seen 2e-15
        EXPECT_GT(distance(reconstructEdited(hierarchy, base, kAllLevels, Frames::global).points, expected),
                  1e-3 * size)
            << name;
        // A translation is both.
        base = hierarchy.base.points;
        expected = fine.points;
        for (auto* points : {&base, &expected})
            for (Vec3& p : *points) p += {3, -2, 1};
        for (const Frames frames : {Frames::global, Frames::local})
            EXPECT_LT(distance(reconstructEdited(hierarchy, base, kAllLevels, frames).points, expected),
                      1e-12 * size);
    }
}

// Where P is not injective too: no vertex pays for what the coarse points do not tell.
TEST(HierarchyEdit, OfAnExactSubdivisionIsTheSubdivisionOfTheEdit) {
    for (const auto& [name, mesh] : all()) {
        const Hierarchy hierarchy = decompose(subdivided(mesh, scheme(), 2), scheme(), "refined", 2);
        PolygonMesh moved = hierarchy.base;
        moved.points[0] += {0.5, 0.2, -0.3};
        const auto expected = subdivided(moved, scheme(), 2).points;
        for (const Frames frames : {Frames::global, Frames::local})
            EXPECT_LT(
                distance(reconstructEdited(hierarchy, moved.points, kAllLevels, frames).points, expected),
                1e-12)
                << name;
    }
}

TEST(HierarchyEdit, MovesOnlyWhatIsNear) {
    const PolygonMesh fine = detailed(grid(8, 8), 2, 0.05, 29);
    const Hierarchy hierarchy = decompose(fine, scheme(), "refined", 2);
    auto moved = hierarchy.base.points;
    const Vec3 at = moved[40];
    moved[40] += {0, 0, 2};
    for (const Frames frames : {Frames::global, Frames::local}) {
        const PolygonMesh edited = reconstructEdited(hierarchy, moved, kAllLevels, frames);
        double most = 0;
        for (std::size_t v = 0; v < fine.points.size(); ++v) {
            const double change = length(edited.points[v] - fine.points[v]);
            most = std::max(most, change);
            // Global: two rings of the base. Local: what turned details do to their neighbours runs on, and fades.
            if (std::max(std::abs(fine.points[v].x - at.x), std::abs(fine.points[v].y - at.y)) > 3.9) {
                EXPECT_LT(change, frames == Frames::global ? 1e-12 : 1e-5);  // seen 5e-7
            }
        }
        EXPECT_GT(most, 0.5);
    }
}

TEST(HierarchyEdit, RefusesAnotherConnectivity) {
    EXPECT_NO_THROW(requireSameConnectivity(cube(), cube()));
    EXPECT_THROW(requireSameConnectivity(cube(), octahedron()), InputError);
    try {
        requireSameConnectivity(prism(3), shuffled(prism(3), 30));
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("its face 0 has the vertices"));
    }
}

// ---- fewer details ----

TEST(HierarchyEdit, KeepsTheLongestAndLosesLessTheMoreItKeeps) {
    const PolygonMesh mesh = terrain(3);
    const Hierarchy hierarchy = decompose(mesh, scheme(), "refined", 3);
    double before = std::numeric_limits<double>::infinity();
    for (const std::size_t keep : {std::size_t(0), detailCount(hierarchy) / 50, detailCount(hierarchy) / 10,
                                   detailCount(hierarchy) / 2, detailCount(hierarchy)}) {
        Hierarchy part = hierarchy;
        keepLongest(part, keep);
        EXPECT_LE(nonzeroDetailCount(part), keep);
        const double error = pointError(reconstruct(part).points, mesh.points).rms;
        EXPECT_LT(error, before);
        before = error;
    }
    EXPECT_LT(before, kMeshRoundTrip * diagonal(mesh.points));
    Hierarchy part = hierarchy;
    threshold(part, 5);
    double shortest = std::numeric_limits<double>::infinity();
    for (const auto& details : part.details)
        for (const Vec3& d : details)
            if (length(d) > 0) shortest = std::min(shortest, length(d));
    EXPECT_GE(shortest, 5);
}

TEST(HierarchyReport, SaysWhatWasFound) {
    const PolygonMesh fine = detailed(grid(3, 3), 2, 0.05, 31);
    const auto report = reportDecomposition(decompose(fine, scheme(), "refined", 2), fine);
    ASSERT_EQ(report.levels.size(), 3u);
    EXPECT_EQ(report.levels[0].vertices, 16u);
    EXPECT_EQ(report.levels[2].vertices, fine.vertexCount());
    EXPECT_LT(report.levels[1].withoutDetails.rms, report.levels[0].withoutDetails.rms);
    EXPECT_LT(report.roundTrip, 1e-12);
}

// ---- rebuild: edits, and fewer details ----

TEST(HierarchyReport, MeasuresWhatDroppedDetailsCost) {
    const PolygonMesh fine = detailed(tetrahedron(), 3, 0.1, 29);
    Hierarchy hierarchy = decompose(fine, scheme(), "refined", 3);
    DecompositionReport report = reportDecomposition(hierarchy, fine);
    EXPECT_EQ(report.details, detailCount(hierarchy));
    EXPECT_EQ(report.kept, report.details);
    dropDetails(hierarchy, fine, std::nullopt, 20, report);
    EXPECT_EQ(report.kept, 20u);
    EXPECT_EQ(nonzeroDetailCount(hierarchy), 20u);
    EXPECT_EQ(report.dropped.largest, pointError(reconstruct(hierarchy).points, fine.points).largest);
    EXPECT_GT(report.dropped.rms, 0);
    dropDetails(hierarchy, fine, 1e9, std::nullopt, report);
    EXPECT_EQ(report.kept, 0u);
}

TEST(Rebuild, FollowsAnEditAndLeavesDetailsOut) {
    const PolygonMesh fine = detailed(torus(12, 8), 2, 0.02, 33);
    const Hierarchy hierarchy = decompose(fine, "catmull-clark", {.variant = "tensor", .levels = 2});
    EXPECT_EQ(rebuild(hierarchy).mesh.corners, fine.corners);
    EXPECT_LT(distance(rebuild(hierarchy).mesh.points, fine.points), 1e-12);

    RebuildOptions turn;
    auto expected = fine.points;
    for (const Vec3& p : hierarchy.base.points) turn.moved.push_back({-p.y, p.x, p.z});
    for (Vec3& p : expected) p = {-p.y, p.x, p.z};
    EXPECT_GT(distance(rebuild(hierarchy, turn).mesh.points, expected), 1e-4);
    turn.frames = Frames::local;
    EXPECT_LT(distance(rebuild(hierarchy, turn).mesh.points, expected), 1e-12);

    const RebuildReport part = rebuild(hierarchy, {.keep = 100, .shares = true}).report;
    EXPECT_EQ(part.kept, 100u);
    EXPECT_EQ(part.details, detailCount(hierarchy));
    EXPECT_GT(part.error.rms, 0);
    ASSERT_EQ(part.shares.size(), 7u);
    EXPECT_LT(part.shares[6].error.rms, part.shares[0].error.rms);
    EXPECT_GT(rebuild(hierarchy, {.threshold = 0.01}).report.error.rms, 0);
}

TEST(Rebuild, OfTrianglesComesBackToo) {
    for (const char* name : {"loop", "butterfly"}) {
        const PolygonMesh fine = subdivided(tetrahedron(), name, 3);
        const Hierarchy hierarchy = decompose(fine, name, {.levels = 2});
        EXPECT_LT(reportDecomposition(hierarchy, fine).levels[0].detailLargest, 1e-12) << name;
        EXPECT_LT(distance(rebuild(hierarchy).mesh.points, fine.points), 1e-12) << name;
    }
}

TEST(Rebuild, KnowsItsBaseThroughSinglePrecision) {
    const PolygonMesh base = torus(12, 8);
    PolygonMesh rounded = base;
    for (Vec3& p : rounded.points) p = {float(p.x), float(p.y), float(p.z)};
    EXPECT_FALSE(firstMovedVertex(base, rounded));
    rounded.points[7].z += 0.01;
    const auto moved = firstMovedVertex(base, rounded);
    ASSERT_TRUE(moved);
    EXPECT_EQ(moved->vertex, 7u);
    EXPECT_NEAR(moved->distance, 0.01, 1e-6);
}

TEST(Hierarchy, FindsACageAgain) {
    for (const char* name : {"catmark_rook.obj", "catmark_torus.obj"}) {
        const PolygonMesh cage = readPolygonMesh(kData / "subdiv" / name);
        const PolygonMesh fine = subdivided(cage, "catmull-clark", 2);
        EXPECT_LT(distance(decompose(fine, "catmull-clark", {.levels = 2}).base.points, cage.points), 1e-12)
            << name;
    }
}

TEST(MeshSchemes, AreNamedWithTheirVariants) {
    EXPECT_THAT(meshSchemeNames(), testing::ElementsAre("catmull-clark", "loop", "butterfly"));
    EXPECT_EQ(meshVariantNames("loop").front(), "refined");
    EXPECT_THROW(meshVariantNames("doo-sabin"), InputError);
}

TEST(Hierarchy, RefusesWhatIsNoManifold) {
    PolygonMesh mesh = subdivided(cube(), scheme(), 1);
    mesh.addFace({0, 1, 2, 3});
    EXPECT_THROW(decompose(mesh, scheme(), "refined", 1), InputError);
    EXPECT_THROW(meshScheme("doo-sabin"), InputError);
    EXPECT_THROW(decompose(subdivided(cube(), scheme(), 1), scheme(), "best", 1), InputError);
}

}  // namespace
}  // namespace isowave::subdivision
