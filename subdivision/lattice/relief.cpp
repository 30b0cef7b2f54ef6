#include "subdivision/lattice/relief.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "isowave/error.h"

namespace isowave::subdivision {

namespace {

// The middle `count` of `have`, from this index on.
std::size_t middle(std::size_t have, std::size_t count) { return (have - count) / 2; }

std::size_t upTo(std::size_t length, std::size_t unit) { return (length + unit - 1) / unit * unit; }

// REQUIRES: i < 2 count - 1.
std::size_t mirrored(std::size_t i, std::size_t count) { return i < count ? i : 2 * (count - 1) - i; }

[[noreturn]] void refuse(const Grid& grid, int levels, const std::string& needed) {
    throw InputError("grid", "of " + std::to_string(grid.rows) + " x " + std::to_string(grid.columns) +
                                 " samples is too small for " + std::to_string(levels) +
                                 " levels; they need " + needed);
}

SurfaceField rowsField(const Grid& grid, int levels) {
    const std::size_t unit = std::size_t{1} << levels;
    const std::string side = std::to_string(unit + 1);
    if (grid.columns <= unit || grid.rows <= unit) refuse(grid, levels, side + " x " + side);
    const std::size_t a = upTo(grid.columns - 1, unit), b = upTo(grid.rows - 1, unit);
    SurfaceField field{
        Patch::parallelogram(static_cast<int>(a), static_cast<int>(b)), static_cast<int>(grid.channels), {}};
    for (std::size_t r = 0; r <= b; ++r)
        for (std::size_t column = 0; column <= a; ++column)
            for (std::size_t c = 0; c < grid.channels; ++c)
                field.values.push_back(grid.at(mirrored(r, grid.rows), mirrored(column, grid.columns), c));
    return field;
}

// The hexagon of side n takes 2n+1 rows and 4n+1 columns of samples; its middle is a used sample.
SurfaceField quincunxField(const Grid& grid, int levels) {
    const std::size_t unit = std::size_t{1} << levels;
    const std::size_t n = quincunxSide(grid.rows, grid.columns, levels);
    if (n == 0)
        refuse(grid, levels,
               std::to_string(2 * unit + 1) + " rows and " + std::to_string(4 * unit + 1) + " columns");
    SurfaceField field{Patch::hexagon(static_cast<int>(n)), static_cast<int>(grid.channels), {}};
    const std::size_t row0 = middle(grid.rows, 2 * n + 1) + n,
                      column0 = middle(grid.columns, 4 * n + 1) + 2 * n;
    for (const Node node : field.patch.nodes()) {
        const auto row = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(row0) + node.y);
        const auto column =
            static_cast<std::size_t>(static_cast<std::ptrdiff_t>(column0) + 2 * node.x + node.y);
        for (std::size_t c = 0; c < grid.channels; ++c) field.values.push_back(grid.at(row, column, c));
    }
    return field;
}

Grid quincunxPicture(const SurfaceField& field) {
    const int n = field.patch.lastRow();
    const auto channels = static_cast<std::size_t>(field.channels);
    Grid grid{static_cast<std::size_t>(2 * n + 1), static_cast<std::size_t>(4 * n + 1), channels, {}};
    grid.values.assign(grid.rows * grid.columns * channels, std::numeric_limits<double>::quiet_NaN());
    const auto place = [&](Node node) { return quincunxSample(field.patch, node) * channels; };
    for (const Node node : field.patch.nodes()) {
        const std::size_t from = field.patch.index(node) * channels;
        const bool hasNext = node.x < field.patch.high(node.y);
        for (std::size_t c = 0; c < channels; ++c) {
            grid.values[place(node) + c] = field.values[from + c];
            if (hasNext) {
                grid.values[place(node) + channels + c] =
                    0.5 * (field.values[from + c] + field.values[from + channels + c]);
            }
        }
    }
    return grid;
}

}  // namespace

std::size_t quincunxSide(std::size_t rows, std::size_t columns, int levels) {
    return std::min((rows - 1) / 2, (columns - 1) / 4) >> levels << levels;
}

std::size_t quincunxSample(const Patch& hexagon, Node node) {
    const int n = hexagon.lastRow();
    return static_cast<std::size_t>(node.y + n) * static_cast<std::size_t>(4 * n + 1) +
           static_cast<std::size_t>(2 * node.x + node.y + 2 * n);
}

SurfaceField reliefField(const Grid& grid, ReliefLayout layout, int levels) {
    if (levels < 0 || levels > 24)
        throw InputError("levels", std::to_string(levels) + " levels are asked for; there may be 0 to 24");
    return layout == ReliefLayout::Rows ? rowsField(grid, levels) : quincunxField(grid, levels);
}

Grid reliefPicture(const SurfaceField& field, ReliefLayout layout) {
    if (layout == ReliefLayout::Quincunx) return quincunxPicture(field);
    const Patch& patch = field.patch;
    const auto rows = static_cast<std::size_t>(patch.lastRow() + 1);
    return {rows, patch.size() / rows, static_cast<std::size_t>(field.channels), field.values};
}

Grid withoutPadding(Grid picture, const Grid& grid, int level) {
    const auto sizeOf = [&](std::size_t count) { return ((count - 1) >> level) + 1; };
    const std::size_t rows = std::min(picture.rows, sizeOf(grid.rows)),
                      columns = std::min(picture.columns, sizeOf(grid.columns));
    if (rows == picture.rows && columns == picture.columns) return picture;
    Grid cut{rows, columns, picture.channels, {}};
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t column = 0; column < columns; ++column)
            for (std::size_t c = 0; c < picture.channels; ++c) cut.values.push_back(picture.at(r, column, c));
    return cut;
}

SurfaceField detailField(const SurfaceLevels& levels, int level) {
    assert(level >= 0 && level < levels.levels());
    SurfaceField field{levels.patch(level), 1, {}};
    field.values.assign(field.patch.size(), 0.0);
    const auto& details = levels.details[static_cast<std::size_t>(level)];
    const auto channels = static_cast<std::size_t>(levels.coarse.channels);
    std::size_t next = 0;
    for (const Node node : field.patch.edgeNodes()) {
        double sum = 0;
        for (std::size_t c = 0; c < channels; ++c, ++next) sum += details[next] * details[next];
        field.values[field.patch.index(node)] = std::sqrt(sum);
    }
    return field;
}

Grid shaded(const Grid& heights, double slope) {
    Grid light{heights.rows, heights.columns, 1, std::vector<double>(heights.rows * heights.columns)};
    const auto height = [&](std::size_t r, std::size_t c) { return heights.at(r, c) / slope; };
    for (std::size_t r = 0; r < heights.rows; ++r) {
        for (std::size_t c = 0; c < heights.columns; ++c) {
            const std::size_t up = r > 0 ? r - 1 : r, down = std::min(r + 1, heights.rows - 1);
            const std::size_t left = c > 0 ? c - 1 : c, right = std::min(c + 1, heights.columns - 1);
            const double dx = (height(r, right) - height(r, left)) / static_cast<double>(right - left);
            const double dy = (height(down, c) - height(up, c)) / static_cast<double>(down - up);
            // normal (-dx, -dy, 1), light from (-1, -1, 1.4)
            const double dot =
                (dx + dy + 1.4) / (std::sqrt(dx * dx + dy * dy + 1) * std::sqrt(1 + 1 + 1.4 * 1.4));
            light.values[r * light.columns + c] = std::isnan(dot) ? dot : std::max(0.0, dot);
        }
    }
    return light;
}

}  // namespace isowave::subdivision
