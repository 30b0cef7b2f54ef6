// The last planes of a lattice that is walked in raster order, with a value at every point: what a coder of the next point
// may look at.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "compress/coder/lattice.h"

namespace isowave::compress {

// An offset to an earlier point: x -2 .. 0, y and z -3 .. 1.
struct Back {
    int x, y, z;
};

// Cell: what is kept of a point; copied freely.
template <class Cell>
class Window {
  public:
    // outside: what stands where nothing is known.
    Window(const Size& size, const Cell& outside)
        : stride_(static_cast<std::ptrdiff_t>(size[2]) + kLow + kHigh),
          plane_(stride_ * (static_cast<std::ptrdiff_t>(size[1]) + kLow + kHigh)),
          outside_(outside),
          cells_(3 * static_cast<std::size_t>(plane_), outside) {}

    void beginPlane(int x) {
        for (int back = 0; back < 3; ++back)
            base_[static_cast<std::size_t>(back)] = (x + 3 - back) % 3 * plane_;
        std::fill_n(cells_.begin() + base_[0], plane_, outside_);
    }
    void moveTo(int y, int z) { here_ = (y + kLow) * stride_ + z + kLow; }
    Cell& here() { return cells_[static_cast<std::size_t>(base_[0] + here_)]; }
    const Cell& at(const Back& o) const {
        return cells_[static_cast<std::size_t>(base_[static_cast<std::size_t>(-o.x)] + here_ + o.y * stride_ +
                                               o.z)];
    }
    // The points begin .. end - 1 of row y.
    void fill(int y, int begin, int end, const Cell& cell) {
        const auto row = cells_.begin() + base_[0] + (y + kLow) * stride_ + kLow;
        std::fill(row + begin, row + end, cell);
    }

  private:
    static constexpr std::ptrdiff_t kLow = 3, kHigh = 1;
    std::ptrdiff_t stride_, plane_, here_ = 0;
    std::array<std::ptrdiff_t, 3> base_{};
    Cell outside_;
    std::vector<Cell> cells_;
};

// Visits the points of planes begin .. end - 1: visit(point) has the window at the point and returns the cell that fills the gap
// after it, should there be one. A gap is a run of unknown points of a row between two known ones; it has the sign of the
// point before it, because an edge whose ends have two signs belongs to a node, whose control points are all known.
template <class Cell, class Visit>
void walk(const Lattice& lattice, int begin, int end, Window<Cell>& window, const Visit& visit) {
    for (int x = begin; x < end; ++x) {
        window.beginPlane(x);
        for (int y = 0; y < lattice.size[1]; ++y) {
            const std::size_t row = lattice.rowOf(x, y), last = lattice.rowStart[row + 1];
            for (std::size_t i = lattice.rowStart[row]; i < last; ++i) {
                window.moveTo(y, lattice.z[i]);
                const Cell gap = visit(i);
                if (i + 1 < last && lattice.z[i + 1] > lattice.z[i] + 1)
                    window.fill(y, lattice.z[i] + 1, lattice.z[i + 1], gap);
            }
        }
    }
}

}  // namespace isowave::compress
