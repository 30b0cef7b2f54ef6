// Height fields and point grids in files: NumPy arrays and ESRI ASCII grids. Pictures are in picture_files.h.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace isowave::subdivision {

struct Grid {
    std::size_t rows = 0, columns = 0, channels = 1;
    std::vector<double> values;  // row by row, the channels of a sample together

    double at(std::size_t row, std::size_t column, std::size_t channel = 0) const {
        return values[(row * columns + column) * channels + channel];
    }
};

// .npy: two axes (heights), or three with at most four channels last; booleans, integers up to 64 bits and
// floats of
//   32 or 64, either byte order, C or Fortran order.
// .asc: ESRI ASCII grid (ncols, nrows, xll.., yll.., cellsize, NODATA_value, then the rows from the top).
// Throws InputError: truncated, another type or shape, samples without data (how many, and where the first
// is).
Grid readGrid(const std::filesystem::path& path);
Grid parseNpy(const std::string& bytes, const std::string& name);
Grid parseAsc(const std::string& text, const std::string& name);

// NumPy, float64, version 1.0: shape (rows, columns) or (rows, columns, channels).
std::string npyBytes(const Grid& grid);

}  // namespace isowave::subdivision
