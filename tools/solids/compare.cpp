// isowave compare A B: how far apart two surfaces are.
#include <cmath>
#include <limits>

#include "lod/open_mesh.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/option_values.h"
#include "tools/report/mesh_report.h"

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

class Compare : public Command {
  public:
    Compare()
        : Command({"compare", "A B", "distances between two meshes, both ways, and their volume difference",
                   "Distances from samples of one surface to the nearest point of the other: mean and rms "
                   "weighted "
                   "by area, max over the samples, and a bound that no point of the surface exceeds."}) {
        declareJson();
        options_.value("--sampling", "LEN", "1/500 of the diagonal",
                       "largest distance of a point of the surface to a sample",
                       [this](const std::string& v) { sampling_ = lengthIn(v, kWorldUnits); });
        declareThreads();
        declareTalk();
    }

    int run(Console& console) override {
        const lod::LoadedMesh a = lod::loadMesh(arguments[0], console.progress());
        const lod::LoadedMesh b = lod::loadMesh(arguments[1], console.progress());
        if (a.space != b.space)
            console.say(
                "the meshes name different axes (SPACE=); RAS was turned to LPS, and one that says nothing "
                "was "
                "taken as it is");
        CompareReport report{arguments[0].string(),
                             arguments[1].string(),
                             sampling_.value_or(diagonalOf(a.mesh) / kSamplesPerDiagonal),
                             {}};
        report.comparison = compareMeshes(a.mesh, b.mesh, report.sampling, console.progress());
        tell(console, textOf(report), jsonOf(report));
        return 0;
    }

  private:
    std::optional<double> sampling_;
};

}  // namespace

std::unique_ptr<Command> compareCommand() { return std::make_unique<Compare>(); }

}  // namespace isowave::tools
