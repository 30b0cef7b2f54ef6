// Signs of F in the middle of faces and cells of the lattice, where the signs of the corners leave open how they are joined.
//
// A mesh of the zero set asks there (polygonize/cell_table.h): of a face whose opposite corners agree and whose neighbouring ones
// do not; of a cell whose corners of one sign are not all joined by edges. With these signs and those of the lattice
// points kept, it has the same triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "compress/coder/lattice_values.h"

namespace isowave::compress {

class MiddleSigns {
  public:
    // Where to look, and the signs that F of c has there.
    MiddleSigns(const Lattice& lattice, const Flags& inside, const std::vector<float>& c);

    std::size_t count() const { return places_.size(); }
    // move(point, s), s = -1 or 1, for the corners of the wanted sign s around each place where s F of c is below `margin`.
    // Returns whether there is one.
    template <class Move>
    bool forEachWrong(const std::vector<float>& c, double margin, const Move& move) const {
        bool any = false;
        for (const Place& place : places_) {
            const int s = place.inside ? -1 : 1;
            if (s * valueAt(place, c) >= margin) continue;
            any = true;
            for (const std::size_t point : cornersOf(place))
                if ((inside_[point] != 0) == place.inside) move(point, s);
        }
        return any;
    }

  private:
    struct Place {
        std::array<int, 3> low;    // of its corners
        std::array<bool, 3> half;  // on which axes it lies between two points
        bool inside;
    };
    std::size_t pointAt(int x, int y, int z) const;
    std::vector<std::size_t> cornersOf(const Place& place) const;
    double valueAt(const Place& place, const std::vector<float>& c) const;
    void addPlacesOf(int x, int y, int z, const std::vector<float>& c);
    void add(const std::array<int, 3>& low, const std::array<bool, 3>& half, const std::vector<float>& c);

    const Lattice& lattice_;
    const Flags& inside_;
    std::vector<Place> places_;
};

}  // namespace isowave::compress
