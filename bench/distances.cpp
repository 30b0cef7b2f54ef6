// distances: what signed distances cost beside the fit that they feed and beside OpenVDB's, as markdown tables.
//
//     build/release/bin/distances [--threads N] INPUT...
//     build/release/bin/distances --errors
//     INPUT     an image and its iso value (scan.nrrd@100), or a mesh and how many voxels its longest axis has (part.stl:512)
//
// Images: CPU seconds of distanceFromImage(), nodes and reading included, of openvdb::tools::fogToSdf() on the same band, and
// of fitDistance(). Meshes: of distanceFromMesh(), signs and surface buried in the solid included, and of
// openvdb::tools::meshToVolume(). Each is the least of three runs, in turn. --errors: how far distances of images of known
// solids are from the truth, in voxels, rms and most where the truth is below 4.
#include <fmt/format.h>
#include <openvdb/tools/FastSweeping.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include "base/heap.h"
#include "io/image/stream.h"
#include "isowave/error.h"
#include "isowave/image.h"
#include "isowave/mesh.h"
#include "volume/distance.h"
#include "volume/fit.h"
#include "volume/mesh_repair.h"

namespace {

using namespace isowave;
using openvdb::FloatGrid;

double cpuSeconds(const std::function<void()>& work) {
    const std::clock_t begin = std::clock();
    work();
    return double(std::clock() - begin) / CLOCKS_PER_SEC;
}

// Least seconds of each, all of them in turn three times.
std::vector<double> inTurn(const std::vector<std::function<void()>>& works) {
    std::vector<double> least(works.size(), 1e9);
    for (int round = 0; round < 3; ++round)
        for (std::size_t i = 0; i < works.size(); ++i) least[i] = std::min(least[i], cpuSeconds(works[i]));
    return least;
}

// value - iso where the distance is known, as fogToSdf() takes it.
FloatGrid::Ptr fogOf(const Image& image, double iso, const FloatGrid& band) {
    auto fog = FloatGrid::create(-1.0f);
    fog->setTree(std::make_shared<openvdb::FloatTree>(band.constTree(), -1.0f, openvdb::TopologyCopy()));
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(fog->tree());
    leaves.foreach ([&](openvdb::FloatTree::LeafNodeType& leaf, std::size_t) {
        for (openvdb::Index i = 0; i < leaf.SIZE; ++i) {
            const openvdb::Coord c = leaf.offsetToGlobalCoord(i);
            std::int64_t at[3];
            for (std::size_t a = 0; a < 3; ++a)
                at[a] = std::clamp<std::int64_t>(c[int(a)], 0, image.size[a] - 1);
            const auto n = static_cast<std::size_t>((at[2] * image.size[1] + at[1]) * image.size[0] + at[0]);
            leaf.setValueOnly(i, image.values[n] - static_cast<float>(iso));
        }
    });
    return fog;
}

void imageRow(const std::string& path, double iso) {
    FloatGrid::Ptr distance;
    const auto run = [&] {
        ImageStream stream(path);
        distance = distanceFromImage(stream, {.iso = iso}, 4);
    };
    const auto [ours, fit] = [&] {
        const auto least = inTurn({run, [&] { fitDistance(*distance); }});
        return std::pair(least[0], least[1]);
    }();
    const FloatGrid::Ptr fog = fogOf(readImage(path), iso, *distance);
    const double swept = cpuSeconds([&] { openvdb::tools::fogToSdf(*fog, 0.0f); });
    fmt::print("| {}@{} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.3f} |\n", path, iso,
               distance->activeVoxelCount(), ours, fit, swept, ours / fit, ours / swept);
}

void meshRow(const std::string& path, double voxels) {
    const TriangleMesh mesh = repairMesh(readMesh(path), path);
    const auto transform = transformForMesh(mesh, voxelForCount(mesh, voxels));
    std::vector<openvdb::Vec3s> points;
    for (const Point& p : mesh.points) points.emplace_back(transform->worldToIndex(openvdb::Vec3d(p.data())));
    std::vector<openvdb::Vec3I> triangles;
    for (const Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    const std::vector<openvdb::Vec4I> quads;
    FloatGrid::Ptr distance;
    const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(points,
                                                                                             triangles);
    const auto least = inTurn({[&] { distance = distanceFromMesh(mesh, *transform, 4); },
                               [&] {
                                   openvdb::tools::meshToVolume<FloatGrid>(
                                       adapter, *openvdb::math::Transform::createLinearTransform(1.0), 4, 4);
                               }});
    fmt::print("| {}:{} | {} | {} | {:.2f} | {:.2f} | {:.3f} |\n", path, voxels, mesh.triangles.size(),
               distance->activeVoxelCount(), least[0], least[1], least[0] / least[1]);
}

// ---- errors

using openvdb::Vec3d;
using Truth = std::function<double(const Vec3d&)>;  // negative inside, about the origin

Truth turned(const Truth& solid) {
    constexpr double c = 0.8, s = 0.6;  // about z, then about x
    return [=](const Vec3d& p) {
        const double y = s * p[0] + c * p[1];
        return solid({c * p[0] - s * p[1], c * y - s * p[2], s * y + c * p[2]});
    };
}
Truth sphere(double radius, const Vec3d& centre = Vec3d(0)) {
    return [=](const Vec3d& p) { return (p - centre).length() - radius; };
}
Truth torus(double large, double small) {
    return [=](const Vec3d& p) { return std::hypot(std::hypot(p[0], p[1]) - large, p[2]) - small; };
}
Truth box(const Vec3d& half) {
    return [=](const Vec3d& p) {
        Vec3d out;
        double inner = -1e9;
        for (int a = 0; a < 3; ++a) {
            const double d = std::abs(p[a]) - half[a];
            out[a] = std::max(d, 0.0);
            inner = std::max(inner, d);
        }
        return inner < 0 ? inner : out.length();
    };
}
Truth nearerOf(const Truth& a, const Truth& b) {
    return [=](const Vec3d& p) { return std::min(a(p), b(p)); };
}

// 80^3 voxels whose grey, 0 .. 255, falls over `ramp` voxels on either side of the surface, rounded to 8 bits; iso 127.5.
Image greyOf(const Truth& solid, double ramp) {
    constexpr int kSize = 80;
    Image image;
    image.size = {kSize, kSize, kSize};
    for (int z = 0; z < kSize; ++z)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                const double d = solid(Vec3d(x, y, z) - Vec3d(39.7, 39.4, 39.9));
                image.values.push_back(
                    static_cast<float>(std::round(127.5 - 127.5 * std::clamp(d / ramp, -1.0, 1.0))));
            }
    return image;
}

struct Error {
    double sum = 0, most = 0;
    std::int64_t count = 0;
    void add(double error) {
        sum += error * error;
        most = std::max(most, std::abs(error));
        ++count;
    }
    double rms() const { return std::sqrt(sum / double(count)); }
};

void errorRow(const std::string& name, const Truth& solid, double ramp) {
    const Image image = greyOf(solid, ramp);
    const FloatGrid::Ptr distance = distanceFromImage(image, {.iso = 127.5}, 4);
    const FloatGrid::Ptr swept = openvdb::tools::fogToSdf(*fogOf(image, 127.5, *distance), 0.0f);
    Error ours, beside, theirs;
    for (auto value = distance->cbeginValueOn(); value; ++value) {
        const double truth = solid(value.getCoord().asVec3d() - Vec3d(39.7, 39.4, 39.9));
        if (std::abs(truth) >= 4) continue;
        ours.add(*value - truth);
        if (std::abs(truth) < 1) beside.add(*value - truth);
        theirs.add(std::clamp<double>(swept->tree().getValue(value.getCoord()), -4, 4) - truth);
    }
    fmt::print("| {} | {} | {:.3f} {:.2f} | {:.3f} {:.2f} | {:.3f} {:.2f} |\n", name, ramp, theirs.rms(),
               theirs.most, ours.rms(), ours.most, beside.rms(), beside.most);
}

void errors() {
    fmt::print("| solid | ramp | fogToSdf | distances | nearer than 1 |\n|---|---|---|---|---|\n");
    const Truth plate = turned(box({24, 20, 1.5})), thin = turned(box({24, 20, 0.75}));
    for (const double ramp : {3.0, 1.0, 0.5, 0.1}) {
        errorRow("sphere of radius 20", sphere(20), ramp);
        errorRow("torus 22, 7, turned", turned(torus(22, 7)), ramp);
        errorRow("two spheres 1.5 apart", nearerOf(sphere(15, {-15.75, 0, 0}), sphere(15, {15.75, 0, 0})),
                 ramp);
        errorRow("plate 3 thick, turned", plate, ramp);
        errorRow("plate 1.5 thick, turned", thin, ramp);
        errorRow("box, turned", turned(box({18, 14, 11})), ramp);
        errorRow("box", box({18, 14, 11}), ramp);
    }
}

}  // namespace

