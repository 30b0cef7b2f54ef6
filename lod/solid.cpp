#include "lod/solid.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/cad_model.h"
#include "compress/packed_file.h"
#include "io/image/formats/foreign.h"
#include "io/image/view.h"
#include "io/mesh/read.h"
#include "isowave/error.h"
#include "isowave/openvdb.h"
#include "lod/fit_solid.h"
#include "lod/open_image.h"
#include "lod/open_level_set.h"
#include "lod/open_mesh.h"
#include "lod/open_pyramid.h"
#include "lod/steps.h"
#include "wavelets/pyramid_file.h"

namespace isowave {
namespace fs = std::filesystem;

namespace lod {
namespace {

// ---- options that fit some kinds of input only ----

struct KindOption {
    const char* name;
    bool given;
    bool image, mesh, vdb;  // for which kinds it means something
};

void refuseForeignOptions(const std::string& name, InputKind kind, const SolidOptions& o) {
    const RawLayout raw = o.image.raw.value_or(RawLayout());
    const KindOption table[] = {
        {"--iso", o.iso.has_value(), true, false, true},
        {"--label", o.label.has_value() || !o.labels.empty(), true, false, false},
        {"--invert", o.invert, true, false, true},
        {"--open-border", o.openBorder, true, false, false},
        {"--voxels", o.voxels.has_value(), false, true, false},
        {"--voxel", o.voxel.has_value(), false, true, false},
        {"--close-holes", o.closeHoles.has_value(), false, true, false},
        {"--thicken", o.thicken.has_value(), false, true, false},
        {"--unit", o.unit.has_value(), false, true, false},
        {"--fit", o.fit.has_value(), true, true, true},
        {"--half-width", o.halfWidth.has_value(), true, true, true},
        {"--band", o.band.has_value(), true, true, true},
        {"--type", !raw.type.empty(), true, false, false},
        {"--spacing", o.image.spacing.has_value(), true, false, false},
        {"--endian", o.image.raw && raw.type.empty() && raw.headerBytes == 0, true, false, false},
        {"--header-bytes", raw.headerBytes != 0, true, false, false},
        {"--volume", o.image.volume.has_value(), true, false, false},
        {"--nan", o.image.nan.has_value(), true, false, false},
        {"--series", o.image.series.has_value(), true, false, false},
        {"--stack", o.image.stack.has_value(), true, false, false},
        {"--channel", o.image.channel.has_value(), true, false, false},
        {"--time", o.image.time.has_value(), true, false, false},
        {"--resample-slices", o.image.resampleSlices, true, false, false},
        {"--grid", o.grid.has_value(), false, false, true},
        {"--axes", o.axes.has_value(), true, true, true},
        {"--slabs", o.slabs.has_value(), true, false, false},
    };
    const char* what = kind == InputKind::image  ? "an image"
                       : kind == InputKind::mesh ? "a mesh"
                       : kind == InputKind::vdb  ? "a level set"
                                                 : "a pyramid, whose solid was fitted when it was made";
    for (const KindOption& option : table) {
        const bool fits = (kind == InputKind::image && option.image) ||
                          (kind == InputKind::mesh && option.mesh) || (kind == InputKind::vdb && option.vdb);
        if (option.given && !fits)
            throw UsageError(
                fmt::format("{} has no meaning for {}, which is {}; leave it out", option.name, name, what));
    }
}

bool hasExtension(const fs::path& path, std::string_view extension) {
    std::string found = path.extension().string();
    std::transform(found.begin(), found.end(), found.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    return found == extension;
}

// Checks the options, opens, and keeps the time that it took.
template <class Open>
Solid opened(const std::string& name, InputKind kind, const SolidOptions& options, const Progress& progress,
             const Open& open) {
    refuseForeignOptions(name, kind, options);
    StageClock clock;
    Solid::State state = open(clock);
    if (kind != InputKind::pyramid) state.order = orderFor(state.voxel(), options, name, progress);
    state.stages = clock.stages();
    state.seconds = clock.secondsSoFar();
    return SolidAccess::make(std::move(state));
}

}  // namespace

InputKind kindOf(const fs::path& path, const SolidOptions& options) {
    std::error_code error;
    if (!fs::exists(path, error))
        throw InputError(path.string(),
                         error ? "cannot be looked at (" + error.message() + ")" : "no such file");
    if (options.image.raw && options.image.raw->size != std::array<std::int64_t, 3>{})
        return InputKind::image;
    if (const auto text = cadModelText(path)) throw InputError(path.string(), *text);
    if (hasExtension(path, ".vdb"))
        return wavelets::isPyramidFile(path) ? InputKind::pyramid : InputKind::vdb;
    if (compress::isPackedPath(path)) return InputKind::pyramid;
    if (isMeshPath(path)) return InputKind::mesh;
    if (isImagePath(path)) return InputKind::image;
    if (const auto text = imageio::foreignText(path)) throw InputError(path.string(), *text);
    throw InputError(path.string(),
                     "is neither an image, a mesh nor a .vdb by its name; a headerless image needs "
                     "--size, --type and --spacing");
}

InputKind checkedKindOf(const fs::path& path, const SolidOptions& options) {
    const InputKind kind = kindOf(path, options);
    refuseForeignOptions(path.string(), kind, options);
    return kind;
}

}  // namespace lod

double Solid::K() const {
    return state_->field ? state_->field->K : state_->slabs ? state_->slabs->K() : state_->pyramid->K;
}
Space Solid::space() const { return state_->space; }
const InputReport& Solid::input() const { return state_->input; }
const std::optional<FitSummary>& Solid::fit() const { return state_->fit; }
bool Solid::isPyramid() const { return state_->pyramid.has_value(); }
const StepOrder& Solid::order() const { return state_->order; }
const std::vector<StageSeconds>& Solid::seconds() const { return state_->stages; }

Solid open(const fs::path& path, const SolidOptions& options, const Progress& progress) {
    lod::checkFitOptions(options);
    const lod::InputKind kind = lod::kindOf(path, options);
    return lod::opened(path.string(), kind, options, progress, [&](StageClock& clock) {
        switch (kind) {
            case lod::InputKind::image:
                return lod::openImage(path, options, progress, clock);
            case lod::InputKind::mesh:
                return lod::openMesh(path, options, progress, clock);
            case lod::InputKind::vdb:
                return lod::openLevelSet(path, options, progress, clock);
            case lod::InputKind::pyramid:
                break;
        }
        return lod::openPyramid(path, options, progress, clock);
    });
}

Solid open(const TriangleMesh& mesh, const SolidOptions& options, const Progress& progress, Space space) {
    lod::checkFitOptions(options);
    return lod::opened("mesh", lod::InputKind::mesh, options, progress, [&](StageClock& clock) {
        return lod::openMesh(mesh, space, options, progress, clock);
    });
}

Solid open(const Image& image, const SolidOptions& options, const Progress& progress) {
    lod::checkFitOptions(options);
    return lod::opened("image", lod::InputKind::image, options, progress,
                       [&](StageClock& clock) { return lod::openImage(image, options, progress, clock); });
}

Solid open(const VoxelView& voxels, const SolidOptions& options, const Progress& progress) {
    lod::checkFitOptions(options);
    return lod::opened(imageio::kViewName, lod::InputKind::image, options, progress,
                       [&](StageClock& clock) { return lod::openImage(voxels, options, progress, clock); });
}

Solid open(const openvdb::FloatGrid& levelSet, const SolidOptions& options, const Progress& progress) {
    lod::checkFitOptions(options);
    return lod::opened("level set", lod::InputKind::vdb, options, progress, [&](StageClock& clock) {
        return lod::openLevelSet(levelSet.deepCopy(), "level set", options, progress, clock);
    });
}

}  // namespace isowave
