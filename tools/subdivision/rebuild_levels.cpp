#include "tools/subdivision/rebuild_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "isowave/error.h"
#include "subdivision/curves/curve_details.h"
#include "subdivision/curves/curve_files.h"
#include "subdivision/curves/curve_limit.h"
#include "subdivision/curves/curve_rebuild.h"
#include "subdivision/lattice/grid_files.h"
#include "subdivision/lattice/relief_details.h"
#include "tools/subdivision/mesh_options.h"

namespace isowave::tools {
namespace {

using namespace subdivision;

// get() for a file: what it complains of is that file's fault.
template <class Get>
auto ofFile(const std::filesystem::path& path, const Get& get) -> decltype(get()) {
    try {
        return get();
    } catch (const InputError& error) {
        throw InputError(path.string(), error.what());
    }
}

[[noreturn]] void refuseMoved(const LevelsRebuild& wanted, const std::string& what, double distance,
                              std::string_view edited) {
    throw InputError(wanted.base.string(),
                     fmt::format("its {} lies {:.3g} away from that of the coarse one in {}; give {} as "
                                 "--edited, and as BASE what was written without --limit",
                                 what, distance, wanted.details.string(), edited));
}

// A closed curve of one point stands in a file as two equal ones.
Polyline asCoarse(Polyline found, const Polyline& coarse) {
    const auto d = static_cast<std::size_t>(found.dimension);
    const auto second = found.coordinates.begin() + found.dimension;
    if (coarse.size() != 1 || !coarse.closed || found.coordinates.size() != 2 * d ||
        !std::equal(second, found.coordinates.end(), found.coordinates.begin()))
        return found;
    found.coordinates.resize(d);
    found.closed = true;
    return found;
}

// The curves of a file, which are as many and as long as the coarse ones.
std::vector<Polyline> curvesLikeCoarse(const std::filesystem::path& path, const CurveFile& file,
                                       const CurveSet& set) {
    std::vector<Polyline> curves = file.curves();
    for (std::size_t i = 0; i < std::min(curves.size(), set.curves.size()); ++i)
        curves[i] = asCoarse(std::move(curves[i]), set.curves[i].coarse);
    ofFile(path, [&] { requireLikeCoarse(set, curves); });
    return curves;
}

void requireFormat(const std::filesystem::path& output, const std::string& extension,
                   const std::string& filled) {
    if (output.extension() == extension) return;
    throw UsageError(fmt::format("--output: '{}' has another format than {}; name it {}", output.string(),
                                 filled, extension));
}

Grid readCoarseHeights(const std::filesystem::path& path, const Grid& coarse) {
    const bool gaps = std::any_of(coarse.values.begin(), coarse.values.end(),
                                  [](double v) { return std::isnan(v); });  // of quincunx, around the hexagon
    Grid grid = readGrid(path, gaps);
    ofFile(path, [&] { firstMovedSample(coarse, grid); });
    return grid;
}

}  // namespace

DetailsOf detailsOf(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    char magic[8] = {};
    if (!stream.read(magic, sizeof magic)) return DetailsOf::meshes;
    const std::string_view found(magic, sizeof magic);
    if (found == kCurveDetailsMagic) return DetailsOf::curves;
    return found == kReliefDetailsMagic ? DetailsOf::heights : DetailsOf::meshes;
}

RebuiltLevels rebuildCurves(const LevelsRebuild& wanted) {
    const std::filesystem::path& filled = wanted.edited.value_or(wanted.base);
    requireFormat(wanted.output, filled.extension().string(), "'" + filled.string() + "', which it fills");
    CurveSet set = loadCurveDetails(wanted.details);
    if (wanted.positions == Positions::limit) asked("--limit", [&] { return CurveLimit(schemeOf(set)); });
    const CurveFile base = CurveFile::read(wanted.base);
    if (const auto moved = firstMovedPoint(set, curvesLikeCoarse(wanted.base, base, set)))
        refuseMoved(wanted, fmt::format("point {} of curve {}", moved->point, moved->curve), moved->distance,
                    "curves with moved points");
    CurveRebuildOptions options;
    const CurveFile file = wanted.edited ? CurveFile::read(*wanted.edited) : base;
    if (wanted.edited) options.moved = curvesLikeCoarse(*wanted.edited, file, set);
    options.frames = wanted.frames.value_or(options.frames);
    options.depth = wanted.depth;
    options.threshold = wanted.threshold;
    options.keep = wanted.keep;
    options.positions = wanted.positions;
    const RebuiltCurves rebuilt = ofFile(wanted.details, [&] { return rebuild(std::move(set), options); });
    return {file.with(rebuilt.curves), rebuilt.report};
}

RebuiltLevels rebuildHeights(const LevelsRebuild& wanted) {
    requireFormat(wanted.output, ".npy", "heights are written in");
    if (wanted.frames == Frames::local)
        throw UsageError("--frames local: has no meaning for heights, which have no direction; leave it out");
    const ReliefDetails details = ReliefDetails::load(wanted.details);
    const Grid coarse = details.coarseHeights();
    const Grid base = readCoarseHeights(wanted.base, coarse);
    if (const auto moved = firstMovedSample(coarse, base))
        refuseMoved(wanted, fmt::format("sample at row {}, column {}", moved->row, moved->column),
                    moved->distance, "changed heights");
    ReliefRebuildOptions options;
    if (wanted.edited) options.edited = readCoarseHeights(*wanted.edited, coarse);
    options.depth = wanted.depth;
    options.threshold = wanted.threshold;
    options.keep = wanted.keep;
    options.positions = wanted.positions;
    const RebuiltRelief rebuilt = ofFile(wanted.details, [&] { return details.rebuild(options); });
    return {npyBytes(rebuilt.heights), rebuilt.report};
}

}  // namespace isowave::tools
