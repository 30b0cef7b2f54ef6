// Small solids in memory, and short ways to their ladders.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "isowave/isowave.h"
#include "tests/tools/inputs.h"

namespace isowave::lod_test {

using tools_test::Size;

// f at every voxel, stored as int16; lattice axes along the world's.
template <class F>
Image imageOf(Size size, const F& f, double spacing = 1) {
    Image image;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        image.size[axis] = size[axis];
        image.indexToWorld.axis[axis][axis] = spacing;
    }
    for (const std::int16_t value : tools_test::sampled<std::int16_t>(size, f)) image.values.push_back(value);
    image.componentType = "int16";
    image.integral = true;
    image.format = "a test";
    return image;
}

// A grey image of a signed distance, 20 HU a voxel, of spacing 0.5 mm.
template <class Distance>
Image distanceImage(Size size, const Distance& distance) {
    const auto grey = [&](int x, int y, int z) {
        return std::lround(std::clamp(-20.0 * distance(x, y, z), -200.0, 200.0));
    };
    return imageOf(size, grey, 0.5);
}

// A ball of radius r in the middle: 100 inside, -100 outside, a ramp of 8 voxels between.
inline Image ballImage(Size size, double r, double spacing = 1) {
    const auto values = tools_test::greyBall(size, r);
    return imageOf(
        size,
        [&](int x, int y, int z) {
            return values[static_cast<std::size_t>(x + size[0] * (y + size[1] * z))];
        },
        spacing);
}

// A ring about the z axis, counter-clockwise from outside; genus 1.
inline TriangleMesh ringMesh(double R = 20, double r = 8) {
    const tools_test::SmallMesh small = tools_test::torus(R, r);
    TriangleMesh mesh;
    mesh.points.assign(small.points.begin(), small.points.end());
    for (const auto& [a, b, c] : small.triangles)
        mesh.triangles.push_back(
            {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)});
    return mesh;
}

inline std::vector<LevelReport> reportsOf(const Ladder& ladder) {
    std::vector<LevelReport> reports;
    for (const Level& level : ladder.levels) reports.push_back(level.report);
    return reports;
}

inline std::vector<LevelReport> levelsOf(Solid solid, const LevelOptions& options = {},
                                         const Progress& progress = {}) {
    return reportsOf(makeLadder(std::move(solid), options, {}, progress));
}

// Keeps the remarks of a job.
struct Remarks {
    std::string text;
    Progress progress() {
        Progress result;
        result.remark = [this](std::string_view line) { text += std::string(line) + "\n"; };
        return result;
    }
};

inline void expectSound(const MeshTopology& topology, const std::string& what = {}) {
    EXPECT_TRUE(topology.closed()) << what;
    EXPECT_TRUE(topology.manifold()) << what;
}

}  // namespace isowave::lod_test
