// What the headers of NIfTI, NRRD and MetaImage say, and what is taken from it: places, units, scaling, volumes, encodings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gzip.h"
#include "io/image/segments.h"
#include "tests/io/image/files.h"
#include "tests/io/image/written.h"

namespace isowave {
namespace {

namespace fs = std::filesystem;
using test::bytes;
using test::NiftiFile;
using test::put;
using test::refusal;
using testing::AllOf;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pointwise;
using Triple = std::array<double, 3>;

class Headers : public test::ImageFiles {
  protected:
    Image read(const NiftiFile& file, const ImageReadOptions& options = {}) {
        return readImage(put(folder / "a.nii", file.file()), options);
    }
    fs::path nrrd(const std::string& lines, const std::string& voxels) {
        return put(folder / "a.nrrd", test::nrrdFile(lines, voxels));
    }
    fs::path meta(const std::string& lines, const std::string& voxels) {
        return put(folder / "a.mha", lines + "ElementDataFile = LOCAL\n" + voxels);
    }
};

void expectStep(const Image& image, std::size_t axis, const Triple& step) {
    EXPECT_THAT(image.indexToWorld.axis[axis], Pointwise(DoubleNear(1e-6), step));
}

std::string gzip(const std::string& text) { return test::gzipped(text); }
std::string zlib(const std::string& text) { return test::deflated(text, 15); }

// ---- NIfTI: places

// x runs to the left in LPS where it runs to the right in RAS.
TEST_F(Headers, TheSformComesBeforeTheQform) {
    NiftiFile file;
    file.qformCode = file.sformCode = 1;
    file.srow = {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30};
    const Image image = read(file);
    expectStep(image, 0, {-2, 0, 0});
    expectStep(image, 1, {0, -3, 0});
    expectStep(image, 2, {0, 0, 4});
    EXPECT_THAT(image.indexToWorld.origin, ElementsAre(-10, -20, 30));
    EXPECT_THAT(image.warnings, ElementsAre(HasSubstr("its qform puts voxels up to")));
    file.sformCode = 0;
    EXPECT_THAT(read(file).indexToWorld.origin, ElementsAre(0, 0, 0));
    EXPECT_THAT(read(file).warnings, ElementsAre());
}

TEST_F(Headers, ShearIsKept) {
    NiftiFile file;
    file.sformCode = 2;
    file.srow = {1, 0.25, 0, 0, 0, 1, 0.5, 0, 0, 0, 2, 0};
    const Image image = read(file);
    expectStep(image, 1, {-0.25, -1, 0});
    expectStep(image, 2, {0, -0.5, 2});
    EXPECT_THAT(image.warnings, ElementsAre());
}

TEST_F(Headers, NoOrientationIsSaid) {
    NiftiFile file;
    file.pixdim = {1, 2, 3, 4};
    const Image image = read(file);
    expectStep(image, 0, {-2, 0, 0});
    expectStep(image, 1, {0, -3, 0});
    expectStep(image, 2, {0, 0, 4});
    EXPECT_THAT(image.warnings, ElementsAre(HasSubstr("says nothing of its orientation")));
}

// 120 degrees about (1,1,1): x to y, y to z, z to x; pixdim[0] = -1 turns the third axis.
TEST_F(Headers, TheQformTurnsAndMirrors) {
    NiftiFile file;
    file.qformCode = 1;
    file.pixdim = {-1, 2, 3, 4};
    file.quaternion = {0.5, 0.5, 0.5, 0, 0, 0};
    const Image image = read(file);
    expectStep(image, 0, {0, -2, 0});
    expectStep(image, 1, {0, 0, 3});
    expectStep(image, 2, {4, 0, 0});
}

// micrometres and metres; 0 is taken as mm.
TEST_F(Headers, UnitsCountForSpacingAndOrigin) {
    NiftiFile file;
    file.sformCode = 1;
    file.srow = {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30};
    for (const auto& [unit, factor] :
         {std::pair(3, 1e-3), std::pair(2, 1.0), std::pair(0, 1.0), std::pair(1, 1e3),
          std::pair(8 + 3, 1e-3) /* seconds in the other bits */}) {
        file.unit = unit;
        const Image image = read(file);
        EXPECT_NEAR(image.indexToWorld.axis[2][2], 4 * factor, 1e-9 * factor) << unit;
        EXPECT_NEAR(image.indexToWorld.origin[0], -10 * factor, 1e-9 * factor) << unit;
        EXPECT_EQ(image.warnings.size(), factor == 1 ? 0u : 1u) << unit;
    }
}

TEST_F(Headers, WrongSpacingOfAQformIsRefusedAndHealed) {
    NiftiFile file;
    file.qformCode = 1;
    for (const double bad : {0.0, -1.0, std::nan("")}) {
        file.pixdim[2] = bad;
        EXPECT_THAT(refusal(put(folder / "a.nii", file.file())), HasSubstr("its spacing is 1 x "));
        ImageReadOptions options;
        options.spacing = {{1, 2, 3}};
        EXPECT_THAT(read(file, options).spacing(), ElementsAre(1, 2, 3));
        file.sformCode = 1;  // pixdim means nothing beside a sform
        EXPECT_THAT(read(file).spacing(), ElementsAre(1, 1, 1));
        file.sformCode = 0;
    }
}

// ---- NIfTI: values

TEST_F(Headers, ASlopeThatIsNoneMeansNoIntercept) {
    NiftiFile file;
    file.sformCode = 1;
    file.voxels = bytes<std::int16_t>({0, 1, 2, 3, 4, 5, 6, 7});
    const double inf = std::numeric_limits<double>::infinity();
    for (const double slope : {0.0, std::nan(""), inf, -inf}) {
        file.slope = slope;
        file.intercept = 100;
        const Image image = read(file);
        EXPECT_THAT(image.values, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7)) << slope;
        EXPECT_TRUE(image.integral) << slope;
        EXPECT_EQ(image.slope, 1) << slope;
    }
    file.slope = 0.5;
    EXPECT_THAT(read(file).values, ElementsAre(100, 100.5, 101, 101.5, 102, 102.5, 103, 103.5));
    EXPECT_FALSE(read(file).integral);
    file.intercept = std::nan("");
    EXPECT_THAT(refusal(put(folder / "a.nii", file.file())),
                HasSubstr("scl_slope is 0.5 but its scl_inter is nan"));
}

template <class T>
void expectNiftiType(const fs::path& path, int code, const std::string& name) {
    const std::vector<T> values = {T(0), T(1), T(2), T(3), T(100), T(7), std::numeric_limits<T>::max(), T(5)};
    for (const bool second : {false, true})
        for (const bool bigEndian : {false, true})
            for (const bool compressed : {false, true}) {
                NiftiFile file;
                file.sformCode = 1;
                file.type = code;
                file.second = second;
                file.bigEndian = bigEndian;
                file.voxels = bytes(values, bigEndian);
                const Image image = readImage(put(path, compressed ? gzip(file.file()) : file.file()));
                EXPECT_EQ(image.componentType, name);
                for (std::size_t i = 0; i < values.size(); ++i)
                    EXPECT_EQ(image.values[i], static_cast<float>(values[i])) << name << " " << i;
            }
}

// By content: the name is .nii for plain and compressed files.
TEST_F(Headers, EveryNiftiTypeIsReadInBothOrdersAndCompressed) {
    expectNiftiType<std::uint8_t>(folder / "a.nii", 2, "uint8");
    expectNiftiType<std::int16_t>(folder / "a.nii", 4, "int16");
    expectNiftiType<std::int32_t>(folder / "a.nii", 8, "int32");
    expectNiftiType<float>(folder / "a.nii", 16, "float32");
    expectNiftiType<std::int8_t>(folder / "a.nii", 256, "int8");
    expectNiftiType<std::uint16_t>(folder / "a.nii", 512, "uint16");
    expectNiftiType<std::uint32_t>(folder / "a.nii.gz", 768, "uint32");
    expectNiftiType<std::int64_t>(folder / "a.nii.gz", 1024, "int64");
    expectNiftiType<std::uint64_t>(folder / "scan", 1280, "uint64");
    NiftiFile doubles;
    doubles.type = 64;
    doubles.voxels = bytes<double>({0, 0.5, 1, 2, 3, 4, 5, 6});
    EXPECT_EQ(read(doubles).values[1], 0.5f);
    for (const int code : {1, 32, 128, 1536, 1792, 2048, 2304, 77}) {
        doubles.type = code;
        EXPECT_THAT(refusal(put(folder / "a.nii", doubles.file())), HasSubstr("expected")) << code;
    }
}

// The NIfTI library takes the plain file for the compressed one.
TEST_F(Headers, ACompressedFileIsReadBesideAPlainOneOfItsName) {
    NiftiFile file;
    file.sformCode = 1;
    file.voxels = bytes<std::int16_t>({0, 1, 2, 3, 4, 5, 6, 7});
    put(folder / "a.nii.gz", gzip(file.file()));
    file.voxels = bytes<std::int16_t>({9, 9, 9, 9, 9, 9, 9, 9});
    put(folder / "a.nii", file.file());
    EXPECT_THAT(readImage(folder / "a.nii.gz").values, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
}

TEST_F(Headers, APairIsReadByEitherName) {
    NiftiFile file;
    file.pair = true;
    file.sformCode = 1;
    file.voxels = "";
    put(folder / "a.hdr", file.file());
    EXPECT_THAT(refusal(folder / "a.hdr"), HasSubstr("a.img, which is missing"));
    put(folder / "a.img", bytes<std::int16_t>({0, 1, 2, 3, 4, 5, 6, 7}));
    for (const char* name : {"a.hdr", "a.img"}) {
        EXPECT_TRUE(isImagePath(folder / name)) << name;
        EXPECT_THAT(readImage(folder / name).values, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7)) << name;
    }
    EXPECT_THAT(voxelFilesOf(folder / "a.hdr"), ElementsAre(folder / "a.img"));
}

// NIfTI's header without its magic word: what NIfTI has put into unused places means nothing.
TEST_F(Headers, AnalyzeImagesHaveASpacingAndNoSides) {
    NiftiFile file;
    file.pair = true;
    file.sformCode = file.qformCode = 1;
    file.pixdim = {-1, 0.5, 1.5, 2};
    file.unit = 3;  // um
    file.slope = 2;
    file.intercept = 7;
    std::string header = file.header().substr(0, 348);
    header.replace(344, 4, std::string(4, '\0'));
    put(folder / "a.hdr", header);
    put(folder / "a.img", bytes<std::int16_t>({0, 1, 2, 3, 4, 5, 6, 7}));
    for (const char* name : {"a.hdr", "a.img"}) {
        const Image image = readImage(folder / name);
        EXPECT_EQ(image.format, "Analyze 7.5");
        EXPECT_EQ(image.space, Space::unspecified);
        EXPECT_THAT(image.values, ElementsAre(0, 2, 4, 6, 8, 10, 12, 14));
        EXPECT_THAT(image.indexToWorld.origin, ElementsAre(0, 0, 0));
        expectStep(image, 0, {0.5, 0, 0});
        expectStep(image, 1, {0, -1.5, 0});
        expectStep(image, 2, {0, 0, 2});
        EXPECT_THAT(image.warnings, ElementsAre(HasSubstr("nothing certain of its orientation")));
    }
    EXPECT_THAT(voxelFilesOf(folder / "a.hdr"), ElementsAre(folder / "a.img"));
    EXPECT_THAT(refusal(put(folder / "a.nii", header)), HasSubstr("is not a NIfTI image"));
}

TEST_F(Headers, AFileSaysWhetherItKnowsLeftAndRight) {
    NiftiFile file;
    EXPECT_EQ(read(file).space, Space::unspecified);
    file.sformCode = 1;
    EXPECT_EQ(read(file).space, Space::lps);
    const std::string start = "type: uint8\ndimension: 3\nsizes: 2 1 2\nencoding: raw\n", voxels = "\1\2\3\4";
    const std::string directions = "space directions: (1,0,0) (0,1,0) (0,0,1)\n";
    EXPECT_EQ(readImage(nrrd(start, voxels)).space, Space::unspecified);
    EXPECT_EQ(readImage(nrrd(start + "space dimension: 3\n" + directions, voxels)).space, Space::unspecified);
    EXPECT_EQ(readImage(nrrd(start + "space: scanner-xyz\n" + directions, voxels)).space, Space::unspecified);
    EXPECT_EQ(readImage(nrrd(start + "space: RAS\n" + directions, voxels)).space, Space::lps);
    ImageReadOptions raw;
    raw.raw = RawLayout{{2, 1, 2}, "uint8"};
    EXPECT_EQ(readImage(put(folder / "a.raw", voxels), raw).space, Space::unspecified);
}

// ---- gzip around a whole file

TEST_F(Headers, GzipAroundAnyOfThemIsInflated) {
    const std::string lines =
        "type: uint8\ndimension: 3\nsizes: 2 1 2\nspace: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n";
    const std::string raw = test::nrrdFile(lines + "encoding: raw\n", "\1\2\3\4");
    EXPECT_THAT(readImage(put(folder / "a.nrrd.gz", gzip(raw))).values, ElementsAre(1, 2, 3, 4));
    const std::string mha =
        "ObjectType = Image\nNDims = 3\nDimSize = 2 1 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
    EXPECT_THAT(readImage(put(folder / "a.mha.gz", gzip(mha + "\1\2\3\4"))).values, ElementsAre(1, 2, 3, 4));
    EXPECT_TRUE(isImagePath(folder / "a.mha.gz"));
    put(folder / "a.raw", "\1\2\3\4");
    const std::string detached = gzip(test::nrrdFile(lines + "encoding: raw\ndata file: a.raw\n", ""));
    EXPECT_THAT(readImage(put(folder / "a.nhdr.gz", detached)).values, ElementsAre(1, 2, 3, 4));
    // Twice: the header is read, the voxels are not.
    const std::string twice = test::nrrdFile(lines + "encoding: gzip\n", gzip("\1\2\3\4"));
    EXPECT_THAT(refusal(put(folder / "b.nrrd.gz", gzip(twice))), HasSubstr("gunzip it first"));
    const std::string skipping = test::nrrdFile(lines + "encoding: raw\nbyte skip: -1\n", "\1\2\3\4");
    EXPECT_THAT(refusal(put(folder / "c.nrrd.gz", gzip(skipping))), HasSubstr("gunzip it first"));
    EXPECT_THAT(refusal(put(folder / "a.tif.gz", gzip("II*"))), HasSubstr("gunzip it first"));
    const std::string packed = gzip(raw);
    for (std::size_t length = 1; length < packed.size(); ++length)
        EXPECT_NE(refusal(put(folder / "cut.nrrd.gz", packed.substr(0, length))), "") << length;
}

// ---- volumes

TEST_F(Headers, OneOfSeveralVolumesIsChosen) {
    NiftiFile file;
    file.size = {2, 1, 2, 3};
    file.sformCode = 1;
    file.voxels = bytes<std::int16_t>({0, 1, 2, 3, 10, 11, 12, 13, 20, 21, 22, 23});
    const fs::path path = put(folder / "a.nii", file.file());
    put(folder / "b.nii.gz", gzip(file.file()));
    EXPECT_THAT(refusal(path), HasSubstr("is a series of 3 volumes; choose one with --volume, 1 to 3"));
    ImageReadOptions options;
    options.volume = 2;
    EXPECT_THAT(readImage(path, options).values, ElementsAre(10, 11, 12, 13));
    options.volume = 3;
    EXPECT_THAT(readImage(folder / "b.nii.gz", options).values, ElementsAre(20, 21, 22, 23));
    options.volume = 4;
    EXPECT_THAT(refusal(path, options), HasSubstr("holds 3 volumes, 1 to 3; --volume says 4"));
    options.volume = 0;
    EXPECT_THAT(refusal(path, options), HasSubstr("holds 3 volumes, 1 to 3; --volume says 0"));
    file.size = {2, 3, 2};
    EXPECT_THAT(refusal(put(folder / "c.nii", file.file()), options), HasSubstr("holds one volume"));
}

const std::string kLayers =
    "type: uchar\ndimension: 4\nsizes: 2 2 1 2\nendian: little\nspace: LPS\nspace directions: none (1,0,0) "
    "(0,1,0) "
    "(0,0,1)\nspace origin: (0,0,0)\nkinds: list domain domain domain\nSegment0_Name:=liver\n"
    "Segment0_LabelValue:=1\nSegment0_Layer:=0\nSegment1_Name:=left kidney\nSegment1_LabelValue:=5\n"
    "Segment1_Layer:=1\n";

TEST_F(Headers, SegmentsHaveNamesLabelsColoursAndLayers) {
    const fs::path path =
        nrrd(kLayers +
                 "Segment0_Color:=0.5 0 1\nSegment1_Color:=0.5 0 1.5\nSegment2_Name:=\x07 odd\n"
                 "encoding: raw\n",
             std::string(8, '\1'));
    const auto segments = imageio::segmentsOf(path);
    ASSERT_EQ(segments.size(), 3u);
    EXPECT_EQ(segments[0].name, "liver");
    EXPECT_EQ(segments[0].label, 1);
    EXPECT_EQ(segments[0].colour, (std::array<std::uint8_t, 3>{128, 0, 255}));
    EXPECT_EQ(segments[1].name, "left kidney");
    EXPECT_EQ(segments[1].label, 5);
    EXPECT_EQ(segments[1].layer, 1);
    EXPECT_FALSE(segments[1].colour);  // beyond 1
    EXPECT_EQ(segments[2].name.find('\x07'), std::string::npos);
    EXPECT_TRUE(imageio::segmentsOf(folder / "none.nrrd").empty());
    EXPECT_TRUE(imageio::segmentsOf(folder).empty());
}

// Layers lie side by side, a voxel of each.
TEST_F(Headers, LayersOfASegmentationAreNamedAndChosen) {
    const std::string voxels("\x01\x05\x02\x06\x03\x07\x04\x08", 8);
    for (const bool compressed : {false, true}) {
        const fs::path path = nrrd(kLayers + (compressed ? "encoding: gzip\n" : "encoding: raw\n"),
                                   compressed ? gzip(voxels) : voxels);
        EXPECT_THAT(refusal(path),
                    HasSubstr("is a series of 2 volumes (volume 1: liver = 1; volume 2: left kidney "
                              "= 5); choose one with --volume, 1 to 2"));
        ImageReadOptions options;
        options.volume = 1;
        EXPECT_THAT(readImage(path, options).values, ElementsAre(1, 2, 3, 4));
        options.volume = 2;
        EXPECT_THAT(readImage(path, options).values, ElementsAre(5, 6, 7, 8));
    }
}

TEST_F(Headers, AListOfOneIsNone) {
    std::string lines = kLayers + "encoding: raw\n";
    lines.replace(lines.find("sizes: 2 2"), 10, "sizes: 1 2");
    const Image image = readImage(nrrd(lines, "\1\2\3\4"));
    EXPECT_THAT(image.values, ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(image.warnings, ElementsAre(HasSubstr("liver = 1, left kidney = 5")));
    lines.replace(lines.find("kinds: list"), 11, "kinds: RGB-color");
    EXPECT_EQ(refusal(nrrd(lines, "\1\2\3\4")), "");
    lines.replace(lines.find("sizes: 1 2"), 10, "sizes: 3 2");
    EXPECT_THAT(refusal(nrrd(lines, std::string(12, 'x'))), HasSubstr("holds RGB voxels of 3 numbers"));
}

// ---- NRRD

const std::string kNrrd = "type: int16\ndimension: 3\nsizes: 2 1 2\nendian: little\n";

TEST_F(Headers, SpaceUnitsCountForDirectionsAndOrigin) {
    const std::string voxels = bytes<std::int16_t>({1, 2, 3, 4});
    const std::string place =
        "encoding: raw\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)\n";
    for (const auto& [unit, factor] : {std::pair("um", 1e-3), std::pair("mm", 1.0), std::pair("m", 1e3),
                                       std::pair("microns", 1e-3), std::pair("\u00b5m", 1e-3)}) {
        const std::string units =
            fmt::format("space: left-posterior-superior\nspace units: \"{0}\" \"{0}\" \"{0}\"\n", unit);
        const Image image = readImage(nrrd(kNrrd + units + place, voxels));
        EXPECT_NEAR(image.indexToWorld.axis[1][1], 3 * factor, 1e-12) << unit;
        EXPECT_NEAR(image.indexToWorld.origin[2], 30 * factor, 1e-12) << unit;
        EXPECT_EQ(image.warnings.size(), factor == 1 ? 0u : 1u) << unit;
    }
    const Image image = readImage(
        nrrd(kNrrd + "space: LPS\nspace units: \"pixels\" \"pixels\" \"pixels\"\n" + place, voxels));
    ASSERT_EQ(image.warnings.size(), 1u);
    EXPECT_THAT(image.warnings[0], HasSubstr("'space units' says 'pixels', which is no length"));
}

TEST_F(Headers, SpacesWithoutSidesAreTakenAsTheyAreAndSaid) {
    const std::string place =
        "encoding: raw\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)\n";
    const std::string voxels = bytes<std::int16_t>({1, 2, 3, 4});
    for (const std::string space : {"space: scanner-xyz\n", "space: 3D-right-handed\n",
                                    "space: 3D-left-handed\n", "space dimension: 3\n"}) {
        const Image image = readImage(nrrd(kNrrd + space + place, voxels));
        EXPECT_THAT(image.indexToWorld.origin, ElementsAre(10, 20, 30)) << space;
        EXPECT_THAT(image.warnings, ElementsAre(HasSubstr("kept as they are"))) << space;
    }
    EXPECT_THAT(refusal(nrrd(kNrrd + "space: upside-down\n" + place, voxels)),
                HasSubstr("'space' says 'upside-down'"));
    EXPECT_THAT(
        refusal(nrrd(kNrrd + "space: LPS\nencoding: raw\nspace directions: (2,0,0) (0,3,0)\n", voxels)),
        HasSubstr("'space directions' has 2 entries for 3 axes"));
}

// Times of a space with time are volumes.
TEST_F(Headers, TimeIsNoAxisOfSpace) {
    const std::string lines =
        "type: uint8\ndimension: 4\nsizes: 2 1 2 2\nencoding: raw\nspace: right-anterior-superior-time\n"
        "space directions: (2,0,0,0) (0,3,0,0) (0,0,4,0) (0,0,0,1)\nspace origin: (10,20,30,0)\n";
    ImageReadOptions options;
    options.volume = 2;
    const Image image = readImage(nrrd(lines, "\1\2\3\4\5\6\7\10"), options);
    EXPECT_THAT(image.values, ElementsAre(5, 6, 7, 8));
    expectStep(image, 1, {0, -3, 0});
    EXPECT_THAT(image.indexToWorld.origin, ElementsAre(-10, -20, 30));
}

TEST_F(Headers, SpacingsAndAxisMinsPlaceWhatHasNoSpace) {
    const std::string voxels = bytes<std::int16_t>({1, 2, 3, 4});
    Image image = readImage(nrrd(kNrrd + "encoding: raw\nspacings: 2 3 4\naxis mins: 10 20 30\n"
                                         "centerings: node node cell\n",
                                 voxels));
    EXPECT_THAT(image.spacing(), ElementsAre(2, 3, 4));
    EXPECT_THAT(image.indexToWorld.origin, ElementsAre(10, 20, 32));
    EXPECT_THAT(image.warnings, ElementsAre(HasSubstr("names no space")));
    image = readImage(nrrd(kNrrd + "encoding: raw\n", voxels));
    EXPECT_THAT(image.warnings,
                ElementsAre(HasSubstr("names no space"), HasSubstr("no x, y, z spacing in NRRD")));
    // It was always z that was said to be missing.
    image = readImage(nrrd(kNrrd + "encoding: raw\nspacings: 2 nan 4\n", voxels));
    EXPECT_THAT(image.spacing(), ElementsAre(2, 1, 4));
    EXPECT_THAT(image.warnings,
                ElementsAre(HasSubstr("names no space"), HasSubstr("no y spacing in NRRD; 2 x 1 x 4 mm")));
}

TEST_F(Headers, EveryNrrdEncodingGivesTheSameVoxels) {
    const std::string voxels = bytes<std::int16_t>({1, -2, 300, 4});
    const auto expect = [&](const std::string& lines, const std::string& data) {
        EXPECT_THAT(readImage(nrrd(kNrrd + lines, data)).values, ElementsAre(1, -2, 300, 4)) << lines;
    };
    expect("encoding: raw\n", voxels);
    expect("encoding: gzip\n", gzip(voxels));
    expect("encoding: gzip\nbyte skip: 3\n", gzip("abc" + voxels));
    expect("encoding: gzip\nline skip: 1\n", "a line\n" + gzip(voxels));
    expect("encoding: gz\n", gzip(voxels.substr(0, 4)) + gzip(voxels.substr(4)));
    expect("encoding: ascii\n", "1 -2\n 300, 4");
    expect("encoding: text\n", "1 -2 3e2 4.0\n");
    expect("encoding: hex\n", "0100feff\n2C01 0400");
    expect("encoding: raw\nbyte skip: -1\n", "skipped" + voxels);
    EXPECT_THAT(refusal(nrrd(kNrrd + "encoding: ascii\n", "1 -2 300000 4")),
                HasSubstr("number 2 of its voxels is '300000'; expected int16"));
    EXPECT_THAT(refusal(nrrd(kNrrd + "encoding: ascii\n", "1 -2 3oo 4")), HasSubstr("is '3oo'"));
    EXPECT_THAT(refusal(nrrd(kNrrd + "encoding: hex\n", "0100fxff2C010400")), HasSubstr("'x' stands among"));
    EXPECT_THAT(refusal(nrrd("type: int16\ndimension: 3\nsizes: 2 1 2\nencoding: raw\n", voxels)),
                HasSubstr("its header has no 'endian'"));
    std::string damaged = gzip(voxels);
    damaged[damaged.size() - 6] ^= 1;  // of the checksum
    EXPECT_THAT(refusal(nrrd(kNrrd + "encoding: gzip\n", damaged)),
                HasSubstr("its compressed voxels are damaged"));
}

TEST_F(Headers, VoxelsInSeveralFilesAreJoined) {
    put(folder / "s01.raw", bytes<std::int16_t>({1, 2}));
    put(folder / "s03.raw", bytes<std::int16_t>({3, 4}));
    const std::string nrrdStart = "NRRD0005\n" + kNrrd + "encoding: raw\nspacings: 1 1 1\n";
    put(folder / "list.nhdr", nrrdStart + "data file: LIST\ns01.raw\ns03.raw\n");
    put(folder / "pattern.nhdr", nrrdStart + "data file: s%02d.raw 1 3 2\n");
    const std::string metaStart =
        "ObjectType = Image\nNDims = 3\nDimSize = 2 1 2\nElementSpacing = 1 1 1\nElementType = MET_SHORT\n";
    put(folder / "list.mhd", metaStart + "ElementDataFile = LIST\ns01.raw\ns03.raw\n");
    put(folder / "pattern.mhd", metaStart + "ElementDataFile = s%02d.raw 1 3 2\n");
    for (const char* name : {"list.nhdr", "pattern.nhdr", "list.mhd", "pattern.mhd"}) {
        EXPECT_THAT(readImage(folder / name).values, ElementsAre(1, 2, 3, 4)) << name;
        EXPECT_THAT(voxelFilesOf(folder / name), ElementsAre(folder / "s01.raw", folder / "s03.raw")) << name;
    }
    put(folder / "wrong.nhdr", nrrdStart + "data file: s%02d%s.raw 1 3 2\n");
    EXPECT_THAT(refusal(folder / "wrong.nhdr"), HasSubstr("expected one number such as %03d"));
    fs::remove(folder / "s03.raw");
    EXPECT_THAT(refusal(folder / "pattern.mhd"), HasSubstr("s03.raw, which is missing"));
}

// ---- MetaImage

TEST_F(Headers, EveryMetaEncodingGivesTheSameVoxels) {
    const std::string start =
        "ObjectType = Image\nNDims = 3\nDimSize = 2 1 2\nElementSpacing = 1 2 3\nElementType = MET_SHORT\n";
    const std::vector<std::int16_t> values = {1, -2, 300, 4};
    const auto expect = [&](const std::string& lines, const std::string& data) {
        EXPECT_THAT(readImage(meta(start + lines, data)).values, ElementsAre(1, -2, 300, 4)) << lines;
    };
    expect("", bytes(values));
    expect("BinaryData = True\nBinaryDataByteOrderMSB = True\n", bytes(values, true));
    expect("CompressedData = True\n", zlib(bytes(values)));
    expect("BinaryData = False\n", "1 -2 300 4\n");
    expect("HeaderSize = -1\n", "skipped" + bytes(values));
}

TEST_F(Headers, DistanceUnitsOfMetaImageCount) {
    const std::string start =
        "ObjectType = Image\nNDims = 3\nDimSize = 2 1 2\nElementSpacing = 1 2 3\nOffset = 10 20 "
        "30\nDistanceUnits = um\nElementType = MET_UCHAR\n";
    const Image image = readImage(meta(start, "\1\2\3\4"));
    EXPECT_THAT(image.spacing(),
                ElementsAre(DoubleNear(1e-3, 1e-15), DoubleNear(2e-3, 1e-15), DoubleNear(3e-3, 1e-15)));
    EXPECT_THAT(image.indexToWorld.origin, ElementsAre(0.01, 0.02, 0.03));
    EXPECT_THAT(image.warnings, ElementsAre(HasSubstr("lengths are in um")));
}

// ---- MGH

// 2 x 4 x 6 voxels; c_ras is where voxel (1, 2, 3), half the size, lies.
TEST_F(Headers, MghImagesLieAroundTheirMiddle) {
    std::string header(284, '\0');
    header.replace(0, 30, bytes<std::int32_t>({1, 2, 4, 6, 1, 4, 0}, true) + bytes<std::int16_t>({1}, true));
    header.replace(30, 60, bytes<float>({0.5, 1, 2, -1, 0, 0, 0, 0, -1, 0, 1, 0, 10, 20, 30}, true));
    std::vector<std::int16_t> values(48);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::int16_t>(i);
    const std::string file = header + bytes(values, true);
    for (const char* name : {"a.mgh", "a.mgz"}) {
        const Image image = readImage(put(folder / name, name[4] == 'z' ? gzip(file) : file));
        EXPECT_EQ(image.format, "MGH");
        EXPECT_THAT(image.indexToWorld({1, 2, 3}), ElementsAre(-10, -20, 30)) << name;
        expectStep(image, 0, {0.5, 0, 0});
        expectStep(image, 1, {0, 0, -1});
        expectStep(image, 2, {0, -2, 0});
        EXPECT_EQ(image.values[47], 47);
    }
    for (std::size_t length = 1; length < file.size(); ++length)
        EXPECT_NE(refusal(put(folder / "cut.mgh", file.substr(0, length))), "") << length;
}

// ---- formats that are not read

TEST_F(Headers, ForeignFilesAreNamedWithWhatToDo) {
    const auto expect = [&](const std::string& name, const std::string& content, const std::string& part) {
        EXPECT_THAT(refusal(put(folder / name, content)), HasSubstr(part)) << name;
    };
    std::string inr =
        "#INRIMAGE-4#{\nXDIM=4\nYDIM=3\nZDIM=2\nVDIM=1\nTYPE=unsigned fixed\nPIXSIZE=8 bits\nCPU=decm\n"
        "VX=0.5\nVY=1\nVZ=2\n";
    inr.resize(252, '\n');
    expect("a.inr", inr + "##}\n" + std::string(24, 'x'),
           "--size 4x3x2 --type uint8 --header-bytes 256 --spacing 0.5x1x2");
    expect("part.step", "ISO-10303-21;", "gmsh");
    expect("part.amf", "<amf", "assimp export");
    expect("b.mnc", "x", "mnc2nii");
    expect("b.zip", "PK", "unzip");
    expect("b.iwc", "ISOWAVEC", "isowave curves");
    expect("b.h5", "x", "h5dump");
    expect("b.raw.gz", "x", "gunzip");
    expect("b.am", "# AmiraMesh", "NRRD");
    expect("b.vts", "<VTKFile>", "ParaView");
    expect("b.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n", "meshio convert");
    fs::create_directory(folder / "gif");
    put(folder / "gif" / "1.gif", "GIF89a");
    EXPECT_THAT(refusal(folder / "gif"), AllOf(HasSubstr("holds 1 slices as .gif"), HasSubstr("mogrify")));
    fs::create_directory(folder / "gz");
    put(folder / "gz" / "1.tif.gz", gzip("II*"));
    EXPECT_THAT(refusal(folder / "gz"),
                AllOf(HasSubstr("holds 1 files compressed by gzip"), HasSubstr("/*.gz")));
}

// ---- any format

TEST_F(Headers, ContentWinsOverAWrongName) {
    NiftiFile file;
    file.sformCode = 1;
    for (const char* name : {"a.nrrd", "a.mha", "a"})
        EXPECT_EQ(readImage(put(folder / name, file.file())).format, "NIfTI");
    put(folder / "b.nii", test::nrrdFile(kNrrd + "encoding: raw\n", bytes<std::int16_t>({1, 2, 3, 4})));
    EXPECT_EQ(readImage(folder / "b.nii").format, "NRRD");
}

TEST_F(Headers, NanIsTakenAsWhatIsGiven) {
    NiftiFile file;
    file.sformCode = 1;
    file.type = 16;
    file.voxels = bytes<float>({1, std::nanf(""), 3, 4, 5, 6, 7, 8});
    EXPECT_THAT(refusal(put(folder / "a.nii", file.file())), HasSubstr("voxel (1, 0, 0) is nan"));
    ImageReadOptions options;
    options.nan = -1000;
    EXPECT_THAT(read(file, options).values, ElementsAre(1, -1000, 3, 4, 5, 6, 7, 8));
    EXPECT_EQ(read(file, options).componentType, "float32");
    file.voxels = bytes<float>({1, std::numeric_limits<float>::infinity(), 3, 4, 5, 6, 7, 8});
    EXPECT_THAT(refusal(put(folder / "a.nii", file.file()), options), HasSubstr("is inf"));
}

}  // namespace
}  // namespace isowave
