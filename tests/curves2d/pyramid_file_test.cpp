// The promises of file/row_coding.h and file/pyramid_file.h.
#include "curves2d/file/pyramid_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "base/section_file.h"
#include "curves2d/file/row_coding.h"
#include "curves2d/fit.h"
#include "curves2d/pyramid.h"
#include "curves2d/shapes.h"
#include "isowave/error.h"
#include "tests/temp_folder.h"

namespace isowave::curves2d {
namespace {

using testing::HasSubstr;

// Checksums alone: what the messages are called does not matter here.
constexpr SectionFormat kFormat{"ISOWAVEC", 1, "", "", ""};

Input inputOf(const Shape& shape, Fit method = Fit::binary) {
    Input input;
    input.shape = std::make_shared<const Shape>(shape);
    input.extent.take(Point{-1, -2});
    input.extent.take(Point{99, 98});
    input.kind = "a shape";
    input.fit = method;
    return input;
}

bool sameBits(float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0; }

void expectSameField(const RowField<float>& a, const RowField<float>& b, const std::string& name) {
    EXPECT_EQ(a.axis, b.axis) << name;
    EXPECT_EQ(a.K, b.K) << name;
    EXPECT_EQ(a.frame, b.frame) << name;
    ASSERT_EQ(a.rowNumbers(), b.rowNumbers()) << name;
    for (const auto& [number, row] : a.rows) {
        const Row<float>& other = *b.find(number);
        ASSERT_EQ(row.runs, other.runs) << name;
        ASSERT_EQ(row.values.size(), other.values.size()) << name;
        for (std::size_t i = 0; i < row.values.size(); ++i)
            ASSERT_TRUE(sameBits(row.values[i], other.values[i])) << name;
    }
}

std::vector<RowField<float>> fieldsOf(const RowField<float>& field) {
    std::vector<RowField<float>> fields;
    analyse<float>(field, 1000, {}, [&](int, const RowField<float>& f) { fields.push_back(f); });
    return fields;
}

// "" when it is read.
std::string messageOf(const std::string& bytes) {
    try {
        readPyramid(bytes, "a.iwc");
        return "";
    } catch (const InputError& error) {
        return error.what();
    }
}

std::string small() { return pyramidBytes(fitted(inputOf(shapes::blobs(24, 8, 3)))); }

TEST(PlanePyramidFile, EveryStepComesBackToTheBit) {
    for (const auto& [name, shape] : shapes::all()) {
        const Input input = fitted(inputOf(shape));
        const Input back = readPyramid(pyramidBytes(input), "a.iwc");
        const auto expected = fieldsOf(input.fitted->field), found = fieldsOf(back.fitted->field);
        ASSERT_EQ(expected.size(), found.size()) << name;
        for (std::size_t step = 0; step < expected.size(); ++step)
            expectSameField(expected[step], found[step], name);
    }
}

TEST(PlanePyramidFile, KeepsWhatTheCurvesNeedOfTheInput) {
    const Input input =
        fitted(readInput(ISOWAVE_TEST_DATA "/curves2d/africa.geojson", {.pixels = 90}), {.band = 1.5});
    const Input back = readPyramid(pyramidBytes(input), "a.iwc");
    EXPECT_EQ(back.extent.low, input.extent.low);
    EXPECT_EQ(back.extent.high, input.extent.high);
    EXPECT_TRUE(back.yUp);
    EXPECT_EQ(back.kind, input.kind);
    EXPECT_EQ(back.pixel, input.pixel);
    EXPECT_EQ(back.fitted->method, Fit::distance);
    EXPECT_EQ(back.fitted->halfWidth, 4);
    EXPECT_EQ(back.fitted->band, 1.5);
    EXPECT_EQ(back.fitted->report.latticePoints, input.fitted->report.latticePoints);
    EXPECT_EQ(back.fitted->report.repaired, input.fitted->report.repaired);
    EXPECT_EQ(pyramidBytes(back), pyramidBytes(input));
}

TEST(PlanePyramidFile, GivesTheCurvesOfTheInput) {
    const auto texts = [](Input input) {
        std::vector<std::string> all;
        for (const LevelCurves& level : levelCurves(std::move(input), {}, {.smooth = true}))
            all.push_back(geojson(level.drawn.curves, "x") + gmtText(level.drawn.curves));
        return all;
    };
    const auto africa = [] {
        return readInput(ISOWAVE_TEST_DATA "/curves2d/africa.geojson", {.pixels = 120});
    };
    const auto expected = texts(africa());
    EXPECT_GT(expected.size(), 4u);
    EXPECT_EQ(texts(readPyramid(pyramidBytes(fitted(africa())), "a.iwc")), expected);
}

TEST(PlanePyramidFile, ValuesOfAnyBitsComeBack) {
    RowField<float> field = fitBinary<float>(shapes::noise(40, 40, 0.5, 7));
    std::mt19937 random(5);
    for (auto row = field.rows.begin(); row != field.rows.end(); ++row)
        for (float& value : row.value().values)
            value = std::ldexp(static_cast<float>(random()) - 2e9f, static_cast<int>(random() % 80) - 100);
    for (const Coding coding : {Coding::predicted, Coding::plain}) {
        RowField<float> back =
            decodeRows(encodeRows(field), static_cast<std::uint64_t>(field.controlPointCount()));
        back.K = field.K;
        back.frame = field.frame;
        decodeValues(encodeValues(field, coding), coding, back);
        expectSameField(field, back, "noise");
    }
}

TEST(PlanePyramidFile, IsWrittenAsAFileThatReadInputTakes) {
    const test::TempFolder folder;
    const auto path = folder / "shape.iwc";
    savePyramid(path, fitted(inputOf(shapes::disc(20))));
    expectSameField(readInput(path).fitted->field, fitBinary<float>(shapes::disc(20)), "disc");
    EXPECT_THROW(savePyramid(folder / "none/shape.iwc", fitted(inputOf(shapes::disc(20)))), OperationError);
}

// A distance fit is predicted, a binary one is not; both are smaller than the floats alone.
TEST(PlanePyramidFile, TakesTheSmallerOfTwoCodings) {
    const auto kindOf = [](Fit method) {
        const Input input =
            fitted(readInput(ISOWAVE_TEST_DATA "/curves2d/africa.geojson", {.pixels = 200}), {.fit = method});
        const std::string bytes = pyramidBytes(input);
        EXPECT_LT(bytes.size(), 4 * static_cast<std::size_t>(input.fitted->field.controlPointCount()));
        expectSameField(readPyramid(bytes, "a").fitted->field, input.fitted->field, "africa");
        return sectionsOf(kFormat, bytes)[2].kind;
    };
    EXPECT_EQ(kindOf(Fit::distance), 3u);
    EXPECT_EQ(kindOf(Fit::binary), 4u);
}

TEST(PlanePyramidFile, RefusesEveryTruncationAndEveryChangedByte) {
    const std::string whole = small();
    ASSERT_EQ(messageOf(whole), "");
    for (std::size_t length = 0; length < whole.size(); ++length) {
        const std::string message = messageOf(whole.substr(0, length));
        EXPECT_NE(message, "") << length;
        EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0);
    }
    EXPECT_NE(messageOf(whole + "x"), "");
    std::mt19937 random(1);
    for (std::size_t run = 0; run < 4 * whole.size(); ++run) {
        std::string damaged = whole;
        const std::size_t at = run % whole.size();
        damaged[at] = static_cast<char>(damaged[at] ^ static_cast<char>(1 + random() % 255));
        const std::string message = messageOf(damaged);
        EXPECT_NE(message, "") << at;
        EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0);
    }
}

