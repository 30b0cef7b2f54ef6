#include "wavelets/keep_exactly.h"

#include "wavelets/exact.h"

namespace isowave::wavelets {

void keepExactly(Pyramid& pyramid, const BSplineField& field, const Progress& progress) {
    pyramid.exact = nullptr;
    pyramid.exact = missedOf(field, pyramid.field(0, progress));
}

}  // namespace isowave::wavelets
