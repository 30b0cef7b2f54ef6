#include "volume/distance/crossings.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "volume/distance.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using Values = std::array<float, 512>;
using Truth = std::function<double(const Vec3d&)>;  // negative inside, in voxels

// Samples that fall linearly across the surface, at most `ramp` voxels on either side.
void fill(LeafSamples& samples, const Truth& truth, double ramp) {
    for (int i = -5; i <= 12; ++i)
        for (int j = -5; j <= 12; ++j)
            for (int k = -5; k <= 12; ++k) {
                const double d = std::clamp(truth(Vec3d(i, j, k)), -ramp, ramp);
                samples.at(i, j, k) = d == 0 ? -1e-30f : static_cast<float>(-57 * d);
            }
}

Vec3d randomUnit(std::mt19937& random) {
    std::normal_distribution<double> normal;
    return Vec3d(normal(random), normal(random), normal(random)).unit();
}

// Planes at any tilt: not only nearly, and along axes and diagonals too.
TEST(CrossingDistances, AreExactForPlanes) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> offset(-6, 6);
    CrossingDistances distances;
    LeafSamples samples;
    double worst = 0;
    for (int round = 0; round < 200; ++round) {
        Vec3d normal = randomUnit(random);
        if (round % 4 == 1) normal[round % 3] = 0;
        if (round % 4 == 2) normal = Vec3d(round & 8 ? 1 : 0, round & 16 ? -1 : 0, 1);
        if (round % 20 == 3) normal = Vec3d(1, 1, 1);
        normal.normalize();
        const double at = normal.dot(Vec3d(3.5)) + offset(random);
        const auto truth = [&](const Vec3d& p) { return normal.dot(p) - at; };
        fill(samples, truth, 100);
        Values values;
        values.fill(9);
        if (!distances.compute(samples, 4, values.data())) {
            for (int n = 0; n < 512; ++n) ASSERT_GT(std::abs(truth(Vec3d(n >> 6, n >> 3 & 7, n & 7))), 3.99);
            continue;
        }
        for (int n = 0; n < 512; ++n) {
            const double expected = std::clamp(truth(Vec3d(n >> 6, n >> 3 & 7, n & 7)), -4.0, 4.0);
            // Beyond 3.9 the crossing that is nearest may lie out of reach.
            if (std::abs(expected) < 3.9)
                worst = std::max(worst, std::abs(values[std::size_t(n)] - expected));
            ASSERT_EQ(std::signbit(values[std::size_t(n)]), expected < 0) << round << ' ' << n;
        }
    }
    EXPECT_LT(worst, 2e-6);  // seen 5.6e-7
}

// 8-bit grey: rms at most a hundredth of a voxel.
TEST(CrossingDistances, OfASphereInEightBitsAreAHundredthOfAVoxelOff) {
    Image image;
    image.size = {56, 56, 56};
    const auto truth = [](const Vec3d& p) { return (p - Vec3d(27.7, 27.4, 27.9)).length() - 20; };
    for (int z = 0; z < 56; ++z)
        for (int y = 0; y < 56; ++y)
            for (int x = 0; x < 56; ++x)
                image.values.push_back(static_cast<float>(
                    std::round(127.5 - 42.5 * std::clamp(truth(Vec3d(x, y, z)), -3.0, 3.0))));
    const auto distance = distanceFromImage(image, {.iso = 127.5}, 4);
    double sum = 0, worst = 0;
    for (auto value = distance->cbeginValueOn(); value; ++value) {
        const double error = *value - truth(value.getCoord().asVec3d());
        sum += error * error;
        worst = std::max(worst, std::abs(error));
    }
    EXPECT_LT(std::sqrt(sum / double(distance->activeVoxelCount())),
              0.008);        // seen 0.0060; fast sweeping 0.076
    EXPECT_LT(worst, 0.04);  // seen 0.03; fast sweeping 0.42
}

