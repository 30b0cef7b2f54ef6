// What the parts of the main job cost, each beside a memcpy of the same control points in the same run (the counter
// "memcpys"): a machine that is busy slows both.
//
//     cmake --preset release -DISOWAVE_BENCH=ON && cmake --build --preset release --target transform_bench
//     build/release/bin/transform_bench [--benchmark_filter=Analyse]
//
// The solid is a ball of 220 voxels perforated by a gyroid, turned so that nothing lies along the lattice.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <cstring>

#include "polygonize/polygonize.h"
#include "polygonize/topology.h"
#include "volume/distance.h"
#include "volume/fit.h"
#include "wavelets/interval.h"
#include "wavelets/pyramid.h"

namespace {

using namespace isowave;
using openvdb::Vec3d;

double perforatedBall(const Vec3d& point) {
    const Vec3d p = point - Vec3d(128.3, 127.7, 128.1);
    const double c = 0.8, s = 0.6;  // a rotation about z, then one about x
    const Vec3d q(c * p[0] - s * p[1], c * (s * p[0] + c * p[1]) - s * p[2],
                  s * (s * p[0] + c * p[1]) + c * p[2]);
    const double k = 2 * M_PI / 40;
    const double gyroid = std::sin(k * q[0]) * std::cos(k * q[1]) + std::sin(k * q[1]) * std::cos(k * q[2]) +
                          std::sin(k * q[2]) * std::cos(k * q[0]);
    return std::max(p.length() - 110, gyroid / (1.5 * k));
}

const openvdb::FloatGrid& distance() {
    static const auto grid =
        distanceFromFunction(perforatedBall, openvdb::CoordBBox(0, 0, 0, 255, 255, 255), 4);
    return *grid;
}
const BSplineField& field() {
    static const BSplineField result = fitDistance(distance());
    return result;
}
const wavelets::Pyramid& pyramid() {
    static const wavelets::Pyramid result = wavelets::analyse(field());
    return result;
}

// Seconds of one memcpy of as many float32 as the field has control points.
double memcpySeconds() {
    static const double seconds = [] {
        const auto count = static_cast<std::size_t>(field().controlPointCount());
        std::vector<float> from(count, 1.0f), to(count);
        double best = 1e9;
        for (int i = 0; i < 20; ++i) {
            const auto begin = std::chrono::steady_clock::now();
            std::memcpy(to.data(), from.data(), 4 * count);
            benchmark::DoNotOptimize(to.data());
            benchmark::ClobberMemory();
            best = std::min(best,
                            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        }
        return best;
    }();
    return seconds;
}

// Runs `work` and reports nanoseconds a control point and multiples of the memcpy.
template <class Work>
void measure(benchmark::State& state, const Work& work) {
    memcpySeconds();
    const auto begin = std::chrono::steady_clock::now();
    for (auto _ : state) work();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() /
                           static_cast<double>(state.iterations());
    state.counters["ns_per_point"] = 1e9 * seconds / static_cast<double>(field().controlPointCount());
    state.counters["memcpys"] = seconds / memcpySeconds();
}

void Interval(benchmark::State& state) {
    const auto n = static_cast<std::size_t>(state.range(0));
    std::vector<double> fine(2 * n + 3, 0.3), coarse(n + 3), detail(n);
    wavelets::IntervalTransform transform;
    for (auto _ : state) {
        transform.analyse(fine, -1, 1, coarse, detail);
        transform.synthesise(coarse, detail, -1, 1, fine);
        benchmark::DoNotOptimize(fine.data());
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(fine.size()));
}
BENCHMARK(Interval)->Arg(1)->Arg(2)->Arg(4)->Arg(8)->Arg(16)->Arg(17)->Arg(32)->Arg(128)->Arg(1024);

void AnalyseDirection(benchmark::State& state) {
    measure(state, [&] { wavelets::analyseDirection(field(), static_cast<int>(state.range(0))); });
}
BENCHMARK(AnalyseDirection)->DenseRange(0, 2)->Unit(benchmark::kMillisecond)->UseRealTime();

void SynthesiseDirection(benchmark::State& state) {
    const int axis = static_cast<int>(state.range(0));
    const auto step = wavelets::analyseDirection(field(), axis);
    measure(state, [&] { wavelets::synthesiseDirection(step.coarse, *step.details, *field().shape, axis); });
}
BENCHMARK(SynthesiseDirection)->DenseRange(0, 2)->Unit(benchmark::kMillisecond)->UseRealTime();

void AnalyseToOneNode(benchmark::State& state) {
    measure(state, [] { wavelets::analyse(field()); });
    state.counters["points"] = static_cast<double>(field().controlPointCount());
}
BENCHMARK(AnalyseToOneNode)->Unit(benchmark::kMillisecond)->UseRealTime();

void SynthesiseFromOneNode(benchmark::State& state) {
    measure(state, [] { pyramid().field(0); });
}
BENCHMARK(SynthesiseFromOneNode)->Unit(benchmark::kMillisecond)->UseRealTime();

void FitDistance(benchmark::State& state) {
    measure(state, [] { fitDistance(distance()); });
}
BENCHMARK(FitDistance)->Unit(benchmark::kMillisecond)->UseRealTime();

void Polygonize(benchmark::State& state) {
    measure(state, [] { polygonize(field()); });
}
BENCHMARK(Polygonize)->Unit(benchmark::kMillisecond)->UseRealTime();

void Topology(benchmark::State& state) {
    const TriangleMesh mesh = polygonize(field());
    measure(state, [&] { topologyOf(mesh); });
    state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
}
BENCHMARK(Topology)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
