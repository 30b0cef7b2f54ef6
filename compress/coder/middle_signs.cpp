#include "compress/coder/middle_signs.h"

#include <algorithm>
#include <bit>

namespace isowave::compress {
namespace {

// A pattern has bit x + 2y + 4z for corner (x, y, z) of a cell.

// Are the corners of a set joined by edges of the cell?
bool joined(unsigned corners) {
    unsigned reached = corners & (~corners + 1), before = 0;
    while (reached != before) {
        before = reached;
        for (unsigned c = 0; c < 8; ++c)
            if (before >> c & 1)
                for (const unsigned axis : {1u, 2u, 4u}) reached |= (1u << (c ^ axis)) & corners;
    }
    return reached == corners;
}

// The low face of an axis: are its corners of both signs, each sign on a diagonal?
bool ambiguousFace(unsigned pattern, int axis) {
    const unsigned a = 1u << (axis + 1) % 3, b = 1u << (axis + 2) % 3;
    const auto at = [&](unsigned corner) { return pattern >> corner & 1; };
    return at(0) == at(a | b) && at(a) == at(b) && at(0) != at(a);
}

// Weights of the control points -1 .. 2 around a place, on one axis.
std::array<double, 4> weightsOf(bool half) {
    if (half) return {1 / 48.0, 23 / 48.0, 23 / 48.0, 1 / 48.0};
    return {1 / 6.0, 4 / 6.0, 1 / 6.0, 0};
}

}  // namespace

MiddleSigns::MiddleSigns(const Lattice& lattice, const Flags& inside, const std::vector<float>& c)
    : lattice_(lattice), inside_(inside) {
    for (int x = 0; x + 1 < lattice.size[0]; ++x)
        for (int y = 0; y + 1 < lattice.size[1]; ++y)
            for (std::size_t i = lattice.rowStart[lattice.rowOf(x, y)];
                 i < lattice.rowStart[lattice.rowOf(x, y) + 1]; ++i)
                addPlacesOf(x, y, lattice.z[i], c);
}

// The point's number, or pointCount() where it is not known.
std::size_t MiddleSigns::pointAt(int x, int y, int z) const {
    if (x < 0 || y < 0 || x >= lattice_.size[0] || y >= lattice_.size[1]) return lattice_.pointCount();
    const std::size_t row = lattice_.rowOf(x, y);
    const auto begin = lattice_.z.begin() + static_cast<std::ptrdiff_t>(lattice_.rowStart[row]),
               end = lattice_.z.begin() + static_cast<std::ptrdiff_t>(lattice_.rowStart[row + 1]);
    const auto found = std::lower_bound(begin, end, z);
    return found == end || *found != z ? lattice_.pointCount()
                                       : static_cast<std::size_t>(found - lattice_.z.begin());
}

void MiddleSigns::addPlacesOf(int x, int y, int z, const std::vector<float>& c) {
    unsigned pattern = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const std::size_t point =
            pointAt(x + static_cast<int>(corner & 1), y + static_cast<int>(corner >> 1 & 1),
                    z + static_cast<int>(corner >> 2));
        if (point == lattice_.pointCount())
            return;  // a cell that the surface passes has all its corners known
        pattern |= static_cast<unsigned>(inside_[point] != 0) << corner;
    }
    if (pattern == 0 || pattern == 255) return;
    for (int axis = 0; axis < 3; ++axis)
        if (ambiguousFace(pattern, axis)) add({x, y, z}, {axis != 0, axis != 1, axis != 2}, c);
    if (!joined(pattern) || !joined(pattern ^ 255u)) add({x, y, z}, {true, true, true}, c);
}

void MiddleSigns::add(const std::array<int, 3>& low, const std::array<bool, 3>& half,
                      const std::vector<float>& c) {
    Place place{low, half, false};
    place.inside = valueAt(place, c) < 0;
    places_.push_back(place);
}

std::vector<std::size_t> MiddleSigns::cornersOf(const Place& place) const {
    std::vector<std::size_t> corners;
    for (int x = 0; x <= place.half[0]; ++x)
        for (int y = 0; y <= place.half[1]; ++y)
            for (int z = 0; z <= place.half[2]; ++z)
                corners.push_back(pointAt(place.low[0] + x, place.low[1] + y, place.low[2] + z));
    return corners;
}

double MiddleSigns::valueAt(const Place& place, const std::vector<float>& c) const {
    const auto wx = weightsOf(place.half[0]), wy = weightsOf(place.half[1]), wz = weightsOf(place.half[2]);
    double sum = 0;
    for (int x = 0; x < 4; ++x)
        for (int y = 0; y < 4; ++y)
            for (int z = 0; z < 4; ++z) {
                const double w = wx[static_cast<std::size_t>(x)] * wy[static_cast<std::size_t>(y)] *
                                 wz[static_cast<std::size_t>(z)];
                const std::size_t point =
                    w == 0 ? c.size()
                           : pointAt(place.low[0] + x - 1, place.low[1] + y - 1, place.low[2] + z - 1);
                if (point < c.size()) sum += w * static_cast<double>(c[point]);
            }
    return sum;
}

}  // namespace isowave::compress
