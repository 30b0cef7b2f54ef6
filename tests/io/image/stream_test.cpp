// Images in slabs: the same as whole images, to the bit, for every format, slab height and solid; what is
// wrong is found as it is there; and files far larger than 2^32 voxels.
#include "io/image/stream.h"

#include <openvdb/tools/Count.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>

#include "tests/io/image/files.h"
#include "tests/io/image/itk.h"
#include "volume/distance.h"
#include "volume/image_statistics.h"

namespace isowave {
namespace {

namespace fs = std::filesystem;
using namespace test;
using openvdb::Coord;

template <class Grid>
void expectSame(const Grid& a, const Grid& b) {
    EXPECT_EQ(a.transform(), b.transform());
    EXPECT_EQ(a.background(), b.background());
    ASSERT_TRUE(a.tree().hasSameTopology(b.tree()));
    auto leaf = b.tree().cbeginLeaf();
    for (auto other = a.tree().cbeginLeaf(); other; ++other, ++leaf) ASSERT_EQ(*other, *leaf);
    auto tile = b.cbeginValueAll();
    tile.setMaxDepth(tile.getLeafDepth() - 1);
    auto other = a.cbeginValueAll();
    other.setMaxDepth(other.getLeafDepth() - 1);
    for (; other; ++other, ++tile) ASSERT_EQ(*other, *tile) << other.getCoord();
}

// Smooth blobs, so that there is a surface of some size; it touches the border.
double blobs(double x, double y, double z) {
    return 100 * (std::sin(x * 0.41 + 1) + std::sin(y * 0.37) + std::sin(z * 0.29 + 2) +
                  0.3 * std::sin(x * y * 0.05));
}

using Short = itk::Image<std::int16_t, 3>;

Short::Pointer blobImage(std::array<unsigned, 3> size) {
    auto image = patternImage<std::int16_t, 3>(size);
    for (itk::ImageRegionIteratorWithIndex<Short> i(image, image->GetLargestPossibleRegion()); !i.IsAtEnd();
         ++i)
        i.Set(static_cast<std::int16_t>(
            blobs(double(i.GetIndex()[0]), double(i.GetIndex()[1]), double(i.GetIndex()[2]))));
    // anisotropic, oblique, away from the origin
    Short::SpacingType spacing;
    spacing[0] = 0.7, spacing[1] = 0.9, spacing[2] = 2.5;
    image->SetSpacing(spacing);
    Short::DirectionType turn;
    const double c = std::cos(0.4), s = std::sin(0.4);
    const double rows[3][3] = {{c, -s, 0}, {s * 0.8, c * 0.8, -0.6}, {s * 0.6, c * 0.6, 0.8}};
    for (unsigned i = 0; i < 3; ++i)
        for (unsigned j = 0; j < 3; ++j) turn[i][j] = rows[i][j];
    image->SetDirection(turn);
    Short::PointType origin;
    origin[0] = -31, origin[1] = 17.5, origin[2] = 211;
    image->SetOrigin(origin);
    return image;
}

ImageReadOptions rawOptions(const std::array<std::int64_t, 3>& size, const char* type, bool bigEndian = false,
                            std::int64_t headerBytes = 0) {
    ImageReadOptions options;
    options.raw = RawLayout{size, type, bigEndian, headerBytes};
    return options;
}

const ImageSolid kSolids[] = {
    {.iso = 30},
    {.iso = 30, .invert = true},
    {.iso = 30, .openBorder = true},
    {.iso = 30, .invert = true, .openBorder = true},
    {.label = 12},
    {.invert = true, .label = 12, .openBorder = true},
};

class ImageStreamFiles : public ImageFiles {};

TEST_F(ImageStreamFiles, GiveTheNodesAndDistancesOfTheWholeImageInEveryFormat) {
    const auto itk = blobImage({23, 18, 20});
    for (const char* name : {"a.nrrd", "a.nhdr", "a.mha", "a.mhd", "a.nii", "a.nii.gz", "z.nrrd", "z.mha"}) {
        SCOPED_TRACE(name);
        const fs::path path = folder / name;
        writeItk(itk.GetPointer(), path, name[0] == 'z');
        const Image whole = readImage(path);
        const ImageSolid solid = kSolids[1];
        const auto nodes = nodesFromImage(whole, solid).grid;
        const auto distance = distanceFromImage(whole, solid, 3);
        const bool plain = name[0] == 'a' && !path.string().ends_with(".gz");
        for (const std::int64_t slices : {0, 5}) {
            ImageStream stream(path, {}, slices);
            EXPECT_EQ(stream.isInFile(), plain);
            EXPECT_EQ(stream.header().indexToWorld, whole.indexToWorld);
            EXPECT_EQ(stream.header().size, whole.size);
            EXPECT_EQ(stream.header().format, whole.format);
            EXPECT_EQ(stream.header().componentType, whole.componentType);
            expectSame(*nodesFromImage(stream, solid).grid, *nodes);
            expectSame(*distanceFromImage(stream, solid, 3), *distance);
        }
    }
}

TEST_F(ImageStreamFiles, GiveTheSameForEverySlabHeightAndSolid) {
    const fs::path path = folder / "a.mha";
    writeItk(blobImage({21, 34, 19}).GetPointer(), path);
    const Image whole = readImage(path);
    for (const ImageSolid& solid : kSolids) {
        const auto nodes = nodesFromImage(whole, solid).grid;
        const auto distance = distanceFromImage(whole, solid, 4);
        EXPECT_GT(nodes->activeVoxelCount(), 100u);
        for (const std::int64_t slices : {1, 2, 3, 7, 8, 9, 16, 18, 19, 1000}) {
            ImageStream stream(path, {}, slices);
            expectSame(*nodesFromImage(stream, solid).grid, *nodes);
            if (slices == 1 || slices == 9) expectSame(*distanceFromImage(stream, solid, 4), *distance);
        }
    }
}

// nodesFromFunction() asks for one sign at a time, and shares nothing with the planes of bits.
TEST_F(ImageStreamFiles, GiveTheNodesThatAreThereWhateverTheSize) {
    std::mt19937 random(3);
    for (const std::array<int, 3> size : {std::array{1, 1, 1},
                                          {7, 1, 9},
                                          {8, 8, 8},
                                          {9, 17, 2},
                                          {63, 5, 4},
                                          {64, 3, 16},
                                          {65, 4, 7},
                                          {130, 3, 3}})
        for (const double share : {0.0, 0.02, 0.5, 1.0})
            for (const bool open : {false, true}) {
                Image image;
                image.size = {size[0], size[1], size[2]};
                std::bernoulli_distribution inside(share);
                for (std::int64_t i = 0; i < image.voxelCount(); ++i) image.values.push_back(inside(random));
                const int margin = open ? kOpenBorder : 0;
                openvdb::CoordBBox box(-margin, -margin, -margin, size[0] - 1 + margin, size[1] - 1 + margin,
                                       size[2] - 1 + margin);
                const auto expected = nodesFromFunction(
                    [&](const Coord& c) {
                        const auto at = [&](int a) { return std::clamp(c[a], 0, size[a] - 1); };
                        return image.values[static_cast<std::size_t>(
                                   at(0) + size[0] * (at(1) + size[1] * at(2)))] > 0.5f;
                    },
                    box);
                ImageStream stream(image, 3);
                const auto found = nodesFromImage(stream, {.iso = 0.5, .openBorder = open});
                expectSame(*found.grid, *expected.grid);
            }
}

template <class T>
std::string rawBytes(const std::vector<T>& values, bool big = false) {
    std::string bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    if (big)
        for (std::size_t i = 0; i < bytes.size(); i += sizeof(T))
            std::reverse(bytes.begin() + long(i), bytes.begin() + long(i + sizeof(T)));
    return bytes;
}

TEST_F(ImageStreamFiles, HoldEveryTypeInEitherByteOrder) {
    const std::array<std::int64_t, 3> size{6, 5, 4};
    const auto check = [&]<class T>(T, const char* type) {
        std::vector<T> values;
        for (int i = 0; i < 120; ++i)
            values.push_back(static_cast<T>((i * 37 % 101) - (std::is_signed_v<T> ? 50 : 0)));
        for (const bool big : {false, true}) {
            const fs::path path = put(folder / "a.raw", "header" + rawBytes(values, big));
            const ImageReadOptions options = rawOptions(size, type, big, 6);
            const Image whole = readImage(path, options);
            ASSERT_EQ(whole.values, std::vector<float>(values.begin(), values.end())) << type << big;
            ImageStream stream(path, options, 3);
            for (const double iso : {-60.0, -0.5, 0.0, 10.0, 10.25, 300.0})
                for (const bool invert : {false, true})
                    expectSame(*nodesFromImage(stream, {.iso = iso, .invert = invert}).grid,
                               *nodesFromImage(whole, {.iso = iso, .invert = invert}).grid);
            for (const double label : {-1.0, 7.0, 7.5, 1e6})
                expectSame(*nodesFromImage(stream, {.label = label}).grid,
                           *nodesFromLabel(whole, label).grid);
            expectSame(*distanceFromImage(stream, {.iso = 10.25}, 4),
                       *distanceFromImage(whole, {.iso = 10.25}, 4));
        }
    };
    check(std::int8_t(), "int8");
    check(std::uint8_t(), "uint8");
    check(std::int16_t(), "int16");
    check(std::uint16_t(), "uint16");
    check(std::int32_t(), "int32");
    check(std::uint32_t(), "uint32");
    check(std::int64_t(), "int64");
    check(std::uint64_t(), "uint64");
    check(float(), "float32");
    check(double(), "float64");
}

TEST_F(ImageStreamFiles, ReadVoxelsFromWhereTheHeaderSays) {
    const auto values = std::vector<std::int16_t>{1, -2, 300, 4, 5, 6, 7, -8};
    const std::string big = rawBytes(values, true);
    const std::vector<float> expected(values.begin(), values.end());
    put(folder / "v.raw", "some text\nand\nthree lines\nxy" + big);
    put(folder / "skip.nhdr",
        "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\nendian: big\nencoding: raw\nline skip: 3\nbyte "
        "skip: 2\n"
        "data file: v.raw\n");
    put(folder / "end.nhdr",
        "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\nendian: big\nencoding: raw\nbyte skip: -1\n"
        "data file: v.raw\n");
    const std::string meta =
        "NDims = 3\nDimSize = 2 2 2\nBinaryDataByteOrderMSB = True\nElementType = MET_SHORT\n";
    put(folder / "end.mhd", meta + "HeaderSize = -1\nElementDataFile = v.raw\n");
    put(folder / "skip.mhd", meta + "HeaderSize = 28\nElementDataFile = v.raw\n");
    for (const char* name : {"skip.nhdr", "end.nhdr", "end.mhd", "skip.mhd"}) {
        EXPECT_EQ(readImage(folder / name).values, expected) << name;
        const auto itk = readItk<itk::Image<float, 3>>(folder / name);
        EXPECT_EQ(itk->GetPixel({{0, 1, 0}}), 300) << name;
    }
}

TEST_F(ImageStreamFiles, CountWhatIsInAnImage) {
    Image image;
    image.size = {31, 17, 11};
    std::mt19937 random(7);
    std::uniform_int_distribution<int> value(-3, 40);
    for (std::int64_t i = 0; i < image.voxelCount(); ++i)
        image.values.push_back(static_cast<float>(value(random)));
    std::vector<float> sorted = image.values;
    std::sort(sorted.begin(), sorted.end());
    const std::set<float> distinct(sorted.begin(), sorted.end());
    for (const std::int64_t slices : {0, 1, 4, 11}) {
        ImageStream stream(image, slices);
        const ImageStatistics found = statisticsOf(stream, 40.0f);
        EXPECT_EQ(found.low, sorted.front());
        EXPECT_EQ(found.high, sorted.back());
        EXPECT_EQ(found.distinct, std::vector<float>(distinct.begin(), distinct.end()));
        EXPECT_TRUE(found.found);
        EXPECT_FALSE(statisticsOf(stream, 41.0f).found);
        ASSERT_EQ(found.percentiles.size(), 7u);
        for (const auto& [percent, v] : found.percentiles)
            EXPECT_EQ(v, sorted[(sorted.size() - 1) * static_cast<std::size_t>(percent) / 100]) << percent;
    }
    for (std::size_t i = 0; i < 65; ++i) image.values[i * 71] = static_cast<float>(100 + i);
    ImageStream many(image);
    EXPECT_TRUE(statisticsOf(many).distinct.empty());
}

TEST_F(ImageStreamFiles, BecomeTheMaskOfSomeValues) {
    Image image;
    image.size = {31, 17, 11};
    for (std::int64_t i = 0; i < image.voxelCount(); ++i)
        image.values.push_back(static_cast<float>(i * i % 7) - 1);
    for (const std::int64_t slices : {0, 1, 4}) {
        ImageStream stream(image, slices);
        stream.takeAsMask({3, -1});
        std::vector<std::uint8_t> mask(image.values.size());
        stream.pass("", {}, [&](const Slab& slab) {
            const auto& values = std::get<std::span<const std::uint8_t>>(slab.voxels);
            std::copy(values.begin(), values.end(), mask.begin() + slab.z0 * 31 * 17);
        });
        for (std::size_t i = 0; i < mask.size(); ++i)
            ASSERT_EQ(mask[i], image.values[i] == 3 || image.values[i] == -1) << i;
    }
}

// ---- what is wrong

std::string lineOf(const std::function<void()>& work) {
    try {
        work();
        return "";
    } catch (const InputError& e) {
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        return e.what();
    }
}

TEST_F(ImageStreamFiles, FindVoxelsThatAreNotFiniteInTheFirstPassWithTheLineOfTheWholeImage) {
    std::vector<float> values(7 * 6 * 30, 1.0f);
    values[800] = std::numeric_limits<float>::quiet_NaN();
    values[1100] = values[1200] = -std::numeric_limits<float>::infinity();
    const fs::path path = put(folder / "a.raw", rawBytes(values));
    const ImageReadOptions options = rawOptions({7, 6, 30}, "float32");
    const std::string expected = refusal(path, options);
    EXPECT_NE(expected.find("voxel (2, 0, 19) is nan, the first of 3"), std::string::npos) << expected;
    for (const std::int64_t slices : {1, 4, 30}) {
        ImageStream a(path, options, slices), b(path, options, slices);
        EXPECT_EQ(lineOf([&] { statisticsOf(a); }), expected);
        EXPECT_EQ(lineOf([&] { nodesFromImage(b, {.iso = 0}); }), expected);
    }
}

TEST_F(ImageStreamFiles, SayHowManyIntegersWereRounded) {
    const std::vector<std::int32_t> values{1, 2, (1 << 24) + 1, 3, -(1 << 26) - 1, 5, 6, 7};
    const fs::path path = put(folder / "a.raw", rawBytes(values));
    const ImageReadOptions options = rawOptions({2, 2, 2}, "int32");
    ImageStream stream(path, options, 1);
    statisticsOf(stream);
    EXPECT_EQ(stream.header().warnings, readImage(path, options).warnings);
    statisticsOf(stream);  // and say it once
    EXPECT_EQ(stream.header().warnings, readImage(path, options).warnings);
    EXPECT_NE(stream.header().warnings.back().find("2 of 8"), std::string::npos);
}

TEST_F(ImageStreamFiles, RefuseEveryTruncationBeforeTheFirstPass) {
    writeItk(blobImage({9, 8, 7}).GetPointer(), folder / "a.nrrd");
    writeItk(blobImage({9, 8, 7}).GetPointer(), folder / "a.mha");
    for (const char* name : {"a.nrrd", "a.mha"}) {
        const std::string bytes = bytesOf(folder / name);
        for (std::size_t length = 0; length < bytes.size(); length += length < 400 ? 7 : 31) {
            const fs::path cut = put(folder / (std::string("cut_") + name), bytes.substr(0, length));
            EXPECT_NE(lineOf([&] { ImageStream stream(cut); }), "") << name << ' ' << length;
        }
    }
}

TEST_F(ImageStreamFiles, SayThatAFileWasCutWhileTheyReadIt) {
    const fs::path path = put(folder / "a.raw", std::string(1000, 'x'));
    ImageStream stream(path, rawOptions({10, 10, 10}, "uint8"), 2);
    statisticsOf(stream);
    fs::resize_file(path, 500);
    EXPECT_NE(lineOf([&] { nodesFromImage(stream, {.iso = 1}); }).find("cut"), std::string::npos);
}

TEST_F(ImageStreamFiles, StopWhenTheyAreToldTo) {
    const fs::path path = put(folder / "a.raw", std::string(64 * 64 * 64, '\1'));
    ImageStream stream(path, rawOptions({64, 64, 64}, "uint8"), 1);
    int asked = 0;
    Progress progress;
    progress.stopRequested = [&] { return ++asked > 3; };
    EXPECT_THROW(statisticsOf(stream, {}, progress), Cancelled);
}

// ---- beyond 2^31 and 2^32 voxels

// A headerless file of n^3 bytes that takes next to no room on the disk: a ball of 200 around `centre`, 0
// elsewhere.
fs::path writeSparseBall(const fs::path& path, std::int64_t n, Coord centre, int radius) {
    std::ofstream(path, std::ios::binary).put(0);
    fs::resize_file(path, static_cast<std::uintmax_t>(n * n * n));
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    for (std::int64_t z = centre.z() - radius; z <= centre.z() + radius; ++z)
        for (std::int64_t y = centre.y() - radius; y <= centre.y() + radius; ++y) {
            const double left = double(radius) * radius - std::pow(double(z - centre.z()), 2) -
                                std::pow(double(y - centre.y()), 2);
            if (left < 0) continue;
            const auto half = static_cast<std::int64_t>(std::sqrt(left));
            file.seekp(centre.x() - half + n * (y + n * z));
            file.write(std::string(static_cast<std::size_t>(2 * half + 1), '\xC8').data(), 2 * half + 1);
        }
    return path;
}

class SparseFiles : public ImageFiles, public testing::WithParamInterface<std::int64_t> {};

TEST_P(SparseFiles, BeyondThirtyTwoBitsGiveTheBallInTheirFarCorner) {
    const std::int64_t n = GetParam();
    const int radius = 15;
    const Coord centre(int(n) - 20, int(n) - 22, int(n) - 19);
    const fs::path path = writeSparseBall(folder / "a.raw", n, centre, radius);
    ImageStream stream(path, rawOptions({n, n, n}, "uint8"));
    const ImageStatistics statistics = statisticsOf(stream, 200.0f);
    EXPECT_EQ(statistics.distinct, (std::vector<float>{0, 200}));
    EXPECT_TRUE(statistics.found);
    const auto inBall = [&](const Coord& c) {
        return double((c - centre).asVec3d().lengthSqr()) <= double(radius) * radius;
    };
    openvdb::CoordBBox box(centre, centre);
    box.expand(radius);
    const auto expected = nodesFromFunction(inBall, box).grid;
    EXPECT_GT(expected->activeVoxelCount(), 3000u);
    expectSame(*nodesFromImage(stream, {.iso = 100}).grid, *expected);
    const auto distance = distanceFromImage(stream, {.iso = 100}, 4);
    for (const int along : {0, 9, 14, 15, 16, 17, 21, 30})
        EXPECT_NEAR(distance->tree().getValue(centre.offsetBy(along, 0, 0)),
                    std::clamp(along - 15.5, -4.0, 4.0), 0.6)
            << along;
}

// 2.2e9 > 2^31 voxels, 4.9e9 > 2^32.
INSTANTIATE_TEST_SUITE_P(Sizes, SparseFiles, testing::Values(1300, 1700));

TEST_F(ImageStreamFiles, RefuseAnAxisBeyondThirtyTwoBits) {
    const std::int64_t n = std::int64_t(1) << 31;
    const fs::path path = put(folder / "a.raw", "x");
    fs::resize_file(path, static_cast<std::uintmax_t>(n));
    EXPECT_NE(lineOf([&] {
                  ImageStream stream(path, rawOptions({1, 1, n}, "uint8"));
              }).find("along an axis"),
              std::string::npos);
}

}  // namespace
}  // namespace isowave
