// Bitmaps of every kind that the claims are tested on.
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "curves2d/fit.h"

namespace isowave::curves2d::shapes {

template <class Inside>
Shape bitmap(std::int32_t width, std::int32_t height, const Inside& inside) {
    Shape shape;
    shape.inside.rows.resize(static_cast<std::size_t>(height));
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < width; ++x)
            if (inside(x, y)) shape.inside.rows[static_cast<std::size_t>(y)].push_back({x, x});
    for (Spans& row : shape.inside.rows) normalise(row);
    return shape;
}

inline Shape noise(std::int32_t width, std::int32_t height, double share, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    return bitmap(width, height, [&](int, int) { return uniform(random) < share; });
}

// Sums of random bumps, cut at zero: islands in lakes in islands.
inline Shape blobs(std::int32_t size, int count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    struct Bump {
        double x, y, r, height;
    };
    std::vector<Bump> bumps;
    for (int i = 0; i < count; ++i)
        bumps.push_back({uniform(random) * size, uniform(random) * size,
                         (0.02 + 0.15 * uniform(random)) * size, uniform(random) - 0.45});
    return bitmap(size, size, [&](int x, int y) {
        double sum = 0;
        for (const Bump& b : bumps)
            sum += b.height * std::exp(-(std::pow(x - b.x, 2) + std::pow(y - b.y, 2)) / (b.r * b.r));
        return sum > 0.02;
    });
}

inline Shape disc(double radius) {
    const int size = static_cast<int>(2 * radius) + 5;
    const double middle = (size - 1) / 2.0 + 0.123;
    return bitmap(size, size, [&](int x, int y) { return std::hypot(x - middle, y - middle) < radius; });
}

// Rings in rings: outer, hole, island in the hole, hole in the island ...
inline Shape target(int rings) {
    const int size = 16 * rings + 4;
    return bitmap(size, size, [&](int x, int y) {
        return static_cast<int>(std::hypot(x - size / 2.0, y - size / 2.0) / 4) % 2 == 0 &&
               std::hypot(x - size / 2.0, y - size / 2.0) < 8 * rings;
    });
}

inline std::vector<std::pair<std::string, Shape>> all() {
    std::vector<std::pair<std::string, Shape>> zoo;
    zoo.emplace_back("one pixel", bitmap(1, 1, [](int, int) { return true; }));
    zoo.emplace_back("full", bitmap(9, 14, [](int, int) { return true; }));
    zoo.emplace_back("border-touching", bitmap(40, 30, [](int x, int y) { return x < 5 || y > 25; }));
    zoo.emplace_back("1-pixel line", bitmap(60, 3, [](int, int y) { return y == 1; }));
    zoo.emplace_back("1-pixel diagonal", bitmap(30, 30, [](int x, int y) { return x == y; }));
    zoo.emplace_back("1-pixel slit", bitmap(40, 40, [](int x, int y) {
                         return x > 4 && x < 35 && y > 4 && y < 35 && y != 20;
                     }));
    zoo.emplace_back("checkerboard", bitmap(24, 24, [](int x, int y) { return (x + y) % 2 == 0; }));
    zoo.emplace_back("coarse checkerboard",
                     bitmap(40, 40, [](int x, int y) { return (x / 5 + y / 5) % 2 == 0; }));
    zoo.emplace_back("disc", disc(17.3));
    zoo.emplace_back("target", target(5));
    for (unsigned seed = 1; seed <= 4; ++seed) {
        zoo.emplace_back("noise 10 % " + std::to_string(seed), noise(50, 37, 0.1, seed));
        zoo.emplace_back("noise 50 % " + std::to_string(seed), noise(45, 64, 0.5, seed));
        zoo.emplace_back("noise 90 % " + std::to_string(seed), noise(33, 33, 0.9, seed));
        zoo.emplace_back("blobs " + std::to_string(seed), blobs(150, 60, seed));
    }
    return zoo;
}

}  // namespace isowave::curves2d::shapes
