// Time goes with the number of control points: the same solid at 64^3 .. 1024^3, and the slope of log time over
// log |I|, which is 1 where cost is O(|I|). The finest one is built from its surface outwards (bench/part.h), as a dense
// 1024^3 image would be 4 GB.
//
//     cmake --preset release -DISOWAVE_BENCH=ON && cmake --build --preset release --target scaling
//     build/release/bin/scaling [LARGEST [THREADS]]     LARGEST: 64, 128, ... 1024; default 1024, 2 threads
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <vector>

#include "base/heap.h"
#include "part.h"
#include "polygonize/polygonize.h"
#include "volume/fit.h"
#include "wavelets/pyramid.h"

namespace {

using namespace isowave;

// Best of a few, of which the first warms memory up.
double seconds(const std::function<void()>& work) {
    double best = 1e9;
    for (int i = 0; i < 3; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        work();
        best =
            std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    return best;
}

struct Row {
    double points;
    std::vector<double> times;
};

constexpr std::array kColumns = {"fit", "analysis", "synthesis", "one direction", "polygonize"};

Row measured(int voxels) {
    const auto distance = bench::sparseDistance(bench::PerforatedPart(voxels), 4);
    BSplineField field;
    Row row;
    row.times.push_back(seconds([&] { field = fitDistance(*distance); }));
    row.points = static_cast<double>(field.controlPointCount());
    wavelets::Pyramid pyramid;
    row.times.push_back(seconds([&] { pyramid = wavelets::analyse(field); }));
    row.times.push_back(seconds([&] { pyramid.field(0); }));
    pyramid = {};
    row.times.push_back(seconds([&] { wavelets::analyseDirection(field, 0); }));
    row.times.push_back(seconds([&] { polygonize(field); }));
    return row;
}

// Least squares of log time over log points, over the rows from `first` on.
double slope(const std::vector<Row>& rows, std::size_t column, std::size_t first) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t i = first; i < rows.size(); ++i) {
        const double u = std::log(rows[i].points), v = std::log(rows[i].times[column]);
        n += 1, x += u, y += v, xx += u * u, xy += u * v;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace

int main(int argc, char** argv) {
    setUpHeap();
    const int largest = argc > 1 ? std::atoi(argv[1]) : 1024;
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(argc > 2 ? std::atoi(argv[2]) : 2));
    measured(64);  // tables, threads
    std::vector<Row> rows;
    fmt::print("| voxels | control points |");
    for (const char* column : kColumns) fmt::print(" {} ms | ns a point |", column);
    fmt::print("\n");
    for (int voxels = 64; voxels <= largest; voxels *= 2) {
        rows.push_back(measured(voxels));
        fmt::print("| {}^3 | {:.0f} |", voxels, rows.back().points);
        for (const double time : rows.back().times)
            fmt::print(" {:.1f} | {:.1f} |", 1e3 * time, 1e9 * time / rows.back().points);
        fmt::print("\n");
        std::fflush(stdout);
    }
    fmt::print("| slope | |");
    for (std::size_t c = 0; c < kColumns.size(); ++c) fmt::print(" {:.3f} | |", slope(rows, c, 0));
    fmt::print("\n");
}
