// What comes out of each format is what went in.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "isowave/image.h"
#include "tests/gzip.h"
#include "tests/io/image/files.h"
#include "tests/io/image/itk.h"

namespace isowave {
namespace {

namespace fs = std::filesystem;
using test::put;
using testing::ElementsAre;
using testing::HasSubstr;
using Size = std::array<std::int64_t, 3>;

constexpr Size kSize{7, 5, 4};

class ImageFormat : public test::ImageFiles {};

template <class T>
void expectPattern(const Image& image) {
    ASSERT_EQ(image.values.size(), static_cast<std::size_t>(image.voxelCount()));
    for (long z = 0; z < image.size[2]; ++z)
        for (long y = 0; y < image.size[1]; ++y)
            for (long x = 0; x < image.size[0]; ++x)
                ASSERT_EQ(image.values[static_cast<std::size_t>(x + image.size[0] * (y + image.size[1] * z))],
                          static_cast<float>(test::patternAt<T>(x, y, z)))
                    << x << " " << y << " " << z;
}

template <class T>
void roundTrip(const fs::path& path, const std::string& type, const std::string& format,
               bool compress = false) {
    SCOPED_TRACE(path.filename().string() + " " + type);
    test::writeItk(test::patternImage<T>({7, 5, 4}).GetPointer(), path, compress);
    const Image image = readImage(path);
    EXPECT_EQ(image.size, kSize);
    EXPECT_EQ(image.componentType, type);
    EXPECT_EQ(image.integral, std::is_integral_v<T>);
    EXPECT_EQ(image.format, format);
    EXPECT_THAT(image.warnings, ElementsAre());
    expectPattern<T>(image);
}

template <class T>
void roundTripEverywhere(const fs::path& folder, const std::string& type) {
    for (const bool compress : {false, true}) {
        roundTrip<T>(folder / "a.nrrd", type, "NRRD", compress);
        roundTrip<T>(folder / "a.nhdr", type, "NRRD", compress);
        roundTrip<T>(folder / "a.mha", type, "MetaImage", compress);
        roundTrip<T>(folder / "a.mhd", type, "MetaImage", compress);
    }
    roundTrip<T>(folder / "a.nii", type, "NIfTI");
    roundTrip<T>(folder / "a.nii.gz", type, "NIfTI");
}

TEST_F(ImageFormat, EveryIntegerTypeComesBack) {
    roundTripEverywhere<unsigned char>(folder, "uint8");
    roundTripEverywhere<signed char>(folder, "int8");
    roundTripEverywhere<short>(folder, "int16");
    roundTripEverywhere<unsigned short>(folder, "uint16");
    roundTripEverywhere<int>(folder, "int32");
    roundTripEverywhere<unsigned int>(folder, "uint32");
}

TEST_F(ImageFormat, FloatingPointTypesComeBack) {
    roundTripEverywhere<float>(folder, "float32");
    roundTripEverywhere<double>(folder, "float64");
}

// ---- raw

template <class T>
std::string rawBytes(const std::vector<T>& values, bool bigEndian) {
    std::string bytes;
    for (const T v : values) {
        char one[sizeof(T)];
        std::memcpy(one, &v, sizeof(T));
        if (bigEndian) std::reverse(one, one + sizeof(T));
        bytes.append(one, sizeof(T));
    }
    return bytes;
}

template <class T>
void rawRoundTrip(const fs::path& folder, const std::string& type) {
    const std::vector<T> values = {T(1), T(2), T(100), std::numeric_limits<T>::lowest(), T(7), T(120)};
    for (const bool bigEndian : {false, true}) {
        SCOPED_TRACE(type + (bigEndian ? " big-endian" : ""));
        const fs::path path = put(folder / "a.raw", "some header" + rawBytes(values, bigEndian));
        ImageReadOptions options;
        options.raw = RawLayout{{3, 1, 2}, type, bigEndian, 11};
        options.spacing = {{0.5, 0.75, 2}};
        const Image image = readImage(path, options);
        EXPECT_EQ(image.size, (Size{3, 1, 2}));
        EXPECT_EQ(image.componentType, type);
        EXPECT_THAT(image.spacing(), ElementsAre(0.5, 0.75, 2));
        EXPECT_THAT(image.warnings, ElementsAre());
        for (std::size_t i = 0; i < values.size(); ++i)
            EXPECT_EQ(image.values[i], static_cast<float>(values[i]));
    }
}

TEST_F(ImageFormat, RawIsReadInBothByteOrders) {
    rawRoundTrip<std::int8_t>(folder, "int8");
    rawRoundTrip<std::uint8_t>(folder, "uint8");
    rawRoundTrip<std::int16_t>(folder, "int16");
    rawRoundTrip<std::uint16_t>(folder, "uint16");
    rawRoundTrip<std::int32_t>(folder, "int32");
    rawRoundTrip<std::uint32_t>(folder, "uint32");
    rawRoundTrip<std::int64_t>(folder, "int64");
    rawRoundTrip<std::uint64_t>(folder, "uint64");
    rawRoundTrip<float>(folder, "float32");
}

TEST_F(ImageFormat, RawSaysWhatItHadToAssume) {
    const fs::path path = put(folder / "a.raw", std::string(13, 'x'));
    ImageReadOptions options;
    options.raw = RawLayout{{2, 2, 3}, "uint8"};
    EXPECT_THAT(readImage(path, options).warnings, ElementsAre(HasSubstr("holds 1 bytes more than 2 x 2 x 3"),
                                                               HasSubstr("1 x 1 x 1 mm is assumed")));
}

TEST_F(ImageFormat, IntegersBeyondFloat32AreCounted) {
    const std::vector<std::int32_t> values = {16777216, 16777217, 16777218, -16777219};  // 2^24 and on
    const fs::path path = put(folder / "a.raw", rawBytes(values, false));
    ImageReadOptions options;
    options.spacing = {{1, 1, 1}};
    options.raw = RawLayout{{4, 1, 1}, "int32"};
    EXPECT_THAT(readImage(path, options).warnings,
                ElementsAre("2 of 4 int32 voxels are too large for float32 and were rounded"));
}

// ---- TIFF, PNG, BMP and JPEG

template <class T>
void writeSlices(const fs::path& folder, const std::string& extension,
                 const std::vector<std::string>& names) {
    for (std::size_t z = 0; z < names.size(); ++z) {
        const auto slice = test::patternImage<T, 2>({7, 5});
        for (itk::ImageRegionIteratorWithIndex<itk::Image<T, 2>> i(slice, slice->GetLargestPossibleRegion());
             !i.IsAtEnd(); ++i)
            i.Set(test::patternAt<T>(i.GetIndex()[0], i.GetIndex()[1], static_cast<long>(z)));
        test::writeItk(slice.GetPointer(), folder / (names[z] + extension));
    }
}

// slice_10 comes after slice_9; notes beside the slices are left alone.
TEST_F(ImageFormat, SlicesStackInTheOrderOfTheirNumbers) {
    const std::vector<std::string> names = {"s_2", "s_9", "s_10", "s_11", "s_100"};
    for (const std::string extension : {".png", ".tif"}) {
        const fs::path stack = folder / extension.substr(1);
        fs::create_directory(stack);
        writeSlices<unsigned short>(stack, extension, names);
        put(stack / "notes.txt", "seen by nobody");
        const Image image = readImage(stack);
        EXPECT_EQ(image.size, (Size{7, 5, 5}));
        EXPECT_EQ(image.componentType, "uint16");
        EXPECT_EQ(image.format, extension == ".png" ? "PNG slices" : "TIFF slices");
        expectPattern<unsigned short>(image);
    }
}

TEST_F(ImageFormat, SlicesOfBmpAreTheirGreyValues) {
    writeSlices<unsigned char>(folder, ".bmp", {"s_2", "s_9", "s_10"});
    const Image image = readImage(folder);
    EXPECT_EQ(image.size, (Size{7, 5, 3}));
    EXPECT_EQ(image.componentType, "uint8");
    EXPECT_EQ(image.format, "BMP slices");
    EXPECT_THAT(image.warnings, ElementsAre(HasSubstr("no z spacing in BMP slices")));
    expectPattern<unsigned char>(image);
}

// Every value is the one that ITK, by libjpeg as well, decodes.
TEST_F(ImageFormat, SlicesOfJpegAreTheirGreyValuesWithAWarning) {
    writeSlices<unsigned char>(folder, ".jpg", {"s_2", "s_9", "s_10"});
    const Image image = readImage(folder);
    EXPECT_EQ(image.size, (Size{7, 5, 3}));
    EXPECT_EQ(image.componentType, "uint8");
    EXPECT_EQ(image.format, "JPEG slices");
    EXPECT_THAT(image.warnings, testing::UnorderedElementsAre(HasSubstr("JPEG is lossy"),
                                                              HasSubstr("no z spacing in JPEG slices")));
    std::size_t k = 0;
    for (const char* name : {"s_2.jpg", "s_9.jpg", "s_10.jpg"}) {
        using Slice = itk::Image<unsigned char, 2>;
        const auto slice = test::readItk<Slice>(folder / name);
        for (itk::ImageRegionIterator<Slice> i(slice, slice->GetLargestPossibleRegion()); !i.IsAtEnd();
             ++i, ++k)
            ASSERT_EQ(image.values[k], i.Get()) << name << " " << k;
    }
    EXPECT_EQ(k, image.values.size());
}

// A PNG of 4 x 1 pixels with a palette; its colours as 3 bytes each. clear: the first one is.
std::string palettePng(const std::string& colours, const std::string& places, bool clear = false) {
    const auto number = [](std::uint32_t n) {
        std::string bytes;
        for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(n >> shift & 255);
        return bytes;
    };
    const auto chunk = [&](const std::string& name, const std::string& data) {
        const std::string body = name + data;
        const auto sum =
            crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
        return number(static_cast<std::uint32_t>(data.size())) + body +
               number(static_cast<std::uint32_t>(sum));
    };
    const std::string settings{"\x08\x03\0\0\0", 5};
    return "\x89PNG\r\n\x1a\n" + chunk("IHDR", number(4) + number(1) + settings) + chunk("PLTE", colours) +
           (clear ? chunk("tRNS", std::string(1, '\0')) : "") +
           chunk("IDAT", test::deflated(std::string(1, '\0') + places, 15)) + chunk("IEND", "");
}

// As a TIFF with a palette has them. Label pictures were refused as RGB, with the advice to make them grey, which mixes labels up.
TEST_F(ImageFormat, PngWithAPaletteOfColoursHoldsLabels) {
    const std::string colours{"\0\0\0\xff\0\0\0\xff\0\0\0\xff", 12};
    put(folder / "1.png", palettePng(colours, {"\0\1\2\3", 4}));
    put(folder / "2.png", palettePng(colours.substr(0, 9), {"\2\2\1\0", 4}, true));
    const Image image = readImage(folder);
    EXPECT_EQ(image.componentType, "uint8");
    EXPECT_THAT(image.values, ElementsAre(0, 1, 2, 3, 2, 2, 1, 0));
    put(folder / "2.png", palettePng({"\0\0\0\0\xff\0\xff\0\0", 9}, {"\0\1\2\2", 4}));
    EXPECT_THAT(test::refusal(folder), HasSubstr("2.png: has another palette than the first slice, 1.png"));
}

TEST_F(ImageFormat, PngWithAPaletteOfGreysHoldsThem) {
    const std::string greys{"\x64\x64\x64\0\0\0\xc8\xc8\xc8", 9};
    for (const char* name : {"1.png", "2.png"}) put(folder / name, palettePng(greys, {"\0\1\2\0", 4}, true));
    EXPECT_THAT(readImage(folder).values, ElementsAre(100, 0, 200, 100, 100, 0, 200, 100));
}

// Scanners put a preview beside the slices.
TEST_F(ImageFormat, ABmpOrJpegBesideOtherSlicesIsLeftAlone) {
    const std::vector<std::string> names = {"a", "b"};
    writeSlices<unsigned char>(folder, ".png", names);
    test::writeItk(test::patternImage<unsigned char, 2>({9, 9}).GetPointer(), folder / "preview.jpg");
    test::writeItk(test::patternImage<unsigned char, 2>({9, 9}).GetPointer(), folder / "preview.bmp");
    EXPECT_EQ(readImage(folder).format, "PNG slices");
    expectPattern<unsigned char>(readImage(folder));
}

TEST_F(ImageFormat, SlicesMayLieInAFolderBelow) {
    fs::create_directory(folder / "below");
    writeSlices<unsigned char>(folder / "below", ".png", {"a", "b"});
    put(folder / "notes.txt", "seen by nobody");
    EXPECT_EQ(readImage(folder).size, (Size{7, 5, 2}));
    expectPattern<unsigned char>(readImage(folder));
}

TEST_F(ImageFormat, SlicesSayThatTheirHeightIsAssumed) {
    writeSlices<unsigned char>(folder, ".png", {"a", "b"});
    EXPECT_THAT(readImage(folder).warnings,
                ElementsAre(HasSubstr("no z spacing in PNG slices; 1 x 1 x 1 mm is assumed")));
    ImageReadOptions options;
    options.spacing = {{0.5, 0.5, 3}};
    const Image image = readImage(folder, options);
    EXPECT_THAT(image.warnings, ElementsAre());
    EXPECT_THAT(image.spacing(), ElementsAre(0.5, 0.5, 3));
}

TEST_F(ImageFormat, OneSliceInAFolderIsAVolumeOneVoxelThick) {
    writeSlices<unsigned char>(folder, ".png", {"a"});
    EXPECT_EQ(readImage(folder).size, (Size{7, 5, 1}));
}

TEST_F(ImageFormat, PagesOfATiffAreSlices) {
    test::writeItk(test::patternImage<float>({7, 5, 4}).GetPointer(), folder / "a.tif");
    const Image image = readImage(folder / "a.tif");
    EXPECT_EQ(image.size, kSize);
    EXPECT_EQ(image.componentType, "float32");
    EXPECT_THAT(image.warnings, ElementsAre(HasSubstr("no z spacing in TIFF")));
    expectPattern<float>(image);
    expectPattern<float>(readImage(folder));  // alone in its folder it is the volume too
}

TEST_F(ImageFormat, TiffAndPngAreKnownByTheirFirstBytes) {
    test::writeItk(test::patternImage<float>({7, 5, 4}).GetPointer(), folder / "a.tif");
    fs::rename(folder / "a.tif", folder / "volume");
    expectPattern<float>(readImage(folder / "volume"));
    fs::create_directory(folder / "stack");
    writeSlices<unsigned char>(folder / "stack", ".png", {"a", "b", "c", "d"});
    for (const char* name : {"a", "b", "c", "d"})
        fs::rename(folder / "stack" / (std::string(name) + ".png"), folder / "stack" / name);
    expectPattern<unsigned char>(readImage(folder / "stack"));
}

// ---- dimensions

TEST_F(ImageFormat, AVolumeOneVoxelThickIsAVolume) {
    for (const std::string name : {"a.nrrd", "a.mha", "a.nii"}) {
        test::writeItk(test::patternImage<short>({7, 5, 1}).GetPointer(), folder / name);
        EXPECT_EQ(readImage(folder / name).size, (Size{7, 5, 1})) << name;
        test::writeItk(test::patternImage<short>({1, 5, 4}).GetPointer(), folder / name);
        EXPECT_EQ(readImage(folder / name).size, (Size{1, 5, 4})) << name;
    }
}

TEST_F(ImageFormat, AFourthDimensionOfOneIsNone) {
    for (const std::string name : {"a.nrrd", "a.mha", "a.nii"}) {
        test::writeItk(test::patternImage<short, 4>({7, 5, 4, 1}).GetPointer(), folder / name);
        EXPECT_EQ(readImage(folder / name).size, kSize) << name;
        test::writeItk(test::patternImage<short, 4>({7, 5, 4, 2}).GetPointer(), folder / name);
        EXPECT_THAT(test::refusal(folder / name), HasSubstr("is a series of 2 volumes")) << name;
    }
}

TEST_F(ImageFormat, AGivenSpacingReplacesTheFilesAndSaysSo) {
    auto written = test::patternImage<short>({7, 5, 4});
    const double spacing[3] = {0.957031, 0.957031, 1.5};
    written->SetSpacing(spacing);
    test::writeItk(written.GetPointer(), folder / "a.nrrd");
    ImageReadOptions options;
    options.spacing = {{0.957, 0.957, 1.5}};  // the same, as one types it
    EXPECT_THAT(readImage(folder / "a.nrrd", options).warnings, ElementsAre());
    options.spacing = {{0.957, 0.957, 3}};
    const Image image = readImage(folder / "a.nrrd", options);
    EXPECT_THAT(
        image.warnings,
        ElementsAre("the given spacing 0.957 x 0.957 x 3 replaces the file's 0.957031 x 0.957031 x 1.5"));
    EXPECT_EQ(image.spacing()[2], 3);
}

// scl_slope and scl_inter at bytes 112 and 116 of the header.
TEST_F(ImageFormat, NiftiValuesAreScaled) {
    test::writeItk(test::patternImage<short>({7, 5, 4}).GetPointer(), folder / "a.nii");
    std::string bytes = test::bytesOf(folder / "a.nii");
    const float scale[2] = {0.5f, -3.0f};
    std::memcpy(bytes.data() + 112, scale, 8);
    const Image image = readImage(put(folder / "b.nii", bytes));
    EXPECT_EQ(image.componentType, "int16");
    EXPECT_FALSE(image.integral);
    for (long x = 0; x < 7; ++x)
        EXPECT_FLOAT_EQ(image.values[static_cast<std::size_t>(x)],
                        0.5f * test::patternAt<short>(x, 0, 0) - 3);
}

TEST_F(ImageFormat, IsKnownByNameOrContent) {
    for (const char* name : {"a.nii", "a.nii.gz", "a.NRRD", "a.nhdr", "a.mha", "a.mhd", "a.tif", "a.tiff",
                             "a.png", "a.bmp", "a.jpg", "a.JPEG", "a.dcm"})
        EXPECT_TRUE(isImagePath(name)) << name;
    EXPECT_TRUE(isImagePath(folder));
    EXPECT_TRUE(isImagePath(put(folder / "IM0001", std::string(128, '\0') + "DICM")));
    EXPECT_FALSE(isImagePath(put(folder / "part.stl", "solid x")));
    EXPECT_FALSE(isImagePath(folder / "part.obj"));
}

// A slab of 64 MB at a time: progress is told between them, and can stop.
TEST_F(ImageFormat, LargeFilesComeInSlabsAndCanBeStopped) {
    std::ofstream(folder / "a.raw").close();
    fs::resize_file(folder / "a.raw", 200 << 20);  // holes: takes no room
    ImageReadOptions options;
    options.raw = RawLayout{{1024, 1024, 200}, "uint8"};
    int calls = 0;
    Progress progress;
    progress.stopRequested = [&] { return ++calls > 2; };
    EXPECT_THROW(readImage(folder / "a.raw", options, progress), Cancelled);
    calls = -100;
    const Image image = readImage(folder / "a.raw", options, progress);
    EXPECT_EQ(calls, -100 + 5);  // 4 slabs and the end
    EXPECT_EQ(image.voxelCount(), 200 << 20);
}

// MetaImage is the one file format that ITK reads in slabs: what they join to is the whole.
TEST_F(ImageFormat, SlabsJoinToTheWhole) {
    test::writeItk(test::patternImage<short>({300, 300, 500}).GetPointer(),
                   folder / "a.mha");  // 90 MB: 2 slabs
    int reports = 0;
    Progress progress;
    progress.report = [&](std::string_view, double) { ++reports; };
    const Image image = readImage(folder / "a.mha", {}, progress);
    EXPECT_EQ(reports, 3);
    expectPattern<short>(image);
}

}  // namespace
}  // namespace isowave
