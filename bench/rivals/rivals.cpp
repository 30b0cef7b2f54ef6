// rivals [part|MESH] [VOXELS] [FOLDER]: the tables of docs/rivals.md. The transform beside octree pruning, mean pooling, cut
// filters and other accessory rules, on the benchmarks' perforated part or on a closed mesh, sampled with VOXELS (128)
// along its longest axis. FOLDER: where the meshes of the levels go, as PLY.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>

#include "accessory.h"
#include "chui.h"
#include "coarser.h"
#include "io/mesh/read.h"
#include "io/mesh/write.h"
#include "isowave/error.h"
#include "part.h"
#include "polygonize/polygonize.h"
#include "polygonize/topology.h"
#include "simplify/distance.h"
#include "volume/distance.h"
#include "volume/fit.h"
#include "volume/mesh_repair.h"
#include "wavelets/bounds.h"
#include "wavelets/pyramid.h"

namespace {

using namespace isowave;
using namespace isowave::bench;

constexpr int kLevels = 3;
constexpr double kHalfWidth = 4;  // of the fits, in voxels of their own lattice

// Signed distances at level 0 so far from the surface that those of the coarsest level can be averages of them.
openvdb::FloatGrid::Ptr wideDistance(const std::string& solid, int voxels) {
    const double halfWidth = (kHalfWidth + 1) * (1 << kLevels);
    if (solid == "part") {
        const int around = static_cast<int>(halfWidth);
        return distanceFromFunction(PerforatedPart(voxels),
                                    {openvdb::Coord(-around), openvdb::Coord(voxels + around)}, halfWidth);
    }
    const TriangleMesh mesh = repairMesh(readMesh(solid), solid);
    return distanceFromMesh(mesh, *transformForMesh(mesh, voxelForCount(mesh, voxels)), halfWidth);
}

NodeCollection nodesOf(const openvdb::FloatGrid& distance) {
    openvdb::CoordBBox box;
    distance.tree().evalLeafBoundingBox(box);
    NodeCollection nodes =
        nodesFromFunction([&](const openvdb::Coord& c) { return distance.tree().getValue(c) < 0; }, box);
    nodes.grid->setTransform(distance.transform().copy());
    return nodes;
}

// ---- levels ---------------------------------------------------------------------------------------------

// Judges levels against the mesh of level 0 and prints a row each.
class Levels {
  public:
    Levels(const BSplineField& finest, std::optional<std::filesystem::path> folder)
        : reference_(polygonize(finest)),
          voxel_(finest.transform().voxelSize()[0]),
          volume_(topologyOf(reference_).volume),
          folder_(std::move(folder)) {
        std::cout
            << "| level | | control points | parts | genus | cavities | rms, voxels of level 0 | volume |\n"
               "|---|---|---|---|---|---|---|---|\n";
        row(0, "level 0", finest, reference_);
    }
    void add(int level, const std::string& name, const BSplineField& field) {
        row(level, name, field, polygonize(field));
    }

  private:
    void row(int level, const std::string& name, const BSplineField& field, const TriangleMesh& mesh) const {
        const MeshTopology t = topologyOf(mesh);
        const double rms = level == 0 ? 0 : compareMeshes(mesh, reference_).rms / voxel_;
        std::cout << fmt::format("| {} | {} | {} | {} | {} | {} | {:.3f} | {:+.2f} % |\n", level, name,
                                 field.controlPointCount(), t.parts, t.genus, t.cavities, rms,
                                 100 * (t.volume / volume_ - 1))
                  << std::flush;
        if (folder_) {
            std::string file;  // words with hyphens between them
            for (const char c : name)
                if (std::isalnum(static_cast<unsigned char>(c)))
                    file += c;
                else if (!file.empty() && file.back() != '-')
                    file += '-';
            writeMesh(*folder_ / fmt::format("{}-L{}.ply", file, level), mesh, MeshFormat::ply);
        }
    }

