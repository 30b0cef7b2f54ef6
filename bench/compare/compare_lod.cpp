// The whole job beside what users have today: a distance field of a perforated, rotated part -> levels 0 to 4, each with
// a mesh.
//     isowave   fitDistance -> analyse, polygonize at every third step
//     OpenVDB   MultiResGrid (restriction of the level set) -> volumeToMesh of each level
//     VTK       FlyingEdges of the dense grid -> quadric decimation to isowave's numbers of triangles
// All start from one narrow band in memory, run in turn, several times, and the fastest run of each counts.
//
//     cmake --preset release -DISOWAVE_BENCH=ON && cmake --build --preset release --target compare_lod
//     build/release/bin/compare_lod [VOXELS [ROUNDS [THREADS [RESULTS.md]]]]     512 3 2; 0 rounds of VTK: VOXELS+
#include <fmt/format.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/MultiResGrid.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/global_control.h>
#include <tbb/version.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <thread>

#include "base/heap.h"
#include "part.h"
#include "polygonize/polygonize.h"
#include "volume/fit.h"
#include "wavelets/pyramid.h"
#ifdef ISOWAVE_VTK_VERSION
#include "vtk_rival.h"
#endif

namespace {

using namespace isowave;
constexpr int kLevels = 5, kStepsPerLevel = 3;

struct Job {
    double seconds = 0;  // wall
    double cpu = 0;      // of all threads
    std::map<std::string, double> parts;
    std::vector<std::int64_t> triangles;  // of each level; OpenVDB's quads count as two
};

double wallNow() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
double cpuNow() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

// Adds the time of `work` to a part of the job.
template <class Work>
void part(Job& job, const char* name, const Work& work) {
    const double begin = wallNow();
    work();
    job.parts[name] += wallNow() - begin;
}

template <class Work>
Job timed(const Work& work) {
    Job job;
    const double begin = wallNow(), cpu = cpuNow();
    work(job);
    job.seconds = wallNow() - begin;
    job.cpu = cpuNow() - cpu;
    return job;
}

Job isowaveJob(const openvdb::FloatGrid& distance) {
    return timed([&](Job& job) {
        BSplineField field;
        part(job, "fit", [&] { field = fitDistance(distance); });
        double meshing = 0;
        const double begin = wallNow();
        wavelets::analyse(field, {.maxSteps = kStepsPerLevel * (kLevels - 1)}, {},
                          [&](int step, const BSplineField& f) {
                              if (step % kStepsPerLevel != 0) return;
                              const double start = wallNow();
                              const TriangleMesh mesh = polygonize(f);
                              job.triangles.push_back(static_cast<std::int64_t>(mesh.triangles.size()));
                              meshing += wallNow() - start;
                          });
        job.parts["levels"] = wallNow() - begin - meshing;
        job.parts["meshes"] = meshing;
    });
}

Job openvdbJob(const openvdb::FloatGrid& distance) {
    return timed([&](Job& job) {
        std::unique_ptr<openvdb::tools::MultiResGrid<openvdb::FloatTree>> levels;
        part(job, "levels", [&] {
            levels = std::make_unique<openvdb::tools::MultiResGrid<openvdb::FloatTree>>(kLevels, distance);
        });
        part(job, "meshes", [&] {
            for (int level = 0; level < kLevels; ++level) {
                std::vector<openvdb::Vec3s> points;
                std::vector<openvdb::Vec3I> triangles;
                std::vector<openvdb::Vec4I> quads;
                openvdb::tools::volumeToMesh(*levels->grid(level), points, triangles, quads, 0.0, 0.0);
                job.triangles.push_back(static_cast<std::int64_t>(triangles.size() + 2 * quads.size()));
            }
        });
    });
}

#ifdef ISOWAVE_VTK_VERSION
Job vtkJob(std::vector<float>& values, int size, const std::vector<std::int64_t>& triangles) {
    return timed([&](Job& job) {
        const auto result = bench::vtkLevels(values, size, {triangles.begin() + 1, triangles.end()});
        job.triangles = result.triangles;
        job.parts["levels"] = result.decimateSeconds;
        job.parts["meshes"] = result.contourSeconds;
    });
}

std::vector<float> dense(const openvdb::FloatGrid& distance, int size) {
    std::vector<float> values(std::size_t(size) * size * size);
    openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> array(
        openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(size - 1)), values.data());
    openvdb::tools::copyToDense(distance, array);
    return values;
}
#endif

std::string machine() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name")) return line.substr(line.find(": ") + 2);
    return "unknown processor";
}

std::string row(const std::string& name, const Job& job, const Job& own) {
    std::string parts, triangles;
    for (const auto& [what, seconds] : job.parts)
        parts += fmt::format("{}{} {:.2f}", parts.empty() ? "" : ", ", what, seconds);
    for (const std::int64_t count : job.triangles)
        triangles += fmt::format("{}{}", triangles.empty() ? "" : ", ", count);
    return fmt::format("| {} | {:.2f} | {:.2f} | {} | {} | {:.2f} |\n", name, job.seconds, job.cpu, parts,
                       triangles, own.seconds / job.seconds);
}

}  // namespace

int main(int argc, char** argv) {
    setUpHeap();
    const auto argument = [&](int i, int otherwise) { return argc > i ? std::atoi(argv[i]) : otherwise; };
    const int voxels = argument(1, 512), rounds = argument(2, 3), threads = argument(3, 2);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    const auto distance = bench::sparseDistance(bench::PerforatedPart(voxels), 4);

    std::map<std::string, Job> best;
    const auto keep = [&best](const std::string& name, const Job& job) {
        const auto [at, isNew] = best.try_emplace(name, job);
        if (!isNew && job.seconds < at->second.seconds) at->second = job;
    };
    for (int round = 0; round < rounds; ++round) {
        keep("isowave", isowaveJob(*distance));
        keep("OpenVDB", openvdbJob(*distance));
    }
#ifdef ISOWAVE_VTK_VERSION
    {
        std::vector<float> values = dense(*distance, voxels);
        keep("VTK", vtkJob(values, voxels, best["isowave"].triangles));
    }
#endif

    std::string text = fmt::format(
        "perforated, rotated part, {}^3, {} active voxels of the narrow band, {} threads\n\n"
        "| | seconds | CPU seconds | of these | triangles of levels 0 to 4 | isowave / this "
        "|\n|---|---|---|---|---|---|\n",
        voxels, distance->activeVoxelCount(), threads);
    for (const auto& [name, job] : best) text += row(name, job, best["isowave"]);
    text += fmt::format("\n{}, {} cores; OpenVDB {}, oneTBB {}.{}", machine(),
                        std::thread::hardware_concurrency(), openvdb::getLibraryVersionString(),
                        TBB_VERSION_MAJOR, TBB_VERSION_MINOR);
#ifdef ISOWAVE_VTK_VERSION
    text += ", VTK " ISOWAVE_VTK_VERSION;
#endif
    text += fmt::format(". `compare_lod {} {} {}`\n", voxels, rounds, threads);
    fmt::print("{}", text);
    if (argc > 4) std::ofstream(argv[4]) << "# The whole job beside others\n\n" << text;
}