// What no checksum can find: other bytes, packed again, with checksums that are right. What is then read can be climbed.
TEST(PlanePyramidFile, RefusesOrClimbsOtherBytesUnderRightChecksums) {
    const std::vector<Section> whole = sectionsOf(kFormat, small());
    const Input input = readPyramid(small(), "a.iwc");
    const auto points = static_cast<std::uint64_t>(input.fitted->field.controlPointCount());
    const std::string rows = encodeRows(input.fitted->field);
    std::mt19937 random(2);
    const auto changed = [&](std::string bytes) {
        for (std::size_t left = 1 + random() % 2; left > 0; --left)
            bytes[random() % bytes.size()] = static_cast<char>(random());
        return bytes;
    };
    int refused = 0, climbed = 0;
    for (int run = 0; run < 3000; ++run) {
        std::vector<Section> sections = whole;
        if (run % 3 == 0) sections[0].content = changed(sections[0].content);
        if (run % 3 == 1) sections[1].content = deflated(changed(rows));
        if (run % 3 == 2) sections[2].content = deflated(changed(inflated(sections[2].content, 4 * points)));
        const std::string bytes = fileOf(kFormat, sections), message = messageOf(bytes);
        EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0) << message;
        refused += !message.empty();
        if (!message.empty()) continue;
        ++climbed;
        try {
            makeLadder(readPyramid(bytes, "a.iwc"), {.hold = Hold::none}, {});
        } catch (const InputError&) {
        }
    }
    EXPECT_GT(refused, 1000);
    EXPECT_GT(climbed, 300);
}

// An edit fits its polygons with both, and the nodes that it makes reach as far.
TEST(PlanePyramidFile, RefusesABandThatIsWiderThanTheHalfWidthOrThanAnyShape) {
    std::vector<Section> sections = sectionsOf(kFormat, small());
    const auto with = [&](double halfWidth, double band) {
        constexpr std::size_t kBehind = 40;  // bytes of the head, the report
        ByteWriter both;
        both.f64(halfWidth);
        both.f64(band);
        std::string& head = sections[0].content;
        head.replace(head.size() - kBehind - 16, 16, both.str());
        return messageOf(fileOf(kFormat, sections));
    };
    EXPECT_EQ(with(4, 2), "");
    EXPECT_EQ(with(4, 4), "");
    EXPECT_THAT(with(4, 4.5), HasSubstr("head makes no sense"));
    EXPECT_THAT(with(1e300, 1e299), HasSubstr("head makes no sense"));
}

TEST(PlanePyramidFile, SaysWhatIsWrong) {
    EXPECT_THAT(messageOf("solid x"), HasSubstr("a.iwc: is no pyramid of curves: it does not begin with"));
    std::string other = small();
    other[8] = 7;
    EXPECT_THAT(messageOf(other), HasSubstr("format version 7, expected 1"));
    other[8] = 1;
    other[60] = static_cast<char>(other[60] ^ 4);
    EXPECT_THAT(messageOf(other), HasSubstr("checksum"));
    std::vector<Section> sections = sectionsOf(kFormat, small());
    sections.pop_back();
    EXPECT_THAT(messageOf(fileOf(kFormat, sections)), HasSubstr("does not have a head, rows and values"));
}

}  // namespace
}  // namespace isowave::curves2d