    TriangleMesh reference_;
    double voxel_, volume_;
    std::optional<std::filesystem::path> folder_;
};

void addLevels(Levels& levels, const std::string& name, const BSplineField& finest) {
    wavelets::analyse(finest, {.maxSteps = 3 * kLevels}, {}, [&](int step, const BSplineField& field) {
        if (step > 0 && step % 3 == 0) levels.add(step / 3, name, field);
    });
}

// ---- accessory rules ------------------------------------------------------------------------------------

struct Sizes {
    double largest = 0, rms = 0, small = 0;  // in K; small: share below 0.01 K
};

Sizes sizesOf(const openvdb::FloatGrid& grid, double K) {
    Sizes sizes;
    std::int64_t count = 0, small = 0;
    for (auto value = grid.cbeginValueOn(); value; ++value, ++count) {
        const double v = std::abs(*value) / K;
        sizes.largest = std::max(sizes.largest, v);
        sizes.rms += v * v;
        small += v < 0.01;
    }
    sizes.rms = std::sqrt(sizes.rms / double(count));
    sizes.small = double(small) / double(count);
    return sizes;
}

void printAccessoryRules(BSplineField finest, Levels& levels) {
    std::vector<std::string> rows;
    for (const AccessoryRule rule : {AccessoryRule::sign, AccessoryRule::end, AccessoryRule::average}) {
        BSplineField field = finest;
        for (int step = 0; step < 3 * kLevels; ++step) {
            wavelets::DirectionResult result = analyseWith(rule, field, step % 3);
            field = std::move(result.coarse);
            if (step % 3 != 2) continue;
            const Sizes details = sizesOf(*result.details, field.K),
                        points = sizesOf(*field.controlPoints, field.K);
            rows.push_back(fmt::format("| {} | {} | {:.4f} | {:.2f} | {:.1f} % | {:.2f} |\n", step / 3 + 1,
                                       nameOf(rule), details.rms, details.largest, 100 * details.small,
                                       points.largest));
            levels.add(step / 3 + 1, "accessory: " + nameOf(rule), field);
        }
    }
    std::cout << "\n| level | accessory points | details of its last step: rms, K | largest, K | below 0.01 "
                 "K | largest "
                 "control point, K |\n|---|---|---|---|---|---|\n";
    for (const std::string& row : rows) std::cout << row;
    std::cout << "\n| accessory points | n = 1: condition | norm | n = 2 | | n = 4 | | n = 12 | |\n"
                 "|---|---|---|---|---|---|---|---|---|\n";
    for (const AccessoryRule rule : {AccessoryRule::sign, AccessoryRule::end, AccessoryRule::average}) {
        std::cout << "| " << nameOf(rule) << " |";
        for (const int n : {1, 2, 4, 12}) {
            const Recovery r = recoveryOf(rule, n);
            std::cout << fmt::format(" {:.3g} | {:.3g} |", r.condition, r.norm);
        }
        std::cout << '\n';
    }
}

// ---- dropped details ------------------------------------------------------------------------------------

RoundTripError differenceOf(const BSplineField& field, const BSplineField& other) {
    const auto values = other.controlPoints->getConstAccessor();
    RoundTripError error;
    for (auto c = field.controlPoints->cbeginValueOn(); c; ++c) {
        const double e = std::abs(double(*c) - values.getValue(c.getCoord())) / field.K;
        error.max = std::max(error.max, e);
        error.rms += e * e;
    }
    error.rms = std::sqrt(error.rms / double(field.controlPointCount()));
    return error;
}

// Not a rival: what leaving small details out does, beside what bounds.h says that it can do.
void printDroppedDetails(const BSplineField& field) {
    const wavelets::Pyramid whole = wavelets::analyse(field);
    std::cout << "\n| details below, K | dropped | largest change, K | rms, K | bound, K "
                 "|\n|---|---|---|---|---|\n";
    for (const double below : {1e-4, 1e-3, 3e-3, 1e-2, 3e-2}) {
        wavelets::Pyramid pyramid = whole;
        const auto dropped =
            wavelets::dropDetails(pyramid, std::vector<double>(pyramid.steps.size(), below * field.K));
        const RoundTripError seen = differenceOf(field, pyramid.field(0));
        std::cout << fmt::format("| {} | {:.1f} % | {:.5f} | {:.6f} | {:.5f} |\n", below,
                                 100 * double(dropped.dropped) / double(dropped.details), seen.max, seen.rms,
                                 dropped.bound[0] / field.K)
                  << std::flush;
    }
}

// ---- cut filters ----------------------------------------------------------------------------------------

void printCutFilters(const BSplineField& field) {
    std::cout << "\n| analysis filters | 1 step: largest error, K | rms, K | 3 steps | | 9 steps | |\n"
                 "|---|---|---|---|---|---|---|\n";
    const auto row = [](const std::string& name, const auto& errorOf) {
        std::cout << "| " << name << " |";
        for (const int steps : {1, 3, 9}) {
            const RoundTripError e = errorOf(steps);
            std::cout << fmt::format(" {:.1e} | {:.1e} |", e.max, e.rms);
        }
        std::cout << std::endl;
    };
    for (const int reach : {5, 10, 15, 25})
        row(fmt::format("{} taps", 2 * reach + 1),
            [&](int steps) { return cutRoundTrip(field, steps, cutFilters(reach)); });
    row("intervals, float32", [&](int steps) {
        return differenceOf(field, wavelets::analyse(field, {.maxSteps = steps}).field(0));
    });
}

int run(const std::string& solid, int voxels, const std::optional<std::filesystem::path>& folder) {
    if (folder) std::filesystem::create_directories(*folder);
    const openvdb::FloatGrid::Ptr wide = wideDistance(solid, voxels);
    const BSplineField finest = fitDistance(*distanceFromLevelSet(*wide, 0, kHalfWidth));
    const NodeCollection nodes = nodesOf(*wide);
    Levels levels(finest, folder);
    addLevels(levels, "wavelets, distance fit", finest);
    addLevels(levels, "wavelets, binary fit", fitBinary(nodes));
    for (int level = 1; level <= kLevels; ++level) {
        levels.add(level, "pruned octree", fitBinary(prunedCollection(nodes, level)));
        levels.add(level, "mean pooling", fitDistance(*pooledDistance(*wide, level, kHalfWidth)));
    }
    printAccessoryRules(finest, levels);
    printCutFilters(finest);
    printDroppedDetails(finest);
    return 0;
}

}  // namespace

int main(int argc, char** argv) try {
    initializeVdb();
    const std::string solid = argc > 1 ? argv[1] : "part";
    return run(solid, argc > 2 ? std::atoi(argv[2]) : 128,
               argc > 3 ? std::optional<std::filesystem::path>(argv[3]) : std::nullopt);
} catch (const std::exception& error) {
    std::cerr << "rivals: " << error.what() << '\n';
    return 1;
}
