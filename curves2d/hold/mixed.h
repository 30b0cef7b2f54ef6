// A fixed shuffle of 64-bit numbers: keys for hash maps, orders that are random and always the same.
#pragma once

#include <cstdint>

namespace isowave::curves2d {

// One to one: splitmix64's finalizer (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014).
constexpr std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

}  // namespace isowave::curves2d
