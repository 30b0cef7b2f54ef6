// The promises of wavelets/pyramid_file.h.
#include "wavelets/pyramid_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "isowave/error.h"
#include "temp_folder.h"
#include "volume/vdb_file.h"
#include "zoo/zoo.h"

namespace isowave::wavelets {
namespace {

std::string bytesOf(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void expectSame(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b) {
    ASSERT_TRUE(a.tree().hasSameTopology(b.tree()));
    for (auto v = a.cbeginValueAll(); v; ++v) ASSERT_EQ(*v, b.tree().getValue(v.getCoord()));
}

Pyramid small() {
    Pyramid pyramid = analyse(zoo::binaryField(zoo::thinSolids()[1]));
    pyramid.source["input.path"] = "wall.nrrd";
    pyramid.source["fit"] = "binary";
    return pyramid;
}

TEST(PyramidFile, ComesBackToTheBitForTheWholeZoo) {
    const test::TempFolder folder("zoo");
    for (const auto& [name, field] : zoo::allFields()) {
        Pyramid pyramid = analyse(field);
        pyramid.source["input.path"] = name;
        writePyramid(folder / "a.pyramid.vdb", pyramid);
        const Pyramid read = readPyramid(folder / "a.pyramid.vdb");
        EXPECT_EQ(read.source, pyramid.source);
        EXPECT_EQ(read.K, pyramid.K);
        ASSERT_EQ(read.stepCount(), pyramid.stepCount());
        EXPECT_EQ(read.coefficientsStored(), pyramid.coefficientsStored());
        expectSame(*read.coarsest.controlPoints, *pyramid.coarsest.controlPoints);
        expectSame(*read.field(0).controlPoints, *pyramid.field(0).controlPoints);
        EXPECT_EQ(read.field(0).transform(), field.transform());
    }
}

TEST(PyramidFile, KeepsTheOrderOfItsSteps) {
    const test::TempFolder folder("order");
    const BSplineField field = zoo::distanceField(zoo::smoothSolids()[0]);
    for (const StepOrder& order : {StepOrder{}, StepOrder{{"xy", "xy"}}, StepOrder{{"zx", "xyz", "zy"}}}) {
        const Pyramid pyramid = analyse(field, {.order = order});
        writePyramid(folder / "a.vdb", pyramid);
        const Pyramid read = readPyramid(folder / "a.vdb");
        EXPECT_EQ(read.order, order);
        EXPECT_EQ(readOrder(folder / "a.vdb"), order);
        expectSame(*read.field(0).controlPoints, *pyramid.field(0).controlPoints);
        for (int step = 0; step < pyramid.stepCount(); ++step)
            EXPECT_EQ(read.steps[static_cast<std::size_t>(step)].axis,
                      pyramid.steps[static_cast<std::size_t>(step)].axis);
    }
}

TEST(PyramidFile, WithoutFirstLevelsHasLevelsOfAllAxes) {
    const test::TempFolder folder("in_turn");
    writePyramid(folder / "a.vdb", small());
    const VdbContent content = readVdb(folder / "a.vdb");
    EXPECT_FALSE((*content.metadata)["isowave:first_levels"]);  // as in files from before there were any
    EXPECT_EQ(readPyramid(folder / "a.vdb").order, StepOrder{});
}

TEST(PyramidFile, RefusesFirstLevelsThatAreNoneOrContradictTheSteps) {
    const test::TempFolder folder("first_levels");
    writePyramid(folder / "whole.vdb", small());
    const VdbContent content = readVdb(folder / "whole.vdb");
    const openvdb::GridCPtrVec grids(content.grids.begin(), content.grids.end());
    for (const auto& [text, complaint] :
         {std::pair{"xyz", ""}, std::pair{"a", "the first levels are 'a'"},
          std::pair{"xx", "the first levels are 'xx', expected"},
          std::pair{"xy x", "step 3 halves z, and x by the first levels 'xy x'"}}) {
        openvdb::MetaMap metadata(*content.metadata);
        metadata.insertMeta("isowave:first_levels", openvdb::StringMetadata(text));
        writeVdb(folder / "a.vdb", grids, metadata);
        try {
            readPyramid(folder / "a.vdb");
            EXPECT_STREQ(complaint, "");
        } catch (const InputError& error) {
            EXPECT_STRNE(complaint, "");
            EXPECT_THAT(error.what(), testing::HasSubstr(complaint));
        }
    }
}

TEST(PyramidFile, TheSamePyramidIsTheSameBytes) {
    const test::TempFolder folder("bytes");
    writePyramid(folder / "a.vdb", small());
    writePyramid(folder / "b.vdb", small());
    EXPECT_EQ(bytesOf(folder / "a.vdb"), bytesOf(folder / "b.vdb"));
}

// Those that a pyramid lacks are asked for one after the other, each once, and none while another one is there.
TEST(PyramidFile, StepsFromElsewhereAreTheSameBytes) {
    const test::TempFolder folder("lacking");
    const Pyramid whole = small();
    writePyramid(folder / "a.vdb", whole);
    Pyramid lacking = whole;
    for (std::size_t step : {0, 1, 4})
        lacking.steps[step].shape = nullptr, lacking.steps[step].details = nullptr;
    std::vector<std::string> asked;
    std::weak_ptr<void> last;
    const auto copied = [&](const char* what, int step, const auto& grid) {
        EXPECT_TRUE(last.expired()) << what << step;
        asked.push_back(what + std::to_string(step));
        const auto copy = grid->deepCopy();
        last = copy;
        return copy;
    };
    const StepSource source{
        [&](int step) { return copied("shape", step, whole.steps[static_cast<std::size_t>(step)].shape); },
        [&](int step) {
            return copied("details", step, whole.steps[static_cast<std::size_t>(step)].details);
        }};
    writePyramid(folder / "b.vdb", lacking, source);
    EXPECT_EQ(bytesOf(folder / "a.vdb"), bytesOf(folder / "b.vdb"));
    EXPECT_THAT(asked,
                testing::ElementsAre("shape0", "details0", "shape1", "details1", "shape4", "details4"));
}

TEST(PyramidFile, StepsThatCannotBeHadLeaveNothing) {
    const test::TempFolder folder("gone");
    Pyramid lacking = small();
    lacking.steps[1].details = nullptr;
    const StepSource source{{},
                            [](int) -> DetailGrid::Ptr { throw InputError("step_1_0.vdb", "is missing"); }};
    EXPECT_THROW(writePyramid(folder / "b.vdb", lacking, source), InputError);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(PyramidFile, RejectsEveryTruncation) {
    const test::TempFolder folder("truncated");
    writePyramid(folder / "whole.vdb", small());
    const std::string whole = bytesOf(folder / "whole.vdb");
    ASSERT_NO_THROW(readPyramid(folder / "whole.vdb"));
    // Every length near either end, a hundred in between.
    const std::size_t stride = whole.size() / 100;
    for (std::size_t length = 0; length < whole.size();
         length += length < 100 || length + 100 > whole.size()
                       ? 1
                       : std::min(stride, whole.size() - 100 - length + 1)) {
        std::ofstream(folder / "cut.vdb", std::ios::binary) << whole.substr(0, length);
        EXPECT_THROW(readPyramid(folder / "cut.vdb"), InputError) << length << " of " << whole.size();
    }
}

TEST(PyramidFile, RefusesAnotherVersionAndSaysWhich) {
    const test::TempFolder folder("version");
    openvdb::MetaMap meta;
    meta.insertMeta("isowave:format", openvdb::StringMetadata("pyramid"));
    meta.insertMeta("isowave:version", openvdb::Int32Metadata(7));
    writeVdb(folder / "new.vdb", {openvdb::FloatGrid::create()}, meta);
    EXPECT_TRUE(isPyramidFile(folder / "new.vdb"));
    try {
        readPyramid(folder / "new.vdb");
        FAIL();
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("version 7, expected 1"), std::string::npos) << e.what();
    }
}

TEST(PyramidFile, RefusesWhatIsNotAPyramid) {
    const test::TempFolder folder("other");
    const Pyramid pyramid = small();
    writeField(folder / "field.vdb", pyramid.coarsest);
    EXPECT_FALSE(isPyramidFile(folder / "field.vdb"));
    EXPECT_THROW(readPyramid(folder / "field.vdb"), InputError);
    EXPECT_FALSE(isPyramidFile(folder / "missing.vdb"));
    EXPECT_THROW(readPyramid(folder / "missing.vdb"), InputError);
    std::ofstream(folder / "text.vdb") << "not a grid";
    EXPECT_FALSE(isPyramidFile(folder / "text.vdb"));
    EXPECT_THROW(readPyramid(folder / "text.vdb"), InputError);
}

TEST(PyramidFile, ReadFromAStepOnItGivesThatStepToTheBitAndReadsLess) {
    const test::TempFolder folder("step");
    const Pyramid pyramid = analyse(zoo::binaryField(zoo::noisySolids()[0]));
    writePyramid(folder / "a.vdb", pyramid);
    std::int64_t before = 0;
    for (int step = 0; step <= pyramid.stepCount(); ++step) {
        std::int64_t bytes = 0;
        const Pyramid read = readPyramid(folder / "a.vdb", step, &bytes);
        ASSERT_EQ(read.stepCount(), pyramid.stepCount());
        expectSame(*read.field(step).controlPoints, *pyramid.field(step).controlPoints);
        EXPECT_EQ(read.field(step).transform(), pyramid.field(step).transform());
        if (step > 0) {
            EXPECT_LT(bytes, before) << step;
        }
        before = bytes;
    }
    // Step 0: everything. Step 6, a quarter of the resolution: seen 80 % of it; grids as small as this one
    // are mostly OpenVDB's node masks, of which every step has the same.
    std::int64_t all = 0, some = 0;
    readPyramid(folder / "a.vdb", 0, &all);
    readPyramid(folder / "a.vdb", 6, &some);
    EXPECT_EQ(all, static_cast<std::int64_t>(std::filesystem::file_size(folder / "a.vdb")));
    EXPECT_LT(some, all - all / 10);
    EXPECT_THROW(readPyramid(folder / "none.vdb", 6), InputError);
}

// The file with the byte at `at` changed.
void damage(const std::filesystem::path& from, const std::filesystem::path& to, std::size_t at) {
    std::string bytes = bytesOf(from);
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    std::ofstream(to, std::ios::binary) << bytes;
}

// Where the name of a grid first stands behind the metadata: in its descriptor.
std::size_t placeOf(const std::filesystem::path& file, const std::string& grid) {
    return bytesOf(file).find(grid);
}

TEST(PyramidFile, DamageInFinerStepsIsNotLookedAt) {
    const test::TempFolder folder("finer");
    const Pyramid pyramid = small();
    writePyramid(folder / "whole.vdb", pyramid);
    // In the middle of the details of step 1.
    const std::size_t at =
        (placeOf(folder / "whole.vdb", "details_001") + placeOf(folder / "whole.vdb", "shape_002")) / 2;
    damage(folder / "whole.vdb", folder / "bad.vdb", at);
    EXPECT_THROW(readPyramid(folder / "bad.vdb"), InputError);
    EXPECT_THROW(readPyramid(folder / "bad.vdb", 1), InputError);
    const Pyramid read = readPyramid(folder / "bad.vdb", 2);
    expectSame(*read.field(2).controlPoints, *pyramid.field(2).controlPoints);
}

TEST(PyramidFile, DamageInWhatIsReadIsFound) {
    const test::TempFolder folder("damaged");
    writePyramid(folder / "whole.vdb", small());
    const std::size_t size = bytesOf(folder / "whole.vdb").size();
    const std::size_t finest = placeOf(folder / "whole.vdb", "shape_000"),
                      read = placeOf(folder / "whole.vdb", "shape_003");
    for (std::size_t at = 0; at < size; at += at < 4000 ? 7 : size / 150) {
        if (at + 8 > finest && at < read) continue;  // the finer steps
        damage(folder / "whole.vdb", folder / "bad.vdb", at);
        EXPECT_THROW(readPyramid(folder / "bad.vdb", 3), InputError) << at << " of " << size;
    }
}

TEST(PyramidFile, NamesAMissingPart) {
    const test::TempFolder folder("part");
    writePyramid(folder / "whole.vdb", small());
    const VdbContent content = readVdb(folder / "whole.vdb");
    openvdb::GridCPtrVec some;
    for (const auto& grid : content.grids)
        if (grid->getName() != "details_001") some.push_back(grid);
    writeVdb(folder / "part.vdb", some, *content.metadata);
    try {
        readPyramid(folder / "part.vdb");
        FAIL();
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("details_001"), std::string::npos) << e.what();
    }
}

TEST(PyramidFile, RefusesACoarsestShapeOfAnotherField) {
    const test::TempFolder folder("shape");
    Pyramid pyramid = small();
    pyramid.coarsest.shape = Shape::create(false);
    writePyramid(folder / "a.vdb", pyramid);
    EXPECT_THROW(readPyramid(folder / "a.vdb"), InputError);
}

TEST(PyramidFile, PartsThatDoNotBelongTogetherAreRefusedNotCrashedOn) {
    Pyramid pyramid = small();
    pyramid.steps[0].shape = analyse(zoo::binaryField(zoo::noisySolids()[0])).steps[0].shape;
    EXPECT_THROW(pyramid.field(0), InputError);
    pyramid = small();
    pyramid.steps[1].details = DetailGrid::create(0.0f);
    EXPECT_THROW(pyramid.field(0), InputError);
}

}  // namespace
}  // namespace isowave::wavelets
