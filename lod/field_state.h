// What is behind a Field, for isowave's own sources.
#pragma once

#include "isowave/field.h"
#include "volume/field.h"

namespace isowave {

struct Field::State {
    BSplineField field;
};

struct FieldAccess {
    static Field make(BSplineField field) {
        return Field(std::make_shared<const Field::State>(Field::State{std::move(field)}));
    }
    static const BSplineField& of(const Field& field) { return field.state_->field; }
};

}  // namespace isowave
