#include "subdivision/lattice/grid_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>

#include "base/read_file.h"
#include "io/picture/asc.h"
#include "io/picture/npy.h"
#include "io/picture/png.h"
#include "io/picture/tiff.h"
#include "isowave/error.h"

namespace isowave::subdivision {

namespace {

Picture readByName(const std::filesystem::path& path, const std::string& name) {
    const std::string extension = path.extension().string();
    if (extension == ".npy") return readNpy(readFile(path, "a grid of numbers"), name);
    if (extension == ".asc") return readAsc(readFile(path, "a grid of numbers"), name);
    if (extension != ".png" && extension != ".tif" && extension != ".tiff")
        throw InputError(name, "is of no kind that holds a grid; they are .npy .asc .png .tif");
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
        throw InputError(name, "is a folder; expected a picture");
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw InputError(name, "cannot be opened; is the name right?");
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    Picture picture = extension == ".png" ? readPng(bytes, name) : readTiff(bytes, name);
    if (picture.pages > 1)
        throw InputError(
            name, fmt::format("holds {} pages; expected one. Save the page as an image", picture.pages));
    return picture;
}

void requireFinite(const Grid& grid, const std::string& name) {
    std::size_t missing = 0, first = 0;
    for (std::size_t k = grid.values.size(); k-- > 0;) {
        if (std::isfinite(grid.values[k])) continue;
        ++missing;
        first = k / grid.channels;
    }
    if (missing == 0) return;
    throw InputError(
        name, fmt::format(
                  "{} of {} samples hold no finite number, the first at row {}, column {}; fill them or crop",
                  missing, grid.values.size(), first / grid.columns, first % grid.columns));
}

// What GeoTIFF marks as no height would be one far below or above all others.
void requireData(const Grid& grid, double noData, const std::string& name) {
    std::size_t missing = 0, first = 0;
    for (std::size_t k = grid.values.size(); k-- > 0;) {
        if (grid.values[k] != noData) continue;
        ++missing;
        first = k / grid.channels;
    }
    if (missing == 0) return;
    throw InputError(
        name, fmt::format("{} of {} samples are without data ({}), the first at row {}, column {}; fill "
                          "them or crop",
                          missing, grid.values.size(), noData, first / grid.columns, first % grid.columns));
}

Picture sized(const Grid& grid) {
    return {.width = static_cast<std::int64_t>(grid.columns), .height = static_cast<std::int64_t>(grid.rows)};
}

}  // namespace

Grid readGrid(const std::filesystem::path& path, bool gaps) {
    const std::string name = path.string();
    const Picture picture = readByName(path, name);
    Grid grid{static_cast<std::size_t>(picture.height), static_cast<std::size_t>(picture.width),
              static_cast<std::size_t>(heightChannels(picture)), heights(picture, name)};
    if (grid.rows < 2 || grid.columns < 2) throw InputError(name, "has fewer than 2 rows or columns");
    if (!gaps && picture.noData) requireData(grid, *picture.noData, name);
    if (!gaps) requireFinite(grid, name);
    return grid;
}

std::string npyBytes(const Grid& grid) {
    Picture picture = sized(grid);
    picture.channels = static_cast<int>(grid.channels);
    picture.type = ValueType::float64;
    picture.samples.resize(grid.values.size() * sizeof(double));
    std::memcpy(picture.samples.data(), grid.values.data(), picture.samples.size());
    return isowave::npyBytes(picture);
}

std::string pngBytes(const Grid& grid, double black, double white) {
    const double scale = white != black ? 255 / (white - black) : 0;  // black may be the larger: a negative
    Picture picture = sized(grid);
    picture.isSrgb = true;
    picture.samples.resize(grid.rows * grid.columns);
    for (std::size_t k = 0; k < picture.samples.size(); ++k) {
        const double value = grid.values[k * grid.channels];
        const double level = std::isfinite(value) ? std::clamp((value - black) * scale, 0.0, 255.0) : 255.0;
        picture.samples[k] = static_cast<std::byte>(std::lround(level));
    }
    return isowave::pngBytes(picture);
}

}  // namespace isowave::subdivision
