// Which points of a box of the lattice are known, as bits and as rows.
//
// Raster order: x slowest, z fastest. A row is all points of one (x, y). Positions are relative to the box's low corner.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace isowave::compress {

using Size = std::array<int, 3>;

// One bit for each point of a box. A row is a whole number of 64-bit words; bits past its end are 0.
class BitBox {
  public:
    explicit BitBox(const Size& size);

    const Size& size() const { return size_; }
    std::size_t words() const { return words_; }
    std::uint64_t* row(int x, int y) { return bits_.data() + at(x, y); }
    const std::uint64_t* row(int x, int y) const { return bits_.data() + at(x, y); }
    bool get(int x, int y, int z) const { return row(x, y)[z / 64] >> (z % 64) & 1; }
    void set(int x, int y, int z) { row(x, y)[z / 64] |= std::uint64_t{1} << (z % 64); }
    std::size_t count() const;  // of points that are set
    bool operator==(const BitBox&) const = default;

  private:
    std::size_t at(int x, int y) const {
        return (static_cast<std::size_t>(x) * static_cast<std::size_t>(size_[1]) +
                static_cast<std::size_t>(y)) *
               words_;
    }
    Size size_;
    std::size_t words_;
    std::vector<std::uint64_t> bits_;
};

// Node i has the 64 control points i .. i + 3 on each axis (positions in boxes, whose low corners coincide). A box of
// control points has 3 more points on each axis than that of its nodes.
BitBox nodesOf(const BitBox& known);   // the nodes all of whose control points are known
BitBox pointsOf(const BitBox& nodes);  // the control points of nodes

// The known points, row by row.
struct Lattice {
    Size size{};
    std::vector<std::size_t> rowStart;  // size[0] * size[1] + 1: the first point of each row
    std::vector<std::int32_t> z;        // of each point

    Lattice() = default;
    explicit Lattice(const BitBox& known);
    std::size_t pointCount() const { return z.size(); }
    std::size_t rowOf(int x, int y) const {
        return static_cast<std::size_t>(x) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(y);
    }
    // Points of planes begin .. end - 1 are firstOf(begin) .. firstOf(end) - 1.
    std::size_t firstOf(int x) const { return rowStart[rowOf(x, 0)]; }
};

}  // namespace isowave::compress
