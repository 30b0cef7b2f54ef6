// curves_ladder INPUT [PIXELS]: every step of `isowave curves`' ladder on a large input as a markdown table: domain,
// control points, rings, area beside step 1, and whether the rings are valid: simple, disjoint, turning the right way,
// nested as they say. CGAL's exact predicates judge (tests/curves2d/validity.h); it exits with 1 if a step is not
// valid. At the end, the coefficients that the transform stores.
//
//     cmake --preset release -DISOWAVE_BENCH=ON && cmake --build --preset release --target curves_ladder
//     bench/fetch_coastlines coastlines && build/release/bin/curves_ladder coastlines/land-10m.json 65536
#include <fmt/format.h>

#include <cstdlib>
#include <iostream>

#include "isowave/curves.h"
#include "tests/curves2d/validity.h"

int main(int argc, char** argv) {
    using namespace isowave::curves2d;
    if (argc < 2 || argc > 3) {
        std::cerr << "curves_ladder INPUT [PIXELS]\n";
        return 2;
    }
    InputOptions options;
    if (argc > 2) options.pixels = std::atoi(argv[2]);
    Input input = readInput(argv[1], options);
    fmt::print(
        "{}; {} pixels; lengths in pixels\n\n"
        "| step | domain | \\|I\\| | rings, holes | points | area beside step 1, % | rms to step 1 | valid "
        "|\n"
        "|---|---|---|---|---|---|---|---|\n",
        input.kind, options.pixels);
    bool good = true;
    double area = 0;
    const double pixel = input.pixel;
    const Ladder ladder = makeLadder(std::move(input), {}, [&](const LadderStep& step) {
        const StepFacts& f = step.facts();
        if (f.step == 0) area = f.area;
        const std::string wrong = validity::complaintOfMany(step.curves().rings);
        good = good && wrong.empty();
        fmt::print("| {} | {}x{} | {} | {}, {} | {} | {:+.3f} | {:.2f} | {} |\n", step.name(), f.domain[0],
                   f.domain[1], f.controlPoints, f.rings, f.holes, f.points, 100 * (f.area / area - 1),
                   f.rmsToLevel0 / pixel, wrong.empty() ? "yes" : wrong);
        std::cout.flush();
    });
    fmt::print(
        "\n{} control points, {} coefficients (+{:.1f} %)\n", ladder.controlPoints, ladder.coefficients,
        100.0 * (static_cast<double>(ladder.coefficients) / static_cast<double>(ladder.controlPoints) - 1));
    return good ? 0 : 1;
}