// What is beyond the kernel's reach is carried on from there.
TEST(DistanceFromImage, GoesAsFarAsItIsAsked) {
    Image image;
    image.size = {60, 60, 60};
    const auto truth = [](const Vec3d& p) { return (p - Vec3d(29.7, 29.4, 29.9)).length() - 16; };
    for (int z = 0; z < 60; ++z)
        for (int y = 0; y < 60; ++y)
            for (int x = 0; x < 60; ++x) image.values.push_back(static_cast<float>(-truth(Vec3d(x, y, z))));
    const auto distance = distanceFromImage(image, {.iso = 0}, 9.5);
    EXPECT_EQ(distance->background(), 9.5f);
    double worst = 0;
    for (int n = 0; n < 60 * 60 * 60; n += 7) {
        const Coord c(n % 60, n / 60 % 60, n / 3600);
        const double expected = std::clamp(truth(c.asVec3d()), -9.5, 9.5);
        const float value = distance->tree().getValue(c);
        worst = std::max(worst, std::abs(value - expected));
        ASSERT_EQ(distance->tree().isValueOn(c), std::abs(value) < 9.5f) << c;
    }
    EXPECT_LT(worst, 0.4);  // seen 0.30
}

// Random samples of random signs, and a few that agree: whatever the vectors.
TEST(CrossingDistances, AreTheSameWithEveryVector) {
    std::mt19937 random(2);
    std::normal_distribution<float> normal;
    CrossingDistances narrow(Vectors::two), widest;
    LeafSamples samples;
    for (int round = 0; round < 100; ++round) {
        const Vec3d n = randomUnit(random);
        const float noise = 0.5f * static_cast<float>(round % 5);
        fill(
            samples, [&](const Vec3d& p) { return n.dot(p - Vec3d(3)) + noise * normal(random); },
            round % 3 ? 100 : 0.2);
        Values a{}, b{};
        ASSERT_EQ(narrow.compute(samples, 4, a.data()), widest.compute(samples, 4, b.data()));
        for (std::size_t i = 0; i < 512; ++i) ASSERT_EQ(a[i], b[i]) << round << ' ' << i;
    }
}

// Grey that jumps within half a voxel.
TEST(CrossingDistances, BesideHardEdgesAreAveragedOverTheEdgesThatCross) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> offset(-2, 2);
    CrossingDistances distances;
    LeafSamples samples;
    double sum = 0;
    int count = 0;
    for (int round = 0; round < 200; ++round) {
        const Vec3d normal = randomUnit(random);
        const double at = normal.dot(Vec3d(3.5)) + offset(random);
        const auto truth = [&](const Vec3d& p) { return normal.dot(p) - at; };
        fill(samples, truth, 0.25);
        Values values;
        ASSERT_TRUE(distances.compute(samples, 4, values.data()));
        for (std::size_t n = 0; n < 512; ++n) {
            const double expected = truth(Vec3d(int(n) >> 6, int(n) >> 3 & 7, int(n) & 7));
            EXPECT_EQ(values[n] < 0, expected < 0);
            if (std::abs(expected) > 0.7) continue;
            sum += (values[n] - expected) * (values[n] - expected);
            ++count;
        }
    }
    EXPECT_LT(std::sqrt(sum / count), 0.1);  // seen 0.088; by the nearest crossing alone 0.14
}

TEST(DistanceFromImage, DependsOnNoThread) {
    Image image;
    image.size = {70, 50, 60};
    std::mt19937 random(5);
    for (int n = 0; n < 70 * 50 * 60; ++n) {
        const Vec3d p(n % 70 - 33.3, n / 70 % 50 - 24.1, n / 3500 - 29.7);
        image.values.push_back(static_cast<float>(100 - 20 * (p.length() - 18) + double(random() % 60)));
    }
    const auto with = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return distanceFromImage(image, {.iso = 130}, 4);
    };
    const auto one = with(1);
    for (const std::size_t threads : {2, 4}) {
        const auto other = with(threads);
        EXPECT_TRUE(one->tree().hasSameTopology(other->tree()));
        for (auto value = one->cbeginValueAll(); value; ++value)
            ASSERT_EQ(*value, other->tree().getValue(value.getCoord()));
    }
}

}  // namespace
}  // namespace isowave
