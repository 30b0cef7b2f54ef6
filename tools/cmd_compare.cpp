// isowave compare A B: how far apart two surfaces are.
#include <fmt/format.h>

#include <cmath>

#include "simplify/measure.h"
#include "tools/commands.h"
#include "tools/input.h"

namespace isowave::tools {
namespace {

// Samples are at most this part of A's diagonal away from any point of the surface.
constexpr double kSamplesPerDiagonal = 500;

double diagonalOf(const TriangleMesh& mesh) {
    Point low, high;
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (const Point& p : mesh.points)
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    return mesh.points.empty() ? 0 : std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
}

// In per cent; a surface that is flat, or open in the right way, has the volume 0.
std::string relativeText(double difference, double whole) {
    const double percent = 100 * difference / whole;
    return std::isfinite(percent) ? fmt::format("{:+.3g}", percent) : "-";
}

Json sideJson(const OneSidedDistance& side) {
    return {{"mean", finite(side.mean)},
            {"rms", finite(side.rms)},
            {"max", finite(side.max)},
            {"max_bound", finite(side.maxBound)},
            {"samples", side.samples}};
}

std::string textOf(const MeshComparison& c) {
    Table table({"distance", "mean", "rms", "max", "at most", "samples"});
    const auto side = [&](const char* name, const OneSidedDistance& d) {
        table.row({name, shortNumber(d.mean), shortNumber(d.rms), shortNumber(d.max), shortNumber(d.maxBound),
                   grouped(d.samples)});
    };
    side("A -> B", c.aToB);
    side("B -> A", c.bToA);
    table.row(
        {"symmetric", shortNumber(c.mean), shortNumber(c.rms), shortNumber(c.max), shortNumber(c.maxBound)});
    return table.text() + fmt::format("volume A {}, B {}, B - A {} ({} %)\n", shortNumber(c.volumeA),
                                      shortNumber(c.volumeB), shortNumber(c.volumeDifference),
                                      relativeText(c.volumeDifference, c.volumeA));
}

}  // namespace

int runCompare(const Settings& settings, Console& console) {
    const LoadedMesh a = loadMesh(settings.files[0], console.progress());
    const LoadedMesh b = loadMesh(settings.files[1], console.progress());
    if (a.space != b.space)
        console.say(
            "the meshes name different axes (SPACE=); RAS was turned to LPS, and one that says nothing was "
            "taken as it is");
    const double sampling = settings.sampling.value_or(diagonalOf(a.mesh) / kSamplesPerDiagonal);
    const MeshComparison c = compareMeshes(a.mesh, b.mesh, sampling, console.progress());

    console.progress().check();  // a stop that came too late for the last stage prints nothing either
    if (!settings.json) {
        console.print(textOf(c));
        return 0;
    }
    Json json;
    json["version"] = 1;
    json["a"] = {{"path", settings.files[0].string()}, {"volume", finite(c.volumeA)}};
    json["b"] = {{"path", settings.files[1].string()}, {"volume", finite(c.volumeB)}};
    json["sampling"] = sampling;
    json["a_to_b"] = sideJson(c.aToB);
    json["b_to_a"] = sideJson(c.bToA);
    json["symmetric"] = {{"mean", finite(c.mean)},
                         {"rms", finite(c.rms)},
                         {"max", finite(c.max)},
                         {"max_bound", finite(c.maxBound)}};
    json["volume_difference"] = finite(c.volumeDifference);
    console.print(tools::textOf(json));
    return 0;
}

}  // namespace isowave::tools
