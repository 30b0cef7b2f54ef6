// The whole way from a solid to the meshes of all its steps: what every ladder promises.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "io/image/itk.h"
#include "io/mesh/read.h"
#include "isowave/image.h"
#include "polygonize/polygonize.h"
#include "polygonize/topology.h"
#include "simplify/distance.h"
#include "temp_folder.h"
#include "volume/distance.h"
#include "volume/fit.h"
#include "volume/mesh_repair.h"
#include "wavelets/pyramid.h"
#include "zoo/mesh_check.h"
#include "zoo/zoo.h"

namespace isowave {
namespace {

using openvdb::Vec3d;

struct Level {
    TriangleMesh mesh;
    MeshTopology topology;
};

// Every step's mesh, checked by both checkers on the way.
std::vector<Level> everyStep(const BSplineField& field, const std::string& name) {
    std::vector<Level> levels;
    wavelets::analyse(field, {}, {}, [&](int step, const BSplineField& f) {
        Level level{polygonize(f), {}};
        level.topology = topologyOf(level.mesh);
        EXPECT_EQ(zoo::whatIsWrongWith(level.mesh), "") << name << " step " << step;
        if (!level.mesh.triangles.empty()) {
            EXPECT_TRUE(level.topology.closed() && level.topology.manifold() && level.topology.oriented())
                << name << " step " << step;
            EXPECT_GT(level.topology.volume, 0) << name << " step " << step;
        }
        levels.push_back(std::move(level));
    });
    return levels;
}

double stored(const BSplineField& field) {
    return double(wavelets::analyse(field).coefficientsStored()) / double(field.controlPointCount());
}

BSplineField fieldOfMesh(const std::string& file, double voxels, double* voxel = nullptr) {
    const TriangleMesh mesh = repairMesh(readMesh(std::string(ISOWAVE_TEST_DATA "/meshes/") + file), file);
    const double size = voxelForCount(mesh, voxels);
    if (voxel) *voxel = size;
    return fitDistance(*distanceFromMesh(mesh, *transformForMesh(mesh, size), 4));
}

BSplineField fieldOfCt() {
    return fitDistance(
        *distanceFromImage(readImage(ISOWAVE_TEST_DATA "/ct/cranium_crop.nrrd"), {.iso = 300}, 4));
}

TEST(Ladder, TheSecondCheckerCanFail) {
    TriangleMesh mesh = polygonize(zoo::distanceField(zoo::smoothSolids()[0]));
    ASSERT_EQ(zoo::whatIsWrongWith(mesh), "");
    const Triangle taken = mesh.triangles.back();
    mesh.triangles.pop_back();
    EXPECT_EQ(zoo::whatIsWrongWith(mesh), "an edge with one triangle");
    mesh.triangles.push_back({taken[0], taken[2], taken[1]});
    EXPECT_EQ(zoo::whatIsWrongWith(mesh), "an edge with two triangles that run the same way along it");
    // Two spheres glued at a point.
    mesh.triangles.back() = taken;
    const auto points = static_cast<std::uint32_t>(mesh.points.size());
    TriangleMesh two = mesh;
    for (const Point& p : mesh.points) two.points.push_back({p[0] + 100, p[1], p[2]});
    for (const Triangle& t : mesh.triangles)
        two.triangles.push_back({t[0] + points, t[1] + points, t[2] + points});
    ASSERT_EQ(zoo::whatIsWrongWith(two), "");
    for (Triangle& t : two.triangles)
        for (auto& v : t)
            if (v == points) v = 0;
    EXPECT_EQ(zoo::whatIsWrongWith(two), "a vertex with two fans");
}

TEST(Ladder, EveryMeshOfEveryStepOfTheZooIsAClosedOrientedManifold) {
    int meshes = 0;
    for (const auto& [name, field] : zoo::allFields())
        for (const Level& level : everyStep(field, name)) meshes += !level.mesh.triangles.empty();
    EXPECT_GT(meshes, 150);
}

// Bone of a skull is 3 to 8 voxels thick here: its volume holds at level 1 and the shell breaks at level 3.
TEST(Ladder, OfARealCtIsClosedAtEveryStep) {
    const BSplineField field = fieldOfCt();
    const auto levels = everyStep(field, "CT");
    EXPECT_EQ(levels[0].topology.components, 1);
    const double volume = levels[0].topology.volume;
    EXPECT_NEAR(levels[3].topology.volume, volume, 0.015 * volume);  // seen 1.04 %
    EXPECT_NEAR(levels[6].topology.volume, volume, 0.015 * volume);  // seen 0.01 %
    EXPECT_GT(levels.size(), 12u);
    EXPECT_LT(stored(field), 1.25);  // seen 1.079
}

TEST(Ladder, OfARealPartKeepsItsShapeThenLosesItsHole) {
    for (const auto& [file, voxels] :
         {std::pair("pinion.off", 160.0), std::pair("gearwheel.bin.stl", 200.0)}) {
        double voxel = 0;
        const BSplineField field = fieldOfMesh(file, voxels, &voxel);
        const auto levels = everyStep(field, file);
        EXPECT_EQ(levels[0].topology.genus, 1) << file;
        EXPECT_EQ(levels[3].topology.genus, 1) << file;
        const double volume = levels[0].topology.volume;
        EXPECT_NEAR(levels[3].topology.volume, volume, 0.01 * volume) << file;  // seen 0.1 %
        EXPECT_NEAR(levels[6].topology.volume, volume, 0.03 * volume) << file;  // seen 0.9 %
        const auto distance = DistanceTarget(levels[0].mesh).distanceFrom(levels[3].mesh);
        EXPECT_LT(distance.rms, 0.15 * voxel) << file;  // seen 0.093
        // The last level that is left of a part is a blob.
        std::size_t last = levels.size() - 1;
        while (levels[last].mesh.triangles.empty()) --last;
        EXPECT_EQ(levels[last].topology.genus, 0) << file;
        EXPECT_LE(levels[last].topology.components, 2) << file;
        EXPECT_LT(stored(field), 1.25) << file;  // seen 1.087 to 1.14
    }
}

TEST(Ladder, SolidsOverEightVoxelsThickKeepTheirVolume) {
    for (const auto& solid : {zoo::smoothSolids()[0], zoo::smoothSolids()[1]}) {
        // The same shape at three times the size: 70 voxels, 28 for the torus' tube.
        const auto distance = [&](const Vec3d& p) { return 3 * solid.distance(p / 3); };
        const auto scaled = [](const openvdb::Coord& c) {
            return openvdb::Coord(3 * c[0], 3 * c[1], 3 * c[2]);
        };
        const openvdb::CoordBBox box(scaled(solid.box.min()), scaled(solid.box.max()));
        const auto levels = everyStep(fitDistance(*distanceFromFunction(distance, box, 4)), solid.name);
        const double volume = levels[0].topology.volume;
        EXPECT_NEAR(levels[3].topology.volume, volume, 0.01 * volume) << solid.name;  // seen 0.1 %
        EXPECT_NEAR(levels[6].topology.volume, volume, 0.03 * volume) << solid.name;  // seen 0.3 %
    }
}

TEST(Ladder, VerticesOfLevelZeroLieOnTheTrueSurface) {
    for (const auto& group : {zoo::smoothSolids(), zoo::cadSolids()})
        for (const auto& solid : group) {
            if (solid.name == "plate with holes")
                continue;  // sharp all over; its edges are rounded by design
            const TriangleMesh mesh = polygonize(zoo::distanceField(solid));
            double sum = 0;
            for (const Point& p : mesh.points) {
                const double d = solid.distance(Vec3d(p[0], p[1], p[2]));
                sum += d * d;
            }
            EXPECT_LT(std::sqrt(sum / double(mesh.points.size())), 0.03) << solid.name;  // seen 1e-4 .. 0.028
        }
}

// ---- world coordinates

TEST(Ladder, AnObliqueAnisotropicCroppedImageIsMeshedWhereItkPutsItsVoxels) {
    using Volume = itk::Image<short, 3>;
    auto volume = Volume::New();
    Volume::RegionType region;
    region.SetSize({{30, 26, 20}});
    volume->SetRegions(region);
    volume->SetSpacing(std::array<double, 3>{0.41, 0.41, 1.25}.data());
    volume->SetOrigin(std::array<double, 3>{-113.7, 84.2, 905.1}.data());
    // A rotation about (1, 2, 3) by 0.6 rad.
    Volume::DirectionType direction;
    const Vec3d axis = Vec3d(1, 2, 3) / std::sqrt(14.0);
    const double c = std::cos(0.6), s = std::sin(0.6);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            direction[i][j] = axis[i] * axis[j] * (1 - c) + (i == j ? c : 0) +
                              (i == j ? 0 : ((j - i + 3) % 3 == 1 ? -1 : 1) * s * axis[3 - i - j]);
    volume->SetDirection(direction);
    volume->Allocate();
    for (int z = 0; z < 20; ++z)
        for (int y = 0; y < 26; ++y)
            for (int x = 0; x < 30; ++x)
                volume->SetPixel({{x, y, z}},
                                 short(300 + 40 * (7 - std::hypot(x - 14.2, y - 12.8, z - 9.4))));
    const test::TempFolder folder;
    const auto path = folder / "oblique.nrrd";
    // The crop starts at voxel (3, 2, 1) of the volume; the mesh has to lie where the volume is.
    const auto crop = itk::ExtractImageFilter<Volume, Volume>::New();
    crop->SetInput(volume);
    crop->SetExtractionRegion({{{3, 2, 1}}, {{26, 23, 19}}});
    crop->SetDirectionCollapseToSubmatrix();
    crop->Update();
    test::writeItk(crop->GetOutput(), path);

    const BSplineField field = fitDistance(*distanceFromImage(readImage(path), {.iso = 300}, 4));
    const TriangleMesh mesh = polygonize(field);
    ASSERT_GT(mesh.points.size(), 500u);
    std::size_t onAnEdge = 0;
    for (const Point& p : mesh.points) {
        itk::Point<double, 3> world(p.data());
        itk::ContinuousIndex<double, 3> index;
        volume->TransformPhysicalPointToContinuousIndex(world, index);
        int whole = 0;
        for (int a = 0; a < 3; ++a) whole += std::abs(index[a] - std::round(index[a])) < 1e-4;
        onAnEdge += whole >= 2;
        EXPECT_NEAR(std::hypot(index[0] - 14.2, index[1] - 12.8, index[2] - 9.4), 7, 0.1);
        // And back: ITK's own transform of that index is the mesh's point.
        itk::Point<double, 3> again;
        volume->TransformContinuousIndexToPhysicalPoint(index, again);
        for (int a = 0; a < 3; ++a) EXPECT_NEAR(again[a], p[a], 1e-4 * 0.41);
    }
    // All vertices but the centres of a few cells lie on edges between ITK's voxels.
    EXPECT_GT(double(onAnEdge), 0.99 * double(mesh.points.size()));
    EXPECT_GT(topologyOf(mesh).volume, 0);
}

}  // namespace
}  // namespace isowave
