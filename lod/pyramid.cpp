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

Pyramid analyse(Solid solid, const Progress& progress) {
    if (solid.isPyramid()) throw UsageError(solid.input().path + " is a pyramid already");
    const InputReport& input = solid.input();
    auto source = input.kind == InputReport::Kind::pyramid ? input.source
                                                           : lod::sourceOf(input, solid.fit());  // packed
    const StepOrder order = solid.order();
    const std::shared_ptr<const lod::SlabbedField> slabs = SolidAccess::of(solid).slabs;
    wavelets::Pyramid pyramid =
        slabs ? slabs->analyse(order, progress)
              : wavelets::analyse(SolidAccess::takeField(std::move(solid)), {.order = order}, progress);
    pyramid.source = std::move(source);
    return PyramidAccess::make(std::move(pyramid));
}

Solid solidOf(const Pyramid& pyramid) {
    return SolidAccess::make(lod::stateOf(PyramidAccess::of(pyramid), "pyramid"));
}

}  // namespace isowave
