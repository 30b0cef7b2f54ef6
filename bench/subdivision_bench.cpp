// subdivision/: cost per point, and as a multiple of copying the same bytes with memcpy. Linear: the time per
// point does not grow with the number of points (but for the step where the points leave the caches, which
// memcpy takes too).
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstring>
#include <ctime>
#include <random>

#include "subdivision/curves/curve.h"
#include "subdivision/filters/masks.h"
#include "subdivision/lattice/surface.h"

namespace {

using namespace isowave::subdivision;

std::vector<double> noise(std::size_t count) {
    std::mt19937 generator(1);
    std::normal_distribution<double> normal;
    std::vector<double> values(count);
    for (double& value : values) value = normal(generator);
    return values;
}

// Processor time of this thread, so that other work on the machine does not count.
double now() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Seconds that memcpy takes for these bytes: the least of several runs, into memory that is already there.
double copySeconds(const std::vector<double>& values) {
    std::vector<double> to(values.size(), 0.0);
    double least = 1e9;
    const int runs = values.size() < 100000 ? 2000 : 10;
    for (int k = 0; k < runs; ++k) {
        const double start = now();
        std::memcpy(to.data(), values.data(), values.size() * sizeof(double));
        benchmark::DoNotOptimize(to.data());
        benchmark::ClobberMemory();
        least = std::min(least, now() - start);
    }
    return least;
}

void report(benchmark::State& state, std::size_t points, double copy, double seconds) {
    const double once = seconds / static_cast<double>(state.iterations());
    state.counters["ns_per_point"] = 1e9 * once / static_cast<double>(points);
    state.counters["times_memcpy"] = once / copy;
}

template <class Work>
void timed(benchmark::State& state, std::size_t points, double copy, const Work& work) {
    double seconds = 0;
    for (auto _ : state) {
        const double start = now();
        work();
        seconds += now() - start;
    }
    report(state, points, copy, seconds);
}

void decomposeCurve(benchmark::State& state, const char* scheme, bool closed) {
    const auto points = static_cast<std::size_t>(state.range(0));
    const CurveFilters filters(curveScheme(scheme), closed);
    const Polyline curve{2, closed, noise(2 * points)};
    timed(state, points, copySeconds(curve.coordinates),
          [&] { benchmark::DoNotOptimize(decompose(curve, filters, 6)); });
}

void reconstructCurve(benchmark::State& state, const char* scheme, bool closed) {
    const auto points = static_cast<std::size_t>(state.range(0));
    const CurveFilters filters(curveScheme(scheme), closed);
    const Polyline curve{2, closed, noise(2 * points)};
    const CurveLevels levels = decompose(curve, filters, 6);
    timed(state, points, copySeconds(curve.coordinates),
          [&] { benchmark::DoNotOptimize(reconstruct(levels, filters)); });
}

// One side of the patch has this many edges; the filters are met before the clock starts.
void surface(benchmark::State& state, const char* scheme, bool back) {
    const int side = static_cast<int>(state.range(0));
    const Patch patch = Patch::parallelogram(side, side);
    SurfaceFilters filters(surfaceScheme(scheme));
    const SurfaceField field{patch, 1, noise(patch.size())};
    const SurfaceLevels levels = decompose(field, filters, 3);
    reconstruct(levels, filters);
    timed(state, patch.size(), copySeconds(field.values), [&] {
        if (back) {
            benchmark::DoNotOptimize(reconstruct(levels, filters));
        } else {
            benchmark::DoNotOptimize(decompose(field, filters, 3));
        }
    });
}

void derive(benchmark::State& state, const char* mask, int width) {
    for (auto _ : state) benchmark::DoNotOptimize(construct(namedMask(mask), width));
}

BENCHMARK_CAPTURE(decomposeCurve, dlg_refined_closed, "dlg-refined", true)
    ->RangeMultiplier(10)
    ->Range(1000, 10000000);
BENCHMARK_CAPTURE(decomposeCurve, dlg_optimal_open, "dlg-optimal", false)
    ->RangeMultiplier(10)
    ->Range(1000, 10000000);
BENCHMARK_CAPTURE(decomposeCurve, cubic_7_closed, "cubic-7", true)
    ->RangeMultiplier(10)
    ->Range(1000, 10000000);
BENCHMARK_CAPTURE(reconstructCurve, dlg_refined_closed, "dlg-refined", true)
    ->RangeMultiplier(10)
    ->Range(1000, 10000000);
BENCHMARK_CAPTURE(reconstructCurve, cubic_7_closed, "cubic-7", true)
    ->RangeMultiplier(10)
    ->Range(1000, 10000000);
BENCHMARK_CAPTURE(surface, butterfly_3_decompose, "butterfly-3", false)->RangeMultiplier(4)->Range(32, 2048);
BENCHMARK_CAPTURE(surface, butterfly_3_reconstruct, "butterfly-3", true)->RangeMultiplier(4)->Range(32, 2048);
BENCHMARK_CAPTURE(surface, loop_1_decompose, "loop-1", false)->RangeMultiplier(4)->Range(32, 2048);
BENCHMARK_CAPTURE(derive, cubic_7, "cubic", 7);
BENCHMARK_CAPTURE(derive, butterfly_3, "butterfly", 3)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(derive, butterfly_4, "butterfly", 4)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
