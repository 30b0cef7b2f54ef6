#include "wavelets/part_direction.h"

namespace isowave::wavelets {

DirectionResult analysePart(const BSplineField& part, int axis, const Progress& progress) {
    DirectionResult result = analyseDirection(part, axis, progress);
    const openvdb::BoolTree& fine = part.shape->constTree();
    signPart(result.coarse.shape->tree(), fine, axis, true);
    signPart(result.coarse.controlPoints->tree(), fine, axis, -static_cast<float>(part.K));
    return result;
}

}  // namespace isowave::wavelets
