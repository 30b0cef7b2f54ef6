// The promises of wavelets/exact.h.
#include "wavelets/exact.h"

#include <gtest/gtest.h>

#include <bit>

#include "temp_folder.h"
#include "wavelets/bounds.h"
#include "wavelets/keep_exactly.h"
#include "wavelets/pyramid_file.h"
#include "zoo/zoo.h"

namespace isowave::wavelets {
namespace {

std::int64_t differentBits(const BSplineField& a, const BSplineField& b) {
    std::int64_t count = 0;
    for (auto v = a.controlPoints->cbeginValueOn(); v; ++v)
        count += std::bit_cast<std::uint32_t>(*v) !=
                 std::bit_cast<std::uint32_t>(b.controlPoints->tree().getValue(v.getCoord()));
    return count;
}

TEST(Exact, GivesStep0BackToTheBitForTheWholeZoo) {
    const test::TempFolder folder("exact");
    std::int64_t missed = 0;
    for (const auto& [name, field] : zoo::allFields()) {
        Pyramid pyramid = analyse(field);
        missed += differentBits(field, pyramid.field(0));
        keepExactly(pyramid, field);
        EXPECT_EQ(differentBits(field, pyramid.field(0)), 0) << name;
        writePyramid(folder / "a.vdb", pyramid);
        EXPECT_EQ(differentBits(field, readPyramid(folder / "a.vdb").field(0)), 0) << name;
        if (pyramid.stepCount() > 0) {
            EXPECT_FALSE(readPyramid(folder / "a.vdb", 1).exact) << name;
        }
    }
    EXPECT_GT(missed, 1000);  // or there is nothing to keep
}

TEST(Exact, IsForgottenWhereDetailsAreDropped) {
    const BSplineField field = zoo::binaryField(zoo::thinSolids()[1]);
    Pyramid pyramid = analyse(field);
    keepExactly(pyramid, field);
    dropDetails(pyramid, std::vector<double>(pyramid.steps.size(), 0.01 * field.K));
    EXPECT_FALSE(pyramid.exact);
}

TEST(Exact, TellsFieldsApart) {
    const BSplineField field = zoo::binaryField(zoo::thinSolids()[1]);
    BSplineField other = field;
    EXPECT_TRUE(areSame(field, other));
    other.controlPoints = field.controlPoints->deepCopy();
    EXPECT_TRUE(areSame(field, other));
    auto first = other.controlPoints->beginValueOn();
    first.setValue(std::nextafter(*first, 2.0f));
    EXPECT_FALSE(areSame(field, other));
    other.controlPoints = field.controlPoints;
    other.shape = field.shape->deepCopy();
    auto sign = other.shape->beginValueOn();
    sign.setValue(!*sign);
    EXPECT_FALSE(areSame(field, other));
}

}  // namespace
}  // namespace isowave::wavelets
