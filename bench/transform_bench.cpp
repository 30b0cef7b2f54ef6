// What the parts of the main job cost, each beside a memcpy of the same control points in the same run (the counter
// "memcpys"): a machine that is busy slows both.
//
//     cmake --preset release -DISOWAVE_BENCH=ON && cmake --build --preset release --target transform_bench
//     build/release/bin/transform_bench [--benchmark_filter=Analyse]
//     ISOWAVE_BENCH_VOXELS=256 ISOWAVE_BENCH_THREADS=1 build/release/bin/transform_bench
//
// The solid is bench/part.h's, 512 voxels across unless said otherwise.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>

#include <unistd.h>

#include "base/heap.h"
#include "part.h"
#include "polygonize/polygonize.h"
#include "polygonize/topology.h"
#include "volume/fit.h"
#include "volume/vdb_file.h"
#include "wavelets/interval/batch.h"
#include "wavelets/interval/interval.h"
#include "wavelets/pyramid.h"
#include "wavelets/pyramid_file.h"

namespace {

using namespace isowave;

int number(const char* variable, int otherwise) {
    const char* text = std::getenv(variable);
    return text ? std::atoi(text) : otherwise;
}

const openvdb::FloatGrid& distance() {
    static const auto grid =
        bench::sparseDistance(bench::PerforatedPart(number("ISOWAVE_BENCH_VOXELS", 512)), 4);
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

double seconds(const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Seconds of one memcpy of as many float32 as the field has control points, between buffers that were used before.
double memcpySeconds() {
    static const double best = [] {
        const auto count = static_cast<std::size_t>(field().controlPointCount());
        std::vector<float> from(count, 1.0f), to(count);
        double shortest = 1e9;
        for (int i = 0; i < 20; ++i)
            shortest = std::min(shortest, seconds([&] {
                                    std::memcpy(to.data(), from.data(), 4 * count);
                                    benchmark::DoNotOptimize(to.data());
                                    benchmark::ClobberMemory();
                                }));
        return shortest;
    }();
    return best;
}

// Runs `work`, which returns its result, and reports nanoseconds a control point, multiples of the memcpy, and, where
// it is about files, the control points' bytes a second. Letting go of the result is not timed.
template <class Work>
void measure(benchmark::State& state, const Work& work) {
    memcpySeconds();
    double total = 0;
    for (auto _ : state) {
        const auto begin = std::chrono::steady_clock::now();
        const auto result = work();
        const double one = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        benchmark::DoNotOptimize(&result);
        state.SetIterationTime(one);
        total += one;
    }
    const double mean = total / static_cast<double>(state.iterations());
    const auto points = static_cast<double>(field().controlPointCount());
    state.counters["points"] = points;
    state.counters["ns_per_point"] = 1e9 * mean / points;
    state.counters["memcpys"] = mean / memcpySeconds();
    state.counters["MB_per_s"] = 4e-6 * points / mean;
}
#define ISOWAVE_MEASURED(name) BENCHMARK(name)->Unit(benchmark::kMillisecond)->UseManualTime()

// The same bytes into memory that the process has not used before: what any result costs that is not written over
// an old one.
void MemcpyIntoFreshMemory(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(field().controlPointCount());
    const std::vector<float> from(count, 1.0f);
    measure(state, [&] {
        std::unique_ptr<float[]> to(new float[count]);
        std::memcpy(to.get(), from.data(), 4 * count);
        benchmark::ClobberMemory();
        return to;
    });
}
ISOWAVE_MEASURED(MemcpyIntoFreshMemory);

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

void IntervalBatch(benchmark::State& state) {
    using wavelets::kLanes;
    const auto n = static_cast<int>(state.range(0));
    const std::size_t size = std::size_t(2 * n + 5) + wavelets::kSlack;
    std::vector<std::vector<float>> fine(kLanes, std::vector<float>(size, 0.3f)), coarse(fine), detail(fine);
    wavelets::AnalysisBatch analysis{n, kLanes, {}, {}, {}};
    wavelets::SynthesisBatch synthesis{n, kLanes, {}, {}, {}, {}, {}};
    for (int lane = 0; lane < kLanes; ++lane) {
        analysis.fine[lane] = fine[lane].data();
        synthesis.coarse[lane] = analysis.coarse[lane] = coarse[lane].data();
        synthesis.detail[lane] = analysis.detail[lane] = detail[lane].data();
        synthesis.left[lane] = synthesis.right[lane] = 0.3f;
        synthesis.fine[lane] = fine[lane].data() + 1;
    }
    wavelets::BatchTransform transform;
    for (auto _ : state) {
        transform.analyse(analysis);
        transform.synthesise(synthesis);
        benchmark::DoNotOptimize(fine.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * (2 * n + 3) * kLanes);
}
BENCHMARK(IntervalBatch)
    ->Arg(1)
    ->Arg(2)
    ->Arg(4)
    ->Arg(8)
    ->Arg(12)
    ->Arg(13)
    ->Arg(17)
    ->Arg(32)
    ->Arg(128)
    ->Arg(1024);

void AnalyseDirection(benchmark::State& state) {
    measure(state, [&] { return wavelets::analyseDirection(field(), static_cast<int>(state.range(0))); });
}
ISOWAVE_MEASURED(AnalyseDirection)->DenseRange(0, 2);

void SynthesiseDirection(benchmark::State& state) {
    const int axis = static_cast<int>(state.range(0));
    const auto step = wavelets::analyseDirection(field(), axis);
    measure(state,
            [&] { return wavelets::synthesiseDirection(step.coarse, *step.details, *field().shape, axis); });
}
ISOWAVE_MEASURED(SynthesiseDirection)->DenseRange(0, 2);

void AnalyseToOneNode(benchmark::State& state) {
    measure(state, [] { return wavelets::analyse(field()); });
}
ISOWAVE_MEASURED(AnalyseToOneNode);

void SynthesiseFromOneNode(benchmark::State& state) {
    pyramid();  // made before the clock runs
    measure(state, [] { return pyramid().field(0); });
}
ISOWAVE_MEASURED(SynthesiseFromOneNode);

void FitDistance(benchmark::State& state) {
    measure(state, [] { return fitDistance(distance()); });
}
ISOWAVE_MEASURED(FitDistance);

void Polygonize(benchmark::State& state) {
    measure(state, [] { return polygonize(field()); });
}
ISOWAVE_MEASURED(Polygonize);

void Topology(benchmark::State& state) {
    const TriangleMesh mesh = polygonize(field());
    measure(state, [&] { return topologyOf(mesh); });
    state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
}
ISOWAVE_MEASURED(Topology);

const std::filesystem::path& scratchFile() {
    static const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("isowave_bench_" + std::to_string(::getpid()) + ".vdb");
    return path;
}

// Removes the scratch file: a file is written new, or replacing one of 137 MB is measured with it.
struct Scratch {
    Scratch() = default;
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    ~Scratch() { std::filesystem::remove(scratchFile()); }
};

// Both files' measurements begin once the process and the disk cache have had the memory that they need.
constexpr double kWarmUpSeconds = 2;

void WritePyramid(benchmark::State& state) {
    pyramid();
    std::uintmax_t bytes = 0;
    measure(state, [&] {
        auto scratch = std::make_unique<Scratch>();
        wavelets::writePyramid(scratchFile(), pyramid());
        bytes = std::filesystem::file_size(scratchFile());
        return scratch;
    });
    state.counters["file_bytes"] = static_cast<double>(bytes);
}
ISOWAVE_MEASURED(WritePyramid)->MinWarmUpTime(kWarmUpSeconds);

// From this step on: 0 is all of it.
void ReadPyramid(benchmark::State& state) {
    wavelets::writePyramid(scratchFile(), pyramid());
    const Scratch scratch;
    std::int64_t bytes = 0;
    measure(state,
            [&] { return wavelets::readPyramid(scratchFile(), static_cast<int>(state.range(0)), &bytes); });
    state.counters["bytes_read"] = static_cast<double>(bytes);
}
ISOWAVE_MEASURED(ReadPyramid)->Arg(0)->Arg(3)->Arg(6)->MinWarmUpTime(kWarmUpSeconds);

}  // namespace

int main(int argc, char** argv) {
    isowave::setUpHeap();
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(number("ISOWAVE_BENCH_THREADS", 2)));
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
