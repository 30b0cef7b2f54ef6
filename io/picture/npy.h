// Arrays of NumPy (.npy).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/value_type.h"

#include "io/picture/picture.h"

namespace isowave {

// What stands before the elements.
struct NpyHeader {
    ValueType type = ValueType::uint8;  // booleans: 0 and 1
    bool half = false;                  // floats of 16 bits, of which `type` (uint16) has the bits
    bool bigEndian = false, fortran = false;
    std::vector<std::size_t> shape;
    std::string shapeText;  // as it stands there: "(56,48,40)"
    std::size_t data = 0;   // byte of the first element
};
bool beginsAsNpy(std::string_view bytes);
// bytes: the file's first ones, as many as the header has. Throws InputError: truncated, another type of elements.
NpyHeader readNpyHeader(std::string_view bytes, const std::string& name);

// Two axes, or three with at most four channels last; from 2 x 2 to 2^20 x 2^20; booleans, integers up to 64 bits and
// floats of 32 or 64, in either byte order, C or Fortran order. `name` stands in messages. Throws InputError:
// truncated, another type or shape.
Picture readNpy(std::string_view bytes, const std::string& name);

// Version 1.0: shape (rows, columns), or (rows, columns, channels) of more than one.
std::string npyBytes(const Picture& picture);

}  // namespace isowave
