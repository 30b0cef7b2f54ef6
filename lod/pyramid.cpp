#include "isowave/pyramid.h"

#include "compress/packed_file.h"
#include "isowave/error.h"
#include "lod/field_state.h"
#include "lod/open_pyramid.h"
#include "lod/packing/pack.h"
#include "lod/pyramid_state.h"
#include "lod/source.h"
#include "lod/steps.h"
#include "wavelets/pyramid_file.h"

namespace isowave {

Pyramid Pyramid::open(const std::filesystem::path& path, int finestStep, const Progress& progress) {
    if (!compress::isPackedPath(path)) return PyramidAccess::make(wavelets::readPyramid(path, finestStep));
    lod::PackedSolid packed = lod::openPacked(path, {}, progress);
    wavelets::Pyramid pyramid = wavelets::analyse(packed.field, {.order = packed.order}, progress);
    pyramid.source = std::move(packed.source);
    return PyramidAccess::make(std::move(pyramid));
}

void Pyramid::save(const std::filesystem::path& path) const {
    if (compress::isPackedPath(path))
        lod::packExactly(state_->pyramid.field(0), state_->pyramid, path);
    else
        wavelets::writePyramid(path, state_->pyramid);
}

double Pyramid::K() const { return state_->pyramid.K; }
int Pyramid::stepCount() const { return state_->pyramid.stepCount(); }
const StepOrder& Pyramid::order() const { return state_->pyramid.order; }

Field Pyramid::field(int step, const Progress& progress) const {
    return FieldAccess::make(state_->pyramid.field(step, progress));
}

std::vector<StepFacts> Pyramid::steps() const { return lod::factsOf(state_->pyramid); }
std::int64_t Pyramid::coefficientsStored() const { return state_->pyramid.coefficientsStored(); }
std::int64_t Pyramid::controlPoints() const { return lod::finestControlPoints(state_->pyramid); }
std::int64_t Pyramid::memoryBytes() const { return lod::bytesOf(state_->pyramid); }
const std::map<std::string, std::string>& Pyramid::source() const { return state_->pyramid.source; }

namespace {

std::map<std::string, std::string> sourceOf(const Solid& solid) {
    const InputReport& input = solid.input();
    if (solid.isPyramid()) throw UsageError(input.path + " is a pyramid already");
    return input.kind == InputReport::Kind::pyramid ? input.source  // packed
                                                    : lod::sourceOf(input, solid.fit());
}

}  // namespace

Pyramid analyse(Solid solid, const Progress& progress) {
    auto source = sourceOf(solid);
    const StepOrder order = solid.order();
    const std::shared_ptr<const lod::SlabbedField> slabs = SolidAccess::of(solid).slabs;
    wavelets::Pyramid pyramid =
        slabs ? slabs->analyse(order, progress)
              : wavelets::analyse(SolidAccess::takeField(std::move(solid)), {.order = order}, progress);
    pyramid.source = std::move(source);
    return PyramidAccess::make(std::move(pyramid));
}

PyramidCounts analyseTo(const std::filesystem::path& path, Solid solid, const Progress& progress) {
    const std::shared_ptr<const lod::SlabbedField> slabs = SolidAccess::of(solid).slabs;
    if (slabs && !compress::isPackedPath(path))
        return slabs->analyseTo(path, solid.order(), sourceOf(solid), progress);
    const Pyramid pyramid = analyse(std::move(solid), progress);
    pyramid.save(path);
    return {pyramid.stepCount(), pyramid.controlPoints(), pyramid.coefficientsStored()};
}

Solid solidOf(const Pyramid& pyramid) {
    return SolidAccess::make(lod::stateOf(PyramidAccess::of(pyramid), "pyramid"));
}

}  // namespace isowave