int main(int argc, char** argv) try {
    std::vector<std::string> inputs(argv + 1, argv + argc);
    std::size_t threads = 1;
    if (inputs.size() > 1 && inputs[0] == "--threads") {
        threads = std::stoul(inputs[1]);
        inputs.erase(inputs.begin(), inputs.begin() + 2);
    }
    if (inputs == std::vector<std::string>{"--errors"}) {
        errors();
        return 0;
    }
    if (inputs.empty()) {
        std::cerr << "usage: distances [--threads N] IMAGE@ISO|MESH:VOXELS...\n";
        return 2;
    }
    setUpHeap();
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    std::string head;
    for (const std::string& input : inputs) {
        const std::size_t at = input.find_last_of("@:");
        const bool isImage = input.at(at) == '@';
        const std::string wanted =
            isImage ? "| image | points | distances | fit | fogToSdf | distances/fit | /fogToSdf |\n"
                      "|---|---|---|---|---|---|---|\n"
                    : "| mesh | triangles | points | distances | meshToVolume | ratio |\n"
                      "|---|---|---|---|---|---|\n";
        if (wanted != head) fmt::print("{}", head = wanted);
        const double number = std::stod(input.substr(at + 1));
        (isImage ? imageRow : meshRow)(input.substr(0, at), number);
    }
} catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
}
