#include "volume/vdb_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <tbb/global_control.h>
#include <unistd.h>
#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

#include <cmath>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>

#include "isowave/error.h"
#include "volume/distance.h"
#include "volume/fit.h"
#include "volume/grid_bytes.h"

namespace isowave {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class VdbFile : public testing::Test {
  protected:
    void SetUp() override {
        initializeVdb();
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder = fs::temp_directory_path() /
                 ("isowave_vdb_" + std::string(info->name()) + "_" + std::to_string(::getpid()));
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }
    fs::path folder;
};

std::string bytesOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

// Removed first: ext4 takes a file that is cut to nothing and written again for one worth flushing to the
// disk.
void put(const fs::path& path, const std::string& bytes) {
    fs::remove(path);
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

// The message of the InputError that readVdb throws; "" when it succeeds. Anything else escapes: the test
// fails.
std::string refusal(const fs::path& path) {
    try {
        readVdb(path);
        return "";
    } catch (const InputError& e) {
        return e.what();
    }
}

// A ball of control points in a narrow band, -K inside and +K outside: inactive values of both signs in one
// leaf.
const openvdb::Coord kCentre(20, 20, 20);

BSplineField ballField(int radius) {
    constexpr float K = 3.25f;
    BSplineField field;
    field.K = K;
    field.controlPoints = openvdb::FloatGrid::create(K);
    field.shape = Shape::create(false);
    auto values = field.controlPoints->getAccessor();
    auto signs = field.shape->getAccessor();
    for (int x = -radius - 4; x <= radius + 4; ++x)
        for (int y = -radius - 4; y <= radius + 4; ++y)
            for (int z = -radius - 4; z <= radius + 4; ++z) {
                const double d = std::sqrt(x * x + y * y + z * z) - radius;
                const openvdb::Coord at = kCentre.offsetBy(x, y, z);
                if (std::abs(d) < 2)
                    values.setValueOn(at, static_cast<float>(d));
                else
                    values.setValueOff(at, d < 0 ? -K : K);
                signs.setValueOff(at, d < 0);
                if (std::abs(d) < 2) signs.setActiveState(at, true);
            }
    const auto transform = openvdb::math::Transform::createLinearTransform(
        openvdb::math::Mat4d(0., .5, 0., 0., -.75, 0., 0., 0., 0., 0., 1.5, 0., 10., 20., 30., 1.));
    field.controlPoints->setTransform(transform);
    field.shape->setTransform(transform->copy());
    return field;
}

template <class Grid>
void expectSameBits(const Grid& a, const Grid& b) {
    ASSERT_TRUE(a.tree().hasSameTopology(b.tree()));
    EXPECT_EQ(std::memcmp(&a.background(), &b.background(), sizeof(a.background())), 0);
    auto i = a.cbeginValueAll();
    auto j = b.cbeginValueAll();
    for (; i; ++i, ++j) {
        ASSERT_TRUE(j);
        ASSERT_EQ(i.getCoord(), j.getCoord());
        ASSERT_EQ(i.isValueOn(), j.isValueOn());
        const auto u = *i, v = *j;
        ASSERT_EQ(std::memcmp(&u, &v, sizeof(u)), 0) << i.getCoord();
    }
    EXPECT_FALSE(j);
    EXPECT_EQ(a.transform(), b.transform());
}

TEST_F(VdbFile, KeepsEveryValueToTheBitWithInactiveSigns) {
    const BSplineField field = ballField(11);
    writeVdb(folder / "a.vdb", {field.controlPoints, field.shape});
    const VdbContent content = readVdb(folder / "a.vdb");
    ASSERT_EQ(content.grids.size(), 2u);
    const auto values = openvdb::gridPtrCast<openvdb::FloatGrid>(content.grids[0]);
    const auto shape = openvdb::gridPtrCast<openvdb::BoolGrid>(content.grids[1]);
    ASSERT_TRUE(values && shape);
    expectSameBits(*field.controlPoints, *values);
    expectSameBits(*field.shape, *shape);
    EXPECT_EQ(values->tree().getValue(kCentre), -3.25f);  // inactive, inside
    EXPECT_EQ(values->tree().getValue({34, 34, 34}), 3.25f);
}

// The mask compression knows leaves with one, two and more inactive values; all of them must come back.
TEST_F(VdbFile, KeepsAnyInactiveValues) {
    std::mt19937 random(1);
    for (const unsigned distinct : {1, 2, 3, 7}) {
        auto grid = openvdb::FloatGrid::create(2.0f);
        for (int i = 0; i < 512; ++i) {
            const openvdb::Coord at(i >> 6, (i >> 3) & 7, i & 7);
            if (random() % 2)
                grid->tree().setValueOn(at, static_cast<float>(random()));
            else
                grid->tree().setValueOff(at, static_cast<float>(random() % distinct) - 2.0f);
        }
        writeVdb(folder / "a.vdb", {grid});
        expectSameBits(*grid,
                       *openvdb::gridPtrCast<openvdb::FloatGrid>(readVdb(folder / "a.vdb").grids.at(0)));
    }
}

TEST_F(VdbFile, KeepsMetadataOfFileAndGrids) {
    const BSplineField field = ballField(5);
    field.controlPoints->setName("ball");
    field.controlPoints->insertMeta("isowave:note", openvdb::StringMetadata("n"));
    openvdb::MetaMap metadata;
    metadata.insertMeta("isowave:version", openvdb::Int32Metadata(7));
    writeVdb(folder / "a.vdb", {field.controlPoints}, metadata);
    const VdbContent content = readVdb(folder / "a.vdb");
    EXPECT_EQ(content.metadata->metaValue<int>("isowave:version"), 7);
    EXPECT_EQ(content.metadata->metaCount(), 1u);  // our own mark is taken off again
    EXPECT_EQ(content.grids.at(0)->getName(), "ball");
    EXPECT_EQ(content.grids.at(0)->metaValue<std::string>("isowave:note"), "n");
}

TEST_F(VdbFile, HoldsTheSameBytesEachTime) {
    const BSplineField field = ballField(9);
    writeField(folder / "a.vdb", field);
    writeField(folder / "b.vdb", field);
    EXPECT_EQ(bytesOf(folder / "a.vdb"), bytesOf(folder / "b.vdb"));
    // ... and after a round trip
    writeVdb(folder / "c.vdb", {readVdb(folder / "a.vdb").grids.at(0)});
    EXPECT_EQ(bytesOf(folder / "a.vdb"), bytesOf(folder / "c.vdb"));
    // another content has another UUID
    field.controlPoints->tree().setValueOn(kCentre, 0.5f);
    writeField(folder / "d.vdb", field);
    EXPECT_NE(bytesOf(folder / "a.vdb").substr(21, 36), bytesOf(folder / "d.vdb").substr(21, 36));
}

// More leaves than a block of several threads.
BSplineField manyLeaves() {
    const BSplineField field = ballField(36);
    EXPECT_GT(field.controlPoints->tree().leafCount(), 512u);
    return field;
}

TEST_F(VdbFile, HoldsTheSameBytesWhateverTheThreads) {
    const BSplineField field = manyLeaves();
    std::string one;
    for (const std::size_t threads : {1, 2, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        writeVdb(folder / "a.vdb", {field.controlPoints, field.shape});
        if (one.empty()) one = bytesOf(folder / "a.vdb");
        EXPECT_EQ(bytesOf(folder / "a.vdb"), one) << threads;
        const VdbContent content = readVdb(folder / "a.vdb");
        expectSameBits(*field.controlPoints, *openvdb::gridPtrCast<openvdb::FloatGrid>(content.grids.at(0)));
        expectSameBits(*field.shape, *openvdb::gridPtrCast<openvdb::BoolGrid>(content.grids.at(1)));
    }
}

TEST_F(VdbFile, LeavesInParallelAreTheBytesThatOpenVdbWrites) {
    const BSplineField field = manyLeaves();
    const auto buffersOf = [](const openvdb::GridBase& grid, std::uint32_t compression) {
        std::ostringstream bytes;
        openvdb::io::setDataCompression(bytes, compression);
        const float background = 3.25f;
        openvdb::io::setGridBackgroundValuePtr(bytes, &background);
        grid.writeBuffers(bytes);
        return bytes.str();
    };
    for (const openvdb::GridBase::ConstPtr& grid :
         {openvdb::GridBase::ConstPtr(field.controlPoints), openvdb::GridBase::ConstPtr(field.shape)})
        for (const std::uint32_t compression :
             {std::uint32_t(openvdb::io::COMPRESS_NONE), std::uint32_t(openvdb::io::COMPRESS_ACTIVE_MASK)}) {
            const auto parallel = writtenInParallel(grid);
            EXPECT_NE(parallel, grid);
            EXPECT_EQ(parallel->type(), grid->type());
            EXPECT_TRUE(buffersOf(*parallel, compression) == buffersOf(*grid, compression));
        }
    const openvdb::GridBase::ConstPtr other = openvdb::DoubleGrid::create();
    EXPECT_EQ(writtenInParallel(other), other);
}

// A grid that is there twice is written twice: each part can be read alone.
TEST_F(VdbFile, HoldsATreeForEachGridThatSharesIt) {
    const BSplineField field = ballField(6);
    const auto twin = field.controlPoints->copy();
    field.controlPoints->setName("one");
    twin->setName("two");
    writeVdb(folder / "a.vdb", {field.controlPoints, twin});
    VdbParts parts(folder / "a.vdb");
    const auto grids = parts.read({"two", "none", "one"});
    EXPECT_EQ(grids.at(1), nullptr);
    for (const std::size_t i : {0, 2})
        expectSameBits(*field.controlPoints, *openvdb::gridPtrCast<openvdb::FloatGrid>(grids.at(i)));
    EXPECT_EQ(readVdb(folder / "a.vdb").grids.size(), 2u);
}

// The file was written when Blosc was still used: isowave field of a 24^3 image of this ball with a hole,
// voxels of 1 mm.
TEST_F(VdbFile, ReadsFilesOfItsOwnThatHoldBlosc) {
    const auto inside = [](const openvdb::Coord& c) {
        const double x = c.x() - 11.5, y = c.y() - 11.5, z = c.z() - 11.5;
        return x * x + y * y + z * z < 49 && x * x + y * y > 4;
    };
    const BSplineField field = fitBinary(nodesFromFunction(inside, openvdb::CoordBBox(0, 0, 0, 23, 23, 23)));
    const fs::path old = ISOWAVE_TEST_DATA "/vdb/ball_blosc.vdb";
    const auto read = readLevelSet(old);
    EXPECT_EQ(read->metaValue<std::string>("file_compression"), "blosc + active values");
    expectSameBits(*field.controlPoints, *read);
    VdbParts parts(old);
    expectSameBits(*field.controlPoints,
                   *openvdb::gridPtrCast<openvdb::FloatGrid>(parts.read({"field"}).at(0)));
    std::string bytes = bytesOf(old);
    bytes[bytes.size() / 2] ^= 1;
    put(folder / "bad.vdb", bytes);
    EXPECT_THAT(refusal(folder / "bad.vdb"), HasSubstr("is damaged"));
}

TEST_F(VdbFile, IsReadByOpenVdbGridByGrid) {
    const BSplineField field = ballField(7);
    field.controlPoints->setName("values");
    field.shape->setName("shape");
    writeVdb(folder / "a.vdb", {field.controlPoints, field.shape});
    openvdb::io::File file((folder / "a.vdb").string());
    file.open();
    EXPECT_TRUE(file.hasGrid("values"));
    const auto shape =
        openvdb::gridPtrCast<openvdb::BoolGrid>(file.readGrid("shape"));  // found by its offset
    ASSERT_TRUE(shape);
    expectSameBits(*field.shape, *shape);
    EXPECT_THAT(file.getUniqueTag(), testing::MatchesRegex("........-....-8...-.*"));
}

TEST_F(VdbFile, ReadsWhatOpenVdbWrote) {
    const auto sphere =
        openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(5.0f, openvdb::Vec3f(0), 0.5f);
    for (const std::uint32_t compression :
         {std::uint32_t(openvdb::io::COMPRESS_NONE), std::uint32_t(openvdb::io::COMPRESS_ZIP),
          std::uint32_t(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK)}) {
        {
            openvdb::io::File file((folder / "foreign.vdb").string());
            file.setCompression(compression);
            file.write({sphere});
        }
        const VdbContent content = readVdb(folder / "foreign.vdb");
        expectSameBits(*sphere, *openvdb::gridPtrCast<openvdb::FloatGrid>(content.grids.at(0)));
    }
}

TEST_F(VdbFile, ReadsGridsSavedInHalfPrecision) {
    const auto sphere =
        openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(5.0f, openvdb::Vec3f(0), 0.5f);
    sphere->setSaveFloatAsHalf(true);
    openvdb::io::File((folder / "half.vdb").string()).write({sphere});
    const auto read = readLevelSet(folder / "half.vdb");
    EXPECT_EQ(read->activeVoxelCount(), sphere->activeVoxelCount());
    for (auto value = sphere->cbeginValueOn(); value; ++value)
        ASSERT_NEAR(read->tree().getValue(value.getCoord()), *value,
                    1e-3);  // half: 11 bits, values below 1.5
}

TEST_F(VdbFile, RefusesWhatIsNotAVdb) {
    EXPECT_THAT(refusal(folder / "missing.vdb"), HasSubstr("no such file"));
    EXPECT_THAT(refusal(folder), HasSubstr("is a folder; expected"));
    put(folder / "empty.vdb", "");
    EXPECT_THAT(refusal(folder / "empty.vdb"), HasSubstr("is empty"));
    put(folder / "text.vdb", std::string(200, 'x'));
    EXPECT_THAT(refusal(folder / "text.vdb"), HasSubstr("is not a .vdb file"));
}

TEST_F(VdbFile, RefusesEveryTruncation) {
    const BSplineField field = ballField(4);
    writeVdb(folder / "a.vdb", {field.controlPoints, field.shape});
    const std::string whole = bytesOf(folder / "a.vdb");
    ASSERT_EQ(refusal(folder / "a.vdb"), "");
    for (std::size_t length = 0; length < whole.size(); ++length) {
        put(folder / "cut.vdb", whole.substr(0, length));
        const std::string message = refusal(folder / "cut.vdb");
        ASSERT_THAT(message, HasSubstr("cut.vdb: ")) << length << " of " << whole.size();
        ASSERT_EQ(message.find('\n'), std::string::npos);
    }
    put(folder / "cut.vdb", whole.substr(0, whole.size() / 2));
    EXPECT_THAT(refusal(folder / "cut.vdb"),
                HasSubstr("was written with " + std::to_string(whole.size()) + " bytes but holds " +
                          std::to_string(whole.size() / 2)));
}

openvdb::FloatGrid::Ptr smallSphere() {
    return openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(3.0f, openvdb::Vec3f(20), 1.0f);
}

TEST_F(VdbFile, RefusesEveryTruncationOfAForeignFile) {
    for (const std::uint32_t compression :
         {std::uint32_t(openvdb::io::COMPRESS_ZIP),
          std::uint32_t(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK)}) {
        {
            openvdb::io::File file((folder / "foreign.vdb").string());
            file.setCompression(compression);
            file.write({smallSphere()});
        }
        const std::string whole = bytesOf(folder / "foreign.vdb");
        ASSERT_EQ(refusal(folder / "foreign.vdb"), "");
        for (std::size_t length = 0; length < whole.size(); length += 3) {
            put(folder / "cut.vdb", whole.substr(0, length));
            ASSERT_NE(refusal(folder / "cut.vdb"), "") << length << " of " << whole.size();
        }
        put(folder / "cut.vdb", whole.substr(0, whole.size() - 1));
        EXPECT_THAT(refusal(folder / "cut.vdb"), HasSubstr("ends at byte"));
    }
}

// openvdb::io::Stream writes no offsets, so here only the short read tells, and OpenVDB leaks the nodes that
// it was reading.
TEST_F(VdbFile, RefusesTruncationsOfAFileWithoutOffsets) {
#ifdef __SANITIZE_ADDRESS__
    const __lsan::ScopedDisabler leaksOfOpenVdb;
#endif
    std::ostringstream text;
    openvdb::io::Stream(text).write({smallSphere()});
    const std::string whole = text.str();
    put(folder / "foreign.vdb", whole);
    ASSERT_EQ(refusal(folder / "foreign.vdb"), "");
    for (std::size_t length = 0; length < whole.size(); length += 397) {
        put(folder / "cut.vdb", whole.substr(0, length));
        ASSERT_NE(refusal(folder / "cut.vdb"), "") << length << " of " << whole.size();
    }
    put(folder / "cut.vdb", whole.substr(0, whole.size() - 1));
    EXPECT_THAT(refusal(folder / "cut.vdb"), HasSubstr("ends too early"));
}

// What one changed byte does to a file of another program: a message of one line, or grids. Never a crash, and the child
// that parses may take 512 MB.
TEST_F(VdbFile, OutlivesAChangedByteOfAForeignFile) {
    {
        openvdb::io::File file((folder / "foreign.vdb").string());
        file.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
        file.write({smallSphere()});
    }
    const std::string whole = bytesOf(folder / "foreign.vdb");
    std::mt19937 random(77);
    int refused = 0;
    constexpr int kTrials = 120;
    for (int trial = 0; trial < kTrials; ++trial) {
        std::string bad = whole;
        bad[random() % whole.size()] = static_cast<char>(random());
        put(folder / "bad.vdb", bad);
        const std::string message = refusal(folder / "bad.vdb");
        refused += !message.empty();
        ASSERT_EQ(message.find('\n'), std::string::npos);
    }
    EXPECT_GT(refused, kTrials / 20);
    EXPECT_LT(refused, kTrials);
}

// OpenVDB believes the places of a root's children; one that is no multiple of 4096 was a crash where the grid was used.
TEST_F(VdbFile, RefusesANodeBetweenPlacesOfNodes) {
    const auto sphere =
        openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(3.0f, openvdb::Vec3f(-20), 1.0f);
    openvdb::io::File((folder / "foreign.vdb").string()).write({sphere});
    std::string bad = bytesOf(folder / "foreign.vdb");
    const std::string place("\x00\xf0\xff\xff\x00\xf0\xff\xff\x00\xf0\xff\xff", 12);  // -4096 three times
    const std::size_t at = bad.find(place);
    ASSERT_NE(at, std::string::npos);
    bad[at] = 8;
    put(folder / "bad.vdb", bad);
    EXPECT_THAT(refusal(folder / "bad.vdb"),
                HasSubstr("a node lies at (-4088, -4096, -4096), which is no multiple"));
}

// The length of the first grid's name, 4 GB: it must not be allocated here or in the child.
TEST_F(VdbFile, DoesNotBelieveTheLengthOfAName) {
    openvdb::io::File((folder / "foreign.vdb").string()).write({smallSphere()});
    std::string bad = bytesOf(folder / "foreign.vdb");
    const std::size_t at = bad.find("Tree_float_5_4_3") - 4;
    bad.replace(at, 4, "\xff\xff\xff\xff");
    put(folder / "bad.vdb", bad);
    EXPECT_THAT(refusal(folder / "bad.vdb"), HasSubstr("bad.vdb: "));
}

TEST_F(VdbFile, TellsATextOfItsMetadataWithoutOpenVdb) {
    openvdb::MetaMap metadata;
    metadata.insertMeta("number", openvdb::Int64Metadata(7));
    metadata.insertMeta("word", openvdb::StringMetadata("pyramid"));
    writeVdb(folder / "a.vdb", {smallSphere()}, metadata);
    const auto value = [&](const char* name) {
        return vdbStringMetadatum(FileBytes(folder / "a.vdb", "a .vdb"), name);
    };
    EXPECT_EQ(value("word"), "pyramid");
    EXPECT_EQ(value("number"), std::nullopt);
    EXPECT_EQ(value("nothing"), std::nullopt);
    const std::string whole = bytesOf(folder / "a.vdb");
    for (std::size_t length = 0; length < 400; ++length) {
        put(folder / "a.vdb", whole.substr(0, length));
        EXPECT_TRUE(!value("word") || *value("word") == "pyramid") << length;
    }
}

TEST_F(VdbFile, RefusesEveryDamagedByte) {
    const BSplineField field = ballField(4);
    writeVdb(folder / "a.vdb", {field.controlPoints, field.shape});
    const std::string whole = bytesOf(folder / "a.vdb");
    std::mt19937 random(20240229);
    for (int trial = 0; trial < 4000; ++trial) {
        std::string bad = whole;
        const std::size_t at = random() % whole.size();
        bad[at] = static_cast<char>(bad[at] ^ static_cast<char>(1 + random() % 255));
        if (trial % 2 == 1) bad[random() % whole.size()] = static_cast<char>(random());
        if (bad == whole) continue;
        put(folder / "bad.vdb", bad);
        ASSERT_NE(refusal(folder / "bad.vdb"), "") << trial;
    }
    put(folder / "bad.vdb", whole + '\0');  // a byte too many
    EXPECT_THAT(refusal(folder / "bad.vdb"), HasSubstr("is damaged"));
}

TEST_F(VdbFile, LeavesNothingWhereItCannotWrite) {
    const BSplineField field = ballField(3);
    EXPECT_THROW(writeField(folder / "none" / "a.vdb", field), OperationError);
    EXPECT_FALSE(fs::exists(folder / "none"));
}

// /dev/full takes nothing: a link to it under the temporary name stands in for a full disk.
TEST_F(VdbFile, ReportsAFullDisk) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
    const BSplineField field = ballField(8);
    const fs::path place = folder / "a.vdb";
    fs::create_symlink("/dev/full", place.string() + ".part-" + std::to_string(::getpid()));
    EXPECT_THROW(writeField(place, field), OperationError);
    EXPECT_FALSE(fs::exists(place));
    EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(VdbFile, FieldIsALevelSetThatOthersKnow) {
    const BSplineField field = ballField(6);
    writeField(folder / "a.vdb", field);
    EXPECT_NE(field.controlPoints->getName(), "field");  // the caller's grid is as it was
    const auto grid = readLevelSet(folder / "a.vdb");
    EXPECT_EQ(grid->getName(), "field");
    EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
    EXPECT_EQ(grid->metaValue<double>("isowave:K"), 3.25);
    expectSameBits(*field.controlPoints, *grid);
}

class LevelSet : public VdbFile {
  protected:
    openvdb::FloatGrid::Ptr sphere() {
        auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(4.0f, openvdb::Vec3f(0), 1.0f);
        grid->setName("sphere");
        return grid;
    }
    openvdb::FloatGrid::Ptr fog() {
        auto grid = openvdb::FloatGrid::create(0.0f);
        grid->setGridClass(openvdb::GRID_FOG_VOLUME);
        grid->setName("smoke");
        grid->tree().setValueOn({1, 2, 3}, 0.5f);
        return grid;
    }
    std::string refusalOf(const openvdb::GridCPtrVec& grids, const std::optional<std::string>& name = {}) {
        writeVdb(folder / "a.vdb", grids);
        try {
            readLevelSet(folder / "a.vdb", name);
            return "";
        } catch (const InputError& e) {
            return e.what();
        }
    }
};

TEST_F(LevelSet, IsTheOnlyOneAmongOtherGrids) {
    EXPECT_EQ(refusalOf({fog(), sphere()}), "");
    EXPECT_EQ(readLevelSet(folder / "a.vdb")->getName(), "sphere");
}

TEST_F(LevelSet, IsRefusedWhereSeveralOrNone) {
    auto second = sphere();
    second->setName("other");
    EXPECT_THAT(
        refusalOf({sphere(), second}),
        HasSubstr("holds 2 level sets: 'sphere' (float, level set), 'other' (float, level set); name"));
    EXPECT_EQ(refusalOf({sphere(), second}, "other"), "");
    EXPECT_THAT(refusalOf({fog()}), HasSubstr("holds no level set, only 'smoke' (float, fog volume)"));
    EXPECT_EQ(refusalOf({fog()}, "smoke"), "");
    EXPECT_THAT(refusalOf({fog()}, "dust"), HasSubstr("has no grid 'dust'; it holds 'smoke'"));
    EXPECT_THAT(refusalOf({}), HasSubstr("holds no grids"));
    auto shape = openvdb::BoolGrid::create(false);
    shape->setName("shape");
    EXPECT_THAT(refusalOf({shape}, "shape"), HasSubstr("grid 'shape' holds bool; expected float or double"));
}

TEST_F(LevelSet, IsKnownByItsSignsWhereTheClassIsUnknown) {
    auto grid = sphere();
    grid->setGridClass(openvdb::GRID_UNKNOWN);
    EXPECT_EQ(refusalOf({grid}), "");
    auto density = fog();
    density->setGridClass(openvdb::GRID_UNKNOWN);
    EXPECT_NE(refusalOf({density}), "");
}

TEST_F(LevelSet, InDoublesBecomesFloat) {
    auto doubles = openvdb::DoubleGrid::create(1.0);
    doubles->setGridClass(openvdb::GRID_LEVEL_SET);
    doubles->tree().setValueOn({1, 2, 3}, -0.1);
    doubles->setTransform(openvdb::math::Transform::createLinearTransform(0.25));
    EXPECT_EQ(refusalOf({doubles}), "");
    const auto grid = readLevelSet(folder / "a.vdb");
    EXPECT_EQ(grid->tree().getValue({1, 2, 3}), -0.1f);
    EXPECT_EQ(grid->transform(), doubles->transform());
}

TEST_F(LevelSet, MustBeFinite) {
    auto grid = sphere();
    grid->tree().setValueOn({4, 0, 0}, std::numeric_limits<float>::quiet_NaN());
    EXPECT_THAT(refusalOf({grid}), HasSubstr("holds nan at voxel (4, 0, 0)"));
}

}  // namespace
}  // namespace isowave
