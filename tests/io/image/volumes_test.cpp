// NumPy arrays, MRC maps and VTK images: what their files say, and what is taken from it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>

#include "io/image/half.h"
#include "tests/io/image/files.h"
#include "tests/io/image/written.h"

namespace isowave {
namespace {

using test::bytes;
using test::MrcFile;
using test::npyFile;
using test::put;
using test::refusal;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pointwise;

using Volumes = test::ImageFiles;

std::vector<std::int16_t> upTo(int n) {
    std::vector<std::int16_t> values;
    for (int i = 0; i < n; ++i) values.push_back(static_cast<std::int16_t>(i));
    return values;
}

// ---- NumPy

// a[i, j, k] = 100 i + 10 j + k of shape (2, 3, 4).
std::vector<std::int16_t> elements(bool fortran) {
    std::vector<std::int16_t> values;
    for (int n = 0; n < 24; ++n) {
        const int i = fortran ? n % 2 : n / 12, j = fortran ? n / 2 % 3 : n / 4 % 3,
                  k = fortran ? n / 6 : n % 4;
        values.push_back(static_cast<std::int16_t>(100 * i + 10 * j + k));
    }
    return values;
}

TEST_F(Volumes, IndicesOfAnArrayAreXYZWhateverItsOrderInTheFile) {
    for (const bool fortran : {false, true})
        for (const bool big : {false, true}) {
            const auto file = npyFile(big ? ">i2" : "<i2", fortran, "2, 3, 4", bytes(elements(fortran), big));
            const Image image = readImage(put(folder / "a.npy", file));
            EXPECT_EQ(image.format, "NumPy");
            EXPECT_EQ(image.componentType, "int16");
            EXPECT_EQ(image.space, Space::unspecified);
            ASSERT_THAT(image.size, ElementsAre(2, 3, 4));
            for (int n = 0; n < 24; ++n) EXPECT_EQ(image.values[n], 100 * (n % 2) + 10 * (n / 2 % 3) + n / 6);
            EXPECT_THAT(image.indexToWorld({1, 2, 3}), ElementsAre(1, 2, 3));
            EXPECT_THAT(image.warnings,
                        ElementsAre(HasSubstr("taken as x, y, z"), HasSubstr("no z spacing")));
        }
}

TEST_F(Volumes, SpacingOfAnArrayIsAlongItsIndices) {
    ImageReadOptions options;
    options.spacing = {0.5, 1, 2};
    const Image image =
        readImage(put(folder / "a.npy", npyFile("<i2", false, "2, 3, 4", bytes(elements(false)))), options);
    EXPECT_THAT(image.indexToWorld({1, 2, 3}), ElementsAre(0.5, 2, 6));
}

TEST_F(Volumes, AFourthIndexOfAnArrayIsTheVolume) {
    // a[i, j, k, t] = 8 i + 4 j + 2 k + t in C order, of shape (2, 2, 2, 2).
    const auto file = npyFile("<i2", false, "2, 2, 2, 2", bytes(upTo(16)));
    EXPECT_THAT(refusal(put(folder / "a.npy", file)), HasSubstr("is a series of 2 volumes"));
    ImageReadOptions second;
    second.volume = 2;
    EXPECT_THAT(readImage(folder / "a.npy", second).values, ElementsAre(1, 9, 5, 13, 3, 11, 7, 15));
    put(folder / "f.npy", npyFile("<i2", true, "2, 2, 2, 2", bytes(upTo(16))));
    EXPECT_THAT(readImage(folder / "f.npy", second).values, ElementsAre(8, 9, 10, 11, 12, 13, 14, 15));
}

TEST_F(Volumes, ElementsOfAnArrayAreNumbersOrBooleans) {
    const auto read = [&](const char* type, const std::string& data) {
        return readImage(put(folder / "a.npy", npyFile(type, true, "2, 1, 1", data)));
    };
    EXPECT_THAT(read("|b1", std::string("\0\1", 2)).values, ElementsAre(0, 1));
    EXPECT_THAT(read("|i1", "\xFF\1").values, ElementsAre(-1, 1));
    EXPECT_THAT(read("<u4", bytes<std::uint32_t>({1, 70000})).values, ElementsAre(1, 70000));
    EXPECT_THAT(read(">i8", bytes<std::int64_t>({-1, 70000}, true)).values, ElementsAre(-1, 70000));
    EXPECT_THAT(read(">f8", bytes<double>({0.5, -1e30}, true)).values, ElementsAre(0.5f, -1e30f));
    EXPECT_THAT(read("<f2", bytes<std::uint16_t>({0x3C00, 0xC100})).values, ElementsAre(1, -2.5f));
    EXPECT_THAT(refusal(put(folder / "c.npy", npyFile("<c8", true, "2, 1, 1", std::string(16, 'x')))),
                HasSubstr("holds elements of type '<c8'"));
    EXPECT_THAT(refusal(put(folder / "d.npy", npyFile("<i2", true, "2, 12", bytes(upTo(24))))),
                HasSubstr("is a 2D image"));
    EXPECT_THAT(refusal(put(folder / "e.npy", npyFile("<i2", true, "24,", bytes(upTo(24))))),
                HasSubstr("has the shape (24,)"));
    const std::string whole = npyFile("<i2", true, "2, 3, 4", bytes(upTo(24)));
    EXPECT_THAT(refusal(put(folder / "g.npy", whole.substr(0, whole.size() - 1))),
                HasSubstr("it is truncated"));
}

// Against the definition: sign, 2^(e - 15), 1 + f / 1024; all 65536 of them.
TEST(Half, IsWhatItsBitsSay) {
    for (int bits = 0; bits < 65536; ++bits) {
        const int e = bits >> 10 & 31, f = bits & 1023;
        const float value = imageio::floatOfHalf(static_cast<std::uint16_t>(bits));
        const double sign = bits & 0x8000 ? -1 : 1;
        if (e == 31)
            EXPECT_TRUE(f ? std::isnan(value) : value == sign * HUGE_VAL) << bits;
        else
            EXPECT_EQ(value, sign * (e ? std::pow(2.0, e - 15) * (1 + f / 1024.0)
                                       : std::pow(2.0, -14) * (f / 1024.0)))
                << bits;
    }
}

// ---- MRC

void expectAt(const Image& image, const std::array<double, 3>& index, const std::array<double, 3>& world) {
    EXPECT_THAT(image.indexToWorld(index), Pointwise(DoubleNear(1e-5), world));
}

TEST_F(Volumes, AMapLiesWhereItsCellAndOriginSay) {
    MrcFile map;
    map.cell = {1, 4.5f, 8};
    map.start = {7, 8, 9};
    map.extended = 80;
    map.voxels = bytes(upTo(24));
    Image image = readImage(put(folder / "a.mrc", map.file()));
    EXPECT_EQ(image.format, "MRC");
    EXPECT_EQ(image.unit, "angstrom");
    EXPECT_EQ(image.space, Space::unspecified);
    EXPECT_THAT(image.warnings, ElementsAre(HasSubstr("in angstrom")));
    EXPECT_EQ(image.values[23], 23);
    expectAt(image, {1, 2, 3}, {4, 15, 24});  // (start + index) * (0.5, 1.5, 2)
    map.origin = {-1, 0, 5};
    expectAt(readImage(put(folder / "a.mrc", map.file())), {1, 2, 3}, {-0.5, 3, 11});
    map.bigEndian = true;
    map.voxels = bytes(upTo(24), true);
    image = readImage(put(folder / "b.map", map.file()));
    EXPECT_EQ(image.values[23], 23);
    expectAt(image, {1, 2, 3}, {-0.5, 3, 11});
    EXPECT_TRUE(isImagePath(put(folder / "noname", map.file())));
}

TEST_F(Volumes, ColumnsRowsAndSectionsOfAMapRunAlongTheEdgesThatItNames) {
    MrcFile map;
    map.axes = {3, 1, 2};  // columns along z, rows along x, sections along y
    map.size = {2, 3, 4};
    map.samples = {3, 4, 2};
    map.cell = {3, 8, 1};
    map.start = {1, 0, 0};  // of columns
    expectAt(readImage(put(folder / "a.mrc", map.file())), {1, 2, 3}, {2, 6, 1});
    map.axes = {3, 3, 2};
    EXPECT_THAT(refusal(put(folder / "b.mrc", map.file())), HasSubstr("is not an MRC map"));
}

// A cell of 90, 90 and 120 degrees: b runs along (-1/2, sqrt(3)/2, 0).
TEST_F(Volumes, ACellOfOtherAnglesIsAShear) {
    MrcFile map;
    map.angles = {90, 90, 120};
    expectAt(readImage(put(folder / "a.mrc", map.file())), {1, 2, 3}, {1 - 1.0, std::sqrt(3.0), 3});
    map.angles = {10, 10, 120};
    EXPECT_THAT(refusal(put(folder / "b.mrc", map.file())), HasSubstr("cell's angles are 10, 10 and 120"));
}

TEST_F(Volumes, ModesOfMaps) {
    const auto read = [&](std::int32_t mode, const std::string& voxels) {
        MrcFile map;
        map.size = {2, 1, 1};
        map.mode = mode;
        map.voxels = voxels;
        return readImage(put(folder / "a.mrc", map.file())).values;
    };
    EXPECT_THAT(read(0, "\xFE\2"), ElementsAre(-2, 2));
    EXPECT_THAT(read(1, bytes<std::int16_t>({-300, 2})), ElementsAre(-300, 2));
    EXPECT_THAT(read(2, bytes<float>({0.25f, -8})), ElementsAre(0.25f, -8));
    EXPECT_THAT(read(6, bytes<std::uint16_t>({60000, 2})), ElementsAre(60000, 2));
    EXPECT_THAT(read(12, bytes<std::uint16_t>({0x3C00, 0xC000})), ElementsAre(1, -2));
    MrcFile map;
    map.mode = 4;
    EXPECT_THAT(refusal(put(folder / "b.mrc", map.file())), HasSubstr("is of mode 4, complex numbers"));
    // IMOD's stamp, without its flag for signed bytes.
    map.mode = 0;
    map.size = {2, 1, 1};
    map.voxels = "\xFE\2";
    std::string file = map.file();
    file.replace(152, 8, bytes<std::int32_t>({1146047817, 0}));
    EXPECT_THAT(readImage(put(folder / "c.mrc", file)).values, ElementsAre(254, 2));
}

TEST_F(Volumes, AStackOfMapsIsChosenFrom) {
    MrcFile map;
    map.size = {1, 1, 4};
    map.samples = {1, 1, 2};
    map.cell = {1, 1, 2};
    map.group = 401;
    map.voxels = bytes(upTo(4));
    EXPECT_THAT(refusal(put(folder / "a.mrc", map.file())), HasSubstr("is a series of 2 volumes"));
    ImageReadOptions second;
    second.volume = 2;
    EXPECT_THAT(readImage(folder / "a.mrc", second).values, ElementsAre(2, 3));
}

TEST_F(Volumes, AMapWithoutACellIsOneAngstrom) {
    MrcFile map;
    map.cell = {};
    const Image image = readImage(put(folder / "a.mrc", map.file()));
    EXPECT_THAT(image.warnings, testing::Contains(HasSubstr("1 x 1 x 1 angstrom is assumed")));
    EXPECT_THAT(refusal(put(folder / "a.rec", "[General]")), HasSubstr("dcm2niix"));
}

// ---- VTK

std::string vtkFile(const std::string& attributes, const std::string& arrays,
                    const std::string& behind = "") {
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" " + attributes +
           ">\n<ImageData WholeExtent=\"1 2 0 2 -1 2\" Origin=\"10 20 30\" Spacing=\"0.5 1 2\">\n"
           "<Piece Extent=\"1 2 0 2 -1 2\">\n" +
           arrays + "</Piece>\n</ImageData>\n" + behind + "</VTKFile>\n";
}

std::string arrayOf(const std::string& attributes, const std::string& data) {
    return "<DataArray type=\"Int16\" " + attributes + ">\n" + data + "\n</DataArray>\n";
}

std::string numbersText(int n) {
    std::string text;
    for (int i = 0; i < n; ++i) text += fmt::format("{} ", i);
    return text;
}

std::string points(const std::string& arrays, const std::string& attributes = "") {
    return "<PointData" + attributes + ">" + arrays + "</PointData>";
}

TEST_F(Volumes, AVtkImageLiesAtItsExtent) {
    const std::string ascii = arrayOf("Name=\"a\" format=\"ascii\"", numbersText(24));
    const Image image =
        readImage(put(folder / "a.vti", vtkFile("byte_order=\"LittleEndian\"", points(ascii))));
    EXPECT_EQ(image.format, "VTK ImageData");
    EXPECT_EQ(image.space, Space::unspecified);
    ASSERT_THAT(image.size, ElementsAre(2, 3, 4));
    for (int i = 0; i < 24; ++i) EXPECT_EQ(image.values[i], i);
    expectAt(image, {0, 0, 0}, {10.5, 20, 28});
    expectAt(image, {1, 2, 3}, {11, 22, 34});
    const std::string cells = arrayOf("Name=\"a\" format=\"ascii\"", numbersText(6));
    const Image inCells = readImage(put(folder / "b.vti", vtkFile("", "<CellData>" + cells + "</CellData>")));
    EXPECT_THAT(inCells.size, ElementsAre(1, 2, 3));
    expectAt(inCells, {0, 0, 0}, {10.75, 20.5, 29});
}

TEST_F(Volumes, AppendedNumbersOfAVtkImage) {
    for (const bool big : {false, true})
        for (const bool wide : {false, true}) {
            const std::string array = arrayOf("Name=\"a\" format=\"appended\" offset=\"3\"", "");
            const std::string length =
                wide ? bytes<std::uint64_t>({48}, big) : bytes<std::uint32_t>({48}, big);
            const std::string attributes =
                fmt::format("byte_order=\"{}\" header_type=\"{}\"", big ? "BigEndian" : "LittleEndian",
                            wide ? "UInt64" : "UInt32");
            const std::string file = vtkFile(
                attributes, points(array),
                "<AppendedData encoding=\"raw\">\n_<&>" + length + bytes(upTo(24), big) + "</AppendedData>");
            const Image image = readImage(put(folder / "a.vti", file));
            for (int i = 0; i < 24; ++i) EXPECT_EQ(image.values[i], i);
        }
}

TEST_F(Volumes, OneArrayOfAVtkImageIsChosen) {
    const std::string a = arrayOf("Name=\"a\" format=\"ascii\"", numbersText(24)),
                      b = arrayOf("Name=\"b\" NumberOfComponents=\"2\" format=\"ascii\"", numbersText(48));
    put(folder / "a.vti", vtkFile("", points(a + b)));
    EXPECT_THAT(refusal(folder / "a.vti"),
                HasSubstr("3 volumes (volume 1: a; volume 2: b[0]; volume 3: b[1])"));
    ImageReadOptions third;
    third.volume = 3;
    const Image image = readImage(folder / "a.vti", third);
    for (int i = 0; i < 24; ++i) EXPECT_EQ(image.values[i], 2 * i + 1);
    third.volume = 4;
    EXPECT_THAT(refusal(folder / "a.vti", third), HasSubstr("holds 3 volumes"));
    const Image active = readImage(put(folder / "b.vti", vtkFile("", points(b + a, " Scalars=\"a\""))));
    EXPECT_EQ(active.values[23], 23);
    EXPECT_THAT(active.warnings, ElementsAre(HasSubstr("its active scalars 'a' are read")));
}

TEST_F(Volumes, DamagedVtkImagesAreRefused) {
    const auto refused = [&](const std::string& file) { return refusal(put(folder / "a.vti", file)); };
    const auto ascii = [&](const std::string& text) {
        return vtkFile("", points(arrayOf("Name=\"a\" format=\"ascii\"", text)));
    };
    EXPECT_THAT(refused(ascii(numbersText(23))), HasSubstr("array 'a' breaks off"));
    EXPECT_THAT(refused(ascii(numbersText(25))), HasSubstr("holds more than 24 numbers"));
    EXPECT_THAT(refused(ascii(numbersText(23) + "70000")), HasSubstr("holds '70000'"));
    EXPECT_THAT(refused("<VTKFile>"), HasSubstr("ends within its XML"));
    EXPECT_THAT(refused("<VTKFile type=\"ImageData\"></a>"), HasSubstr("line 1 of it is no XML"));
    EXPECT_THAT(refused("<VTKFile type=\"PolyData\"><PolyData/></VTKFile>"),
                HasSubstr("expected a VTKFile of ImageData"));
    EXPECT_THAT(refused(vtkFile("compressor=\"vtkLZ4DataCompressor\"", "")),
                HasSubstr("is compressed by vtkLZ4DataCompressor"));
    EXPECT_THAT(refused(vtkFile("", points(""))), HasSubstr("holds no array of numbers"));
    std::string deep = vtkFile("", std::string());
    for (int i = 0; i < 100; ++i) deep.insert(deep.find("<ImageData"), "<a>");
    EXPECT_THAT(refused(deep), HasSubstr("deeper than 64"));
}

}  // namespace
}  // namespace isowave
