// What is behind a Pyramid, for isowave's own sources.
#pragma once

#include "isowave/pyramid.h"
#include "wavelets/pyramid.h"

namespace isowave {

struct Pyramid::State {
    wavelets::Pyramid pyramid;
};

struct PyramidAccess {
    static Pyramid make(wavelets::Pyramid pyramid) {
        return Pyramid(std::make_shared<const Pyramid::State>(Pyramid::State{std::move(pyramid)}));
    }
    static const wavelets::Pyramid& of(const Pyramid& pyramid) { return pyramid.state_->pyramid; }
};

}  // namespace isowave
