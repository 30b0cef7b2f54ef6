// Places thinned out: one in each cell of a grid.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <cstddef>
#include <vector>

#include "volume/vdb.h"

namespace isowave {

// Of the items in each cell of edge `size` (a number, or one for each axis) the one with the least key; of equal ones
// the first. In the order of cells. placeOf(item) -> Vec3d, keyOf(item) -> double.
template <class Item, class Size, class PlaceOf, class KeyOf>
std::vector<Item> onePerCell(const std::vector<Item>& items, const Size& size, const PlaceOf& placeOf,
                             const KeyOf& keyOf) {
    struct Entry {
        openvdb::Coord cell;
        double key;
        std::size_t item;
    };
    std::vector<Entry> entries(items.size());
    tbb::parallel_for(std::size_t(0), items.size(), [&](std::size_t i) {
        entries[i] = {openvdb::Coord::floor(openvdb::Vec3d(placeOf(items[i])) / size), keyOf(items[i]), i};
    });
    tbb::parallel_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
        if (a.cell != b.cell) return a.cell < b.cell;
        if (a.key != b.key) return a.key < b.key;
        return a.item < b.item;
    });
    std::vector<Item> kept;
    for (std::size_t i = 0; i < entries.size(); ++i)
        if (i == 0 || entries[i].cell != entries[i - 1].cell) kept.push_back(items[entries[i].item]);
    return kept;
}

}  // namespace isowave
