// isowave info FILE: what is in it.
#include <algorithm>

#include "base/text.h"
#include "compress/packed_file.h"
#include "compress/sections.h"
#include "curves2d/file/pyramid_file.h"
#include "curves2d/fit.h"
#include "io/mesh/equal_points.h"
#include "isowave/error.h"
#include "lod/open_image.h"
#include "lod/open_mesh.h"
#include "lod/solid.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/report/curves.h"
#include "tools/report/info_report.h"
#include "tools/solids/solid_options.h"
#include "volume/vdb_file.h"
#include "wavelets/pyramid_file.h"

namespace isowave::tools {
namespace {
namespace fs = std::filesystem;

ImageInfo imageInfo(const fs::path& path, const SolidOptions& options, Console& console) {
    ImageStream stream(path, lod::imageReadOptions(options));
    const ImageStatistics statistics = statisticsOf(stream, {}, console.progress());
    for (const std::string& warning : stream.header().warnings) console.say(warning);
    return {path.string(), stream.header(), statistics};
}

MeshInfo meshInfo(const fs::path& path, Console& console) {
    const lod::LoadedMesh loaded = lod::loadMesh(path, console.progress());
    MeshInfo info{
        path.string(), loaded.format, loaded.space, topologyOf(mergeEqualPoints(loaded.mesh)), {}, {}};
    info.low = info.high = loaded.mesh.points.front();
    for (const Point& p : loaded.mesh.points)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            info.low[axis] = std::min(info.low[axis], p[axis]);
            info.high[axis] = std::max(info.high[axis], p[axis]);
        }
    return info;
}

VdbInfo::Metadata metadataOf(const openvdb::MetaMap& map) {
    VdbInfo::Metadata metadata;
    for (auto entry = map.beginMeta(); entry != map.endMeta(); ++entry)
        metadata.emplace_back(entry->first, entry->second ? entry->second->str() : std::string());
    return metadata;
}

VdbInfo::Grid gridInfo(const openvdb::GridBase& grid) {
    const auto box = grid.evalActiveVoxelBoundingBox();
    const auto dim = box.empty() ? openvdb::Coord(0) : box.dim();
    const auto spacing = grid.voxelSize();
    return {grid.getName(),
            grid.valueType(),
            openvdb::GridBase::gridClassToString(grid.getGridClass()),
            static_cast<std::int64_t>(grid.activeVoxelCount()),
            {dim.x(), dim.y(), dim.z()},
            {spacing.x(), spacing.y(), spacing.z()},
            metadataOf(grid)};
}

VdbInfo vdbInfo(const fs::path& path) {
    const VdbContent content = readVdb(path);
    VdbInfo info{path.string(), {}, {}};
    if (content.metadata) info.metadata = metadataOf(*content.metadata);
    for (const auto& grid : content.grids) info.grids.push_back(gridInfo(*grid));
    return info;
}

PyramidInfo pyramidInfo(const fs::path& path, const LevelOptions& options, Console& console) {
    const Pyramid pyramid = Pyramid::open(path);
    PyramidInfo info;
    info.path = path.string();
    info.packed = compress::isPackedPath(path);
    info.formatVersion =
        info.packed ? static_cast<int>(compress::kPackedFormatVersion) : wavelets::kPyramidFormatVersion;
    info.K = pyramid.K();
    info.source = pyramid.source();
    info.coefficientsStored = pyramid.coefficientsStored();
    info.controlPoints = pyramid.controlPoints();
    info.memoryBytes = pyramid.memoryBytes();
    info.fileBytes = static_cast<std::int64_t>(fs::file_size(path));
    info.order = pyramid.order();
    info.steps = pyramid.steps();
    info.levels = describeLevels(pyramid, options, console.progress());
    return info;
}

CurvePyramidInfo curvesInfo(const fs::path& path, Console& console) {
    curves2d::Input input = curves2d::readInput(path, {}, console.progress());
    CurvePyramidInfo info{.path = path.string(),
                          .kind = input.kind,
                          .formatVersion = curves2d::kPyramidFormatVersion,
                          .K = input.fitted->field.K,
                          .pixel = input.pixel,
                          .extent = input.extent,
                          .yUp = input.yUp,
                          .fileBytes = static_cast<std::int64_t>(fs::file_size(path)),
                          .ladder = {},
                          .steps = {}};
    info.ladder = curves2d::makeLadder(
        std::move(input), {}, [&](const curves2d::LadderStep& step) { info.steps.push_back(step.facts()); },
        console.progress());
    return info;
}

// What other commands read is no mystery. complaint: why it is none of what this command reads.
std::string adviceFor(const fs::path& path, const std::string& complaint) {
    const std::string extension = toLower(path.extension().string());
    const auto isOneOf = [&](std::initializer_list<const char*> all) {
        std::error_code ignored;
        return fs::is_regular_file(path, ignored) &&
               std::find(all.begin(), all.end(), extension) != all.end();
    };
    const bool flat = complaint.find("is a 2D image") != std::string::npos;
    if (isOneOf({".pgm", ".pbm", ".ppm", ".asc"}) || (flat && isOneOf({".png", ".bmp", ".npy"})))
        return "; isowave curves draws the outline of a picture, isowave relief takes its values as heights";
    if (isOneOf({".geojson", ".json", ".topojson", ".svg", ".txt"}))
        return "; isowave curves makes levels of polygons, isowave curve-levels of lines";
    return "";
}

class Info : public Command {
  public:
    Info()
        : Command({"info", "FILE", "what is in an image, a mesh, a .vdb, a pyramid or curves",
                   "Prints size, spacing, orientation and the range of values of an image; counts and bounds "
                   "of a "
                   "mesh; the grids of a .vdb; a table of the steps of a pyramid, of a solid (.vdb, .iwz) or "
                   "of curves (.iwc)."}) {
        declareFeatures(options_, level_);
        declareJson();
        declareImage(options_, solid_);
        declareThreads();
        declareMaxMemory(options_, solid_);
        declareTalk();
    }

    int run(Console& console) override {
        try {
            tellOf(arguments[0], console);
        } catch (const InputError& error) {
            throw InputError(error.what() + adviceFor(arguments[0], error.what()));
        }
        return 0;
    }

  private:
    void tellOf(const fs::path& path, Console& console) {
        if (curves2d::isPyramidPath(path)) return show(console, curvesInfo(path, console));
        switch (lod::kindOf(path, solid_)) {
            case lod::InputKind::image:
                show(console, imageInfo(path, solid_, console));
                break;
            case lod::InputKind::mesh:
                show(console, meshInfo(path, console));
                break;
            case lod::InputKind::vdb:
                show(console, vdbInfo(path));
                break;
            case lod::InputKind::pyramid:
                show(console, pyramidInfo(path, level_, console));
                break;
        }
    }

    template <class Report>
    void show(Console& console, const Report& info) {
        tell(console, textOf(info), jsonOf(info));
    }

    SolidOptions solid_;
    LevelOptions level_;
};

}  // namespace

std::unique_ptr<Command> infoCommand() { return std::make_unique<Info>(); }

}  // namespace isowave::tools
