// Disjoint sets of numbers (Tarjan 1975), with path halving; a set is called by its smallest member.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace isowave {

class DisjointSets {
  public:
    // Of one member each.
    explicit DisjointSets(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), 0u);
    }

    std::uint32_t of(std::uint32_t p) {
        while (parent_[p] != p) p = parent_[p] = parent_[parent_[p]];
        return p;
    }
    void join(std::uint32_t p, std::uint32_t q) {
        p = of(p), q = of(q);
        parent_[std::max(p, q)] = std::min(p, q);
    }

  private:
    std::vector<std::uint32_t> parent_;
};

}  // namespace isowave
