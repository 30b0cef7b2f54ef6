// The promises of compress/coder: every coder gives back what went in, whatever that was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <stdexcept>

#include "compress/coder/bounded.h"
#include "compress/coder/float_coder.h"
#include "compress/coder/index_coder.h"
#include "compress/coder/mask_coder.h"
#include "compress/coder/match_model.h"
#include "compress/coder/mixer.h"

namespace isowave::compress {
namespace {

using Random = std::mt19937;

struct Bit {
    bool bit;
    Probability one;
};

// Of every kind that a range coder may stumble over: carries, certain bits that fail, long runs.
std::vector<Bit> bits(int kind, std::size_t count) {
    Random random(static_cast<unsigned>(kind));
    std::vector<Bit> all;
    for (std::size_t i = 0; i < count; ++i) switch (kind) {
            case 0:
                all.push_back({(random() & 1) != 0, static_cast<Probability>(1 + random() % 65535)});
                break;
            case 1:
                all.push_back({true, 1});  // each costs 16 bits
                break;
            case 2:
                all.push_back({false, 65535});
                break;
            case 3:
                all.push_back({i % 1000 == 999, 6});
                break;
            default:
                all.push_back({i % 2 == 0, i % 3 == 0 ? 65535u : 1u});
        }
    return all;
}

TEST(RangeCoder, GivesBackEveryBit) {
    for (int kind = 0; kind < 5; ++kind) {
        const std::vector<Bit> all = bits(kind, 20000);
        RangeCoder encoder;
        for (const Bit& b : all) encoder.code(b.bit, b.one);
        const std::string bytes = encoder.finish();
        RangeCoder decoder(bytes);
        for (std::size_t i = 0; i < all.size(); ++i)
            ASSERT_EQ(decoder.code(false, all[i].one), all[i].bit) << kind << ' ' << i;
        EXPECT_TRUE(decoder.atEnd()) << kind;
    }
}

// 10,000 bits at p = 1/16 have an entropy of 0.3373 bits each.
TEST(RangeCoder, ComesWithinAPercentOfTheEntropy) {
    Random random(1);
    RangeCoder encoder;
    for (int i = 0; i < 100000; ++i) encoder.code(random() % 16 == 0, 4096);
    const double seen = 8.0 * static_cast<double>(encoder.finish().size()) / 100000;
    EXPECT_NEAR(seen, 0.3373, 0.005);
}

TEST(RangeCoder, GivesBackRawNumbersOfAnyLength) {
    RangeCoder encoder;
    for (int length = 0; length <= 32; ++length) encoder.raw(0xDEADBEEF, length);
    const std::string bytes = encoder.finish();
    RangeCoder decoder(bytes);
    for (int length = 0; length <= 32; ++length)
        EXPECT_EQ(decoder.raw(0, length), length == 32 ? 0xDEADBEEF : 0xDEADBEEF & ((1u << length) - 1))
            << length;
    EXPECT_TRUE(decoder.atEnd());
}

TEST(RangeCoder, KeepsRawBitsApartFromOthers) {
    Random random(3);
    std::vector<std::uint32_t> numbers(1000);
    for (std::uint32_t& n : numbers) n = static_cast<std::uint32_t>(random());
    RangeCoder encoder;
    for (const std::uint32_t n : numbers) {
        encoder.code(n % 3 == 0, 20000);
        encoder.raw(n, static_cast<int>(n % 33));
    }
    const std::string bytes = encoder.finish();
    RangeCoder decoder(bytes);
    for (const std::uint32_t n : numbers) {
        ASSERT_EQ(decoder.code(false, 20000), n % 3 == 0);
        ASSERT_EQ(decoder.raw(0, static_cast<int>(n % 33)), n & ((std::uint64_t{1} << n % 33) - 1));
    }
    EXPECT_TRUE(decoder.atEnd());
    EXPECT_THROW(RangeCoder("ab"), std::runtime_error);
    EXPECT_THROW(RangeCoder(std::string_view("\x09\0\0\0abc", 7)), std::runtime_error);
}

TEST(Logistic, StretchIsTheInverseOfSquash) {
    const Logistic& l = Logistic::tables();
    for (std::uint32_t p = 1; p < 4096; ++p) {
        const double exact = 256 * std::log((p + 0.5) / (4095.5 - p));
        if (std::abs(exact) < 2200) {
            EXPECT_NEAR(l.stretch(p, 4), exact, 5) << p;
        }  // 5 / 256 of a nat
    }
    EXPECT_EQ(l.squash(0), 32768u);
    EXPECT_NEAR(l.squash(256), 65536 / (1 + std::exp(-1.0)), 1);
}

// Two models, one of which knows: the mixer has to find out which.
TEST(Mixer, TrustsTheModelThatKnows) {
    Random random(5);
    std::vector<Counter> knows(2), noise(64);
    Mixer<2> mixer(1);
    RangeCoder encoder;
    for (int i = 0; i < 20000; ++i) {
        const bool bit = random() & 1;
        mixer.code(encoder, {&knows[bit], &noise[random() % 64]}, 0, bit);
    }
    EXPECT_LT(encoder.finish().size(), 100u);  // seen: 38 bytes, of 2500
}

// Both ends of the text are the same 40 symbols; one fewer is not enough.
TEST(MatchModel, AsksForAllTheSymbolsThatItWants) {
    Random random(7);
    std::vector<int> text(40);
    for (int& s : text) s = static_cast<int>(random() % 2);
    MatchModel match(40);
    for (const int s : text) match.add(s);
    for (int i = 0; i < 500; ++i) match.add(static_cast<int>(random() % 2));
    for (std::size_t i = 0; i + 1 < text.size(); ++i) match.add(text[i]);
    EXPECT_EQ(match.length(), 0);
    match.add(text.back());
    EXPECT_EQ(match.length(), 40);
}

TEST(MatchModel, PredictsTheSecondOccurrenceAndNeverItself) {
    MatchModel match(3);
    const std::vector<int> text{1, 2, 3, 4, 5, 6, 7};
    for (const int s : text) {
        EXPECT_FALSE(match.predicted().has_value());
        match.add(s);
    }
    for (const int s : {1, 2, 3}) match.add(s);
    for (const int s : {4, 5, 6}) {
        ASSERT_TRUE(match.predicted().has_value());
        EXPECT_EQ(*match.predicted(), s);
        match.add(s);
    }
    match.add(99);
    EXPECT_FALSE(match.predicted().has_value());
}

BitBox randomNodes(const Size& size, int oneIn, unsigned seed) {
    Random random(seed);
    BitBox nodes(size);
    for (int x = 0; x < size[0]; ++x)
        for (int y = 0; y < size[1]; ++y)
            for (int z = 0; z < size[2]; ++z)
                if (random() % static_cast<unsigned>(oneIn) == 0) nodes.set(x, y, z);
    return nodes;
}

// Nodes of a shell, as those of a solid are.
BitBox shell(int n) {
    BitBox nodes({n, n, n});
    for (int x = 0; x < n; ++x)
        for (int y = 0; y < n; ++y)
            for (int z = 0; z < n; ++z)
                if (std::abs(std::hypot(x - n / 2.0, y - n / 2.0, z - n / 2.0) - n / 3.0) < 2)
                    nodes.set(x, y, z);
    return nodes;
}

TEST(MaskCoder, GivesBackRandomFullEmptyAndFlatNodes) {
    for (const Size size : {Size{1, 1, 1}, Size{9, 17, 70}, Size{1, 64, 65}, Size{40, 1, 3}})
        for (const int oneIn : {1, 2, 50, 1000000}) {
            const BitBox nodes = randomNodes(size, oneIn, 3);
            EXPECT_EQ(decodeNodes(encodeNodes(nodes), size), nodes) << size[0] << ' ' << oneIn;
        }
}

TEST(MaskCoder, RefusesBytesThatGoOn) {
    const BitBox nodes = shell(30);
    EXPECT_THROW(decodeNodes(encodeNodes(nodes) + std::string(8, 'x'), nodes.size()), std::runtime_error);
}

// By the definition: a node is there when its 64 points are.
TEST(Lattice, NodesAndTheirPointsAreEachOthersInverse) {
    for (const BitBox& nodes : {shell(24), randomNodes({5, 8, 67}, 20, 1), randomNodes({1, 1, 1}, 1, 1)}) {
        const BitBox points = pointsOf(nodes), again = nodesOf(points);
        std::size_t missing = 0;
        for (int x = 0; x < nodes.size()[0]; ++x)
            for (int y = 0; y < nodes.size()[1]; ++y)
                for (int z = 0; z < nodes.size()[2]; ++z) {
                    bool all = true;
                    for (int k = 0; k < 64; ++k)
                        all = all && points.get(x + k / 16, y + k / 4 % 4, z + k % 4);
                    EXPECT_EQ(again.get(x, y, z), all);
                    missing += nodes.get(x, y, z) && !all;
                }
        EXPECT_EQ(missing, 0u);
        EXPECT_EQ(Lattice(points).pointCount(), points.count());
    }
}

TEST(Quantiser, IsMonotoneAndItsOwnInverse) {
    for (const double delta : {1e-3, 0.05, 0.7, 64.0})
        for (const double reach : {0.5, 5.0, 900.0}) {
            const Quantiser q(delta, reach);
            for (std::int32_t i = -q.most(); i <= q.most(); i += std::max(1, q.most() / 5000)) {
                ASSERT_EQ(q.index(q.value(i)), i) << delta << ' ' << reach;
                ASSERT_EQ(q.value(-i), -q.value(i));
                if (i < q.most()) {
                    ASSERT_LT(q.value(i), q.value(i + 1));
                }
            }
            EXPECT_GE(q.value(q.most()), static_cast<std::int32_t>(reach * kOneVoxel));
            EXPECT_EQ(q.index(std::numeric_limits<std::int32_t>::max()), q.most());
        }
}

// T tan(u / T) where it is not a straight line yet. Seen: 0.3 % at the end, the error of Padé's fraction.
TEST(Quantiser, FollowsTheTangent) {
    const Quantiser q(0.1, 6);
    for (int i = 0; i <= 28; ++i) {
        const double exact = 2.5 * std::tan(i * 0.1 / 2.5);
        EXPECT_NEAR(q.value(i) / 65536.0, exact, 1e-4 + 4e-3 * exact) << i;
    }
}

class Values : public ::testing::Test {
  protected:
    Values() : lattice(pointsOf(shell(24))) {
        Random random(11);
        std::uniform_real_distribution<float> noise(-0.02f, 0.02f);
        for (int x = 0; x < lattice.size[0]; ++x)
            for (int y = 0; y < lattice.size[1]; ++y)
                for (std::size_t i = lattice.rowStart[lattice.rowOf(x, y)];
                     i < lattice.rowStart[lattice.rowOf(x, y) + 1]; ++i)
                    smooth.push_back(
                        static_cast<float>(std::hypot(x - 13.0, y - 13.0, lattice.z[i] - 13.0) - 8) / 4 +
                        noise(random));
    }
    std::vector<std::int32_t> randomIndices(std::int32_t most, unsigned seed) const {
        Random random(seed);
        std::vector<std::int32_t> q(lattice.pointCount());
        for (auto& v : q)
            v = static_cast<std::int32_t>(random() % static_cast<unsigned>(2 * most + 1)) - most;
        return q;
    }
    Lattice lattice;
    std::vector<float> smooth;  // nearly a sphere's distance, K = 1 = 4 voxels
};

TEST_F(Values, IndicesComeBackWhateverTheyAre) {
    for (const double delta : {0.3, 0.001}) {
        const Quantiser quantiser(delta, 6);
        const Weights weights;  // all 0: predicts nothing
        const IndexModel model{lattice, quantiser, weights, quantiser.index(4 * kOneVoxel)};
        for (const std::int32_t most : {std::int32_t{0}, std::int32_t{1}, quantiser.most()}) {
            std::vector<std::int32_t> q = randomIndices(most, 2), back(q.size());
            const std::string bytes = encodeIndices(model, 0, lattice.size[0], q);
            decodeIndices(model, 0, lattice.size[0], bytes, back);
            EXPECT_EQ(back, q) << delta << ' ' << most;
        }
    }
}

TEST_F(Values, ChunksComeBackByThemselvesInAnyOrder) {
    const Quantiser quantiser(0.05, 6);
    const Weights weights;
    const IndexModel model{lattice, quantiser, weights, quantiser.index(4 * kOneVoxel)};
    std::vector<std::int32_t> q = randomIndices(3, 7), back(q.size());
    const std::string low = encodeIndices(model, 0, 10, q),
                      high = encodeIndices(model, 10, lattice.size[0], q);
    decodeIndices(model, 10, lattice.size[0], high, back);
    decodeIndices(model, 0, 10, low, back);
    EXPECT_EQ(back, q);
}

// Bytes of something else are found out or give other values; never a crash or a value out of range.
TEST_F(Values, DecodingRubbishIsHarmless) {
    const Quantiser quantiser(0.05, 6);
    const Weights weights = fitFloatWeights(lattice, smooth, 1);
    const IndexModel model{lattice, quantiser, weights, quantiser.index(4 * kOneVoxel)};
    Random random(3);
    for (int run = 0; run < 10; ++run) {
        std::string rubbish(random() % 3000, '\0');
        for (char& c : rubbish) c = static_cast<char>(random());
        std::vector<std::int32_t> q(lattice.pointCount());
        std::vector<float> c(lattice.pointCount());
        try {
            decodeIndices(model, 0, lattice.size[0], rubbish, q);
        } catch (const std::runtime_error&) {
        }
        for (const std::int32_t v : q) ASSERT_LE(std::abs(v), quantiser.most());
        try {
            decodeFloats({lattice, weights, 1}, 0, lattice.size[0], rubbish, c);
        } catch (const std::runtime_error&) {
        }
    }
}

TEST_F(Values, FloatsComeBackToTheBitWhateverTheyAre) {
    std::vector<std::vector<float>> all{smooth, std::vector<float>(smooth.size(), 1.0f)};
    Random random(9);
    all.emplace_back(smooth.size());
    for (float& v : all.back()) {
        const std::uint32_t bits = static_cast<std::uint32_t>(random());
        std::memcpy(&v, &bits, 4);  // infinities and NaN with any payload among them
    }
    all.push_back(smooth);
    for (std::size_t i = 0; i < smooth.size(); i += 3)
        all.back()[i] = i % 2 ? -0.0f : std::numeric_limits<float>::denorm_min();
    for (std::vector<float>& values : all) {
        const Weights weights = fitFloatWeights(lattice, smooth, 1);
        const FloatModel model{lattice, weights, 1};
        const std::vector<float> before = values;
        const std::string bytes = encodeFloats(model, 0, lattice.size[0], values);
        std::vector<float> back(values.size());
        decodeFloats(model, 0, lattice.size[0], bytes, back);
        EXPECT_EQ(std::memcmp(back.data(), before.data(), 4 * before.size()), 0);
        EXPECT_EQ(std::memcmp(values.data(), before.data(), 4 * before.size()), 0)
            << "the encoder leaves them";
    }
}

// F by its definition, at every point whose neighbours are known.
TEST_F(Values, LatticeValuesAreTheSplines) {
    const std::vector<float> F = latticeValues(lattice, smooth, 1, nullptr);
    const BitBox known = pointsOf(shell(24));
    std::vector<std::vector<std::vector<float>>> c(
        28, std::vector<std::vector<float>>(28, std::vector<float>(28, 0)));
    std::size_t i = 0;
    for (int x = 0; x < 27; ++x)
        for (int y = 0; y < 27; ++y)
            for (int z = 0; z < 27; ++z)
                if (known.get(x, y, z)) c[x][y][z] = smooth[i++];
    i = 0;
    int compared = 0;
    for (int x = 0; x < 27; ++x)
        for (int y = 0; y < 27; ++y)
            for (int z = 0; z < 27; ++z) {
                if (!known.get(x, y, z)) continue;
                double sum = 0;
                bool all = x > 0 && y > 0 && z > 0 && x < 26 && y < 26 && z < 26;
                for (int k = 0; all && k < 27; ++k) {
                    const int dx = k / 9 - 1, dy = k / 3 % 3 - 1, dz = k % 3 - 1;
                    all = known.get(x + dx, y + dy, z + dz);
                    sum += (dx ? 1.0 : 4.0) * (dy ? 1.0 : 4.0) * (dz ? 1.0 : 4.0) *
                           c[x + dx][y + dy][z + dz] / 216;
                }
                if (all) {
                    EXPECT_NEAR(F[i], sum, 1e-6);
                }
                compared += all;
                ++i;
            }
    EXPECT_GT(compared, 1000);
}

TEST_F(Values, RandomBoundsAreNeverExceededAndSignsStay) {
    Random random(4);
    const std::vector<float> F = latticeValues(lattice, smooth, 1, nullptr);
    Flags inside(F.size());
    for (std::size_t i = 0; i < F.size(); ++i) inside[i] = F[i] < 0;
    const BoundedInput input{lattice, smooth, inside, 1, 4};
    for (int run = 0; run < 200; ++run) {
        const double bound = std::pow(10.0, -3.0 + 3.0 * static_cast<double>(random() % 1000) / 1000);
        const auto bounded = boundIndices(input, bound, {});
        ASSERT_TRUE(bounded.has_value());
        const std::vector<float> c =
            valuesOf(bounded->indices, Quantiser(bounded->delta, reachOf(input)), 1, 4);
        EXPECT_LE(4 * changeNear(lattice, smooth, c, 1, inside).largest, bound);
        const std::vector<float> G = latticeValues(lattice, c, 1, nullptr);
        for (std::size_t i = 0; i < G.size(); ++i) ASSERT_EQ(G[i] < 0, inside[i] != 0) << bound;
    }
}

}  // namespace
}  // namespace isowave::compress
