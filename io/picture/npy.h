// Arrays of NumPy (.npy).
#pragma once

#include <string>
#include <string_view>

#include "io/picture/picture.h"

namespace isowave {

// Two axes, or three with at most four channels last; from 2 x 2 to 2^20 x 2^20; booleans, integers up to 64 bits and
// floats of 32 or 64, in either byte order, C or Fortran order. `name` stands in messages. Throws InputError:
// truncated, another type or shape.
Picture readNpy(std::string_view bytes, const std::string& name);

// Version 1.0: shape (rows, columns), or (rows, columns, channels) of more than one.
std::string npyBytes(const Picture& picture);

}  // namespace isowave
