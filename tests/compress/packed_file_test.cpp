// The promises of compress/packed_file.h.
#include "compress/packed_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <random>

#include "compress/sections.h"
#include "isowave/error.h"
#include "polygonize/polygonize.h"
#include "temp_folder.h"
#include "wavelets/pyramid_file.h"
#include "zoo/zoo.h"

namespace isowave::compress {
namespace {

constexpr double kManyPoints = 1e9;

std::vector<zoo::NamedField> solidFields() {
    std::vector<zoo::NamedField> fields;
    for (auto& field : zoo::allFields())
        if (field.field.controlPointCount() > 0) fields.push_back(std::move(field));
    return fields;
}
BSplineField ball() { return zoo::distanceField(zoo::smoothSolids()[0]); }

template <class Grid>
void expectSame(const Grid& a, const Grid& b, const std::string& name) {
    EXPECT_EQ(a.transform(), b.transform()) << name;
    EXPECT_EQ(a.activeVoxelCount(), b.activeVoxelCount()) << name;
    std::size_t wrong = 0;
    auto box = a.evalActiveVoxelBoundingBox();
    box.expand(10);
    auto p = a.getConstAccessor(), q = b.getConstAccessor();
    for (auto x = box.begin(); x; ++x)
        wrong += p.getValue(*x) != q.getValue(*x) || p.isValueOn(*x) != q.isValueOn(*x);
    EXPECT_EQ(wrong, 0u) << name;
}

std::string messageOf(const std::string& bytes) {
    try {
        unpack(bytes, "a.iwz", kManyPoints);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(PackedFile, ComesBackToTheBitForTheWholeZoo) {
    for (const auto& [name, field] : solidFields()) {
        const PackedBytes packed = pack(field, name, {.source = {{"input.path", "\"a\""}}});
        const PackedField back = unpack(packed.bytes, name, kManyPoints);
        EXPECT_EQ(back.source.at("input.path"), "\"a\"");
        EXPECT_EQ(back.field.K, field.K);
        EXPECT_FALSE(back.bound.has_value());
        expectSame(*back.field.controlPoints, *field.controlPoints, name);
        expectSame(*back.field.shape, *field.shape, name);
    }
}

TEST(PackedFile, AnalysedAgainItIsTheSamePyramidFile) {
    const test::TempFolder folder("same");
    for (const auto& [name, field] : solidFields()) {
        wavelets::writePyramid(folder / "a.vdb", wavelets::analyse(field));
        wavelets::writePyramid(
            folder / "b.vdb",
            wavelets::analyse(unpack(pack(field, name, {}).bytes, name, kManyPoints).field));
        const wavelets::Pyramid a = wavelets::readPyramid(folder / "a.vdb"),
                                b = wavelets::readPyramid(folder / "b.vdb");
        ASSERT_EQ(a.stepCount(), b.stepCount()) << name;
        for (int s = 0; s < a.stepCount(); ++s) {
            expectSame(*a.steps[s].details, *b.steps[s].details, name);
            expectSame(*a.steps[s].shape, *b.steps[s].shape, name);
        }
        expectSame(*a.coarsest.controlPoints, *b.coarsest.controlPoints, name);
    }
}

TEST(PackedFile, WithABoundSignsStayAndTheFieldIsNear) {
    for (const auto& [name, field] : solidFields())
        for (const double bound : {0.2, 0.02}) {
            const PackedBytes packed = pack(field, name, {.bound = bound});
            EXPECT_LE(packed.facts.largest, bound) << name;
            EXPECT_GT(packed.facts.largest, 0) << name;
            const PackedField back = unpack(packed.bytes, name, kManyPoints);
            EXPECT_EQ(*back.bound, bound);
            expectSame(*back.field.shape, *field.shape, name);
            // Not by the coder's own sums: F of both fields at lattice points inside and outside.
            auto inside = field.shape->getConstAccessor();
            int looked = 0;
            for (auto value = field.controlPoints->cbeginValueOn(); value && looked < 300;
                 ++value, ++looked) {
                const openvdb::Vec3d p = value.getCoord().asVec3d();
                ASSERT_EQ(evaluate(back.field, p) < 0, inside.getValue(value.getCoord())) << name;
            }
        }
}

TEST(PackedFile, IsTheSameBytesForEveryNumberOfThreads) {
    const BSplineField field = ball();
    std::string first;
    for (const int threads : {1, 2, 5}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(threads));
        const std::string bytes = pack(field, "ball", {}).bytes + pack(field, "ball", {.bound = 0.1}).bytes;
        if (first.empty()) first = bytes;
        EXPECT_EQ(bytes, first) << threads;
    }
}

TEST(PackedFile, RefusesEveryTruncationAndEveryChangedByte) {
    const std::string whole = pack(ball(), "ball", {.bound = 0.5}).bytes;
    ASSERT_EQ(messageOf(whole), "");
    for (std::size_t length = 0; length < whole.size(); length += length < 200 ? 1 : 37) {
        const std::string message = messageOf(whole.substr(0, length));
        EXPECT_NE(message, "") << length;
        EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0);
    }
    EXPECT_NE(messageOf(whole + "x"), "");
    std::mt19937 random(1);
    for (int run = 0; run < 1000; ++run) {
        std::string damaged = whole;
        const std::size_t at = run < 100 ? static_cast<std::size_t>(run) : random() % whole.size();
        damaged[at] = static_cast<char>(damaged[at] ^ static_cast<char>(1 + random() % 255));
        EXPECT_NE(messageOf(damaged), "") << at;
    }
}

// What no checksum can find: sections whose bytes are others, with checksums that are right.
TEST(PackedFile, RefusesOrReadsOtherBytesUnderRightChecksums) {
    const std::vector<Section> whole = sectionsOf(kPackedFormat, pack(ball(), "ball", {.bound = 0.5}).bytes);
    std::mt19937 random(2);
    int refused = 0, tried = 0;
    for (int run = 0; run < 500; ++run) {
        std::vector<Section> sections = whole;
        std::string& content = sections[random() % sections.size()].content;
        if (content.empty()) continue;
        ++tried;
        if (run % 5 == 0) content.resize(random() % content.size());
        for (std::size_t left = 1 + random() % 3; left > 0 && !content.empty(); --left)
            content[random() % content.size()] = static_cast<char>(random());
        const std::string message = messageOf(fileOf(kPackedFormat, sections));
        refused += !message.empty();
        EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0) << message;
    }
    EXPECT_GT(tried, 300);
    EXPECT_GT(refused, tried * 4 / 5);  // of the rest, raw bits of values are others
}

TEST(PackedFile, SaysWhatIsWrong) {
    using testing::HasSubstr;
    EXPECT_THAT(messageOf("solid x"), HasSubstr("a.iwz: is no packed solid"));
    std::string other = pack(ball(), "ball", {}).bytes;
    other[8] = 7;
    EXPECT_THAT(messageOf(other), HasSubstr("format version 7, expected 1"));
    other[8] = 1;
    other[100] = static_cast<char>(other[100] ^ 4);
    EXPECT_THAT(messageOf(other), HasSubstr("checksum"));
    EXPECT_THROW(unpack(pack(ball(), "ball", {}).bytes, "ball", 10), InputError) << "more points than memory";
    EXPECT_THROW(readPacked("/nowhere/a.iwz", kManyPoints), InputError);
}

TEST(PackedFile, RefusesWhatItCouldNotGiveBack) {
    BSplineField empty;
    empty.controlPoints = openvdb::FloatGrid::create(1);
    empty.shape = Shape::create(false);
    EXPECT_THROW(pack(empty, "empty", {}), InputError);
    // A known point that belongs to no node.
    BSplineField odd = ball();
    odd.controlPoints = odd.controlPoints->deepCopy();
    odd.controlPoints->tree().setValue(odd.controlPoints->evalActiveVoxelBoundingBox().max().offsetBy(9),
                                       1.0f);
    EXPECT_THROW(pack(odd, "odd", {}), InputError);
    // An unknown point far away whose sign does not follow.
    BSplineField sign = ball();
    sign.shape = sign.shape->deepCopy();
    const auto box = sign.controlPoints->evalActiveVoxelBoundingBox();
    sign.shape->tree().setValueOff(box.min(), !sign.shape->tree().getValue(box.min()));
    EXPECT_THROW(pack(sign, "sign", {}), InputError);
}

}  // namespace
}  // namespace isowave::compress
