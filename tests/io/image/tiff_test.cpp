// TIFF files as programs of microscopy and tomography write them; these are made by libtiff.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiffio.h>

#include <cstring>
#include <random>

#include "isowave/image.h"
#include "tests/io/image/files.h"

namespace isowave {
namespace {

namespace fs = std::filesystem;
using test::put;
using test::refusal;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using Size = std::array<std::int64_t, 3>;

constexpr std::uint32_t kWidth = 21, kHeight = 18;

struct Page {
    std::uint32_t width = kWidth, height = kHeight;
    int bits = 8, format = SAMPLEFORMAT_UINT, photometric = PHOTOMETRIC_MINISBLACK;
    std::string bytes;  // rows of whole bytes
    std::uint32_t kind = 0;
};

struct Way {
    const char* mode = "w";  // w8: BigTIFF, wb: big-endian
    int compression = COMPRESSION_NONE;
    bool tiled = false;
    std::string description = {};
    std::array<float, 2> perUnit{0, 0};
    int unit = RESUNIT_NONE;
};

class TiffWriter {
  public:
    TiffWriter(const fs::path& path, const Way& way)
        : way_(way), tiff_(TIFFOpen(path.c_str(), way.mode), TIFFClose) {}

    void add(const Page& page) {
        TIFF* const t = tiff_.get();
        TIFFSetField(t, TIFFTAG_IMAGEWIDTH, page.width);
        TIFFSetField(t, TIFFTAG_IMAGELENGTH, page.height);
        TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, page.bits);
        TIFFSetField(t, TIFFTAG_SAMPLEFORMAT, page.format);
        TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(t, TIFFTAG_PHOTOMETRIC, page.photometric);
        TIFFSetField(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
        TIFFSetField(t, TIFFTAG_COMPRESSION, way_.compression);
        TIFFSetField(t, TIFFTAG_SUBFILETYPE, page.kind);
        if (page.photometric == PHOTOMETRIC_PALETTE) {
            std::vector<std::uint16_t> map(std::size_t(1) << page.bits, 7);
            TIFFSetField(t, TIFFTAG_COLORMAP, map.data(), map.data(), map.data());
        }
        if (way_.perUnit[0] > 0) {
            TIFFSetField(t, TIFFTAG_XRESOLUTION, way_.perUnit[0]);
            TIFFSetField(t, TIFFTAG_YRESOLUTION, way_.perUnit[1]);
            TIFFSetField(t, TIFFTAG_RESOLUTIONUNIT, way_.unit);
        }
        if (!way_.description.empty() && pages_++ == 0)
            TIFFSetField(t, TIFFTAG_IMAGEDESCRIPTION, way_.description.c_str());
        way_.tiled ? putTiles(page) : putRows(page);
        ASSERT_TRUE(TIFFWriteDirectory(t));
    }

  private:
    std::size_t rowBytes(const Page& page) const {
        return (page.width * static_cast<std::size_t>(page.bits) + 7) / 8;
    }
    void putRows(const Page& page) {
        TIFFSetField(tiff_.get(), TIFFTAG_ROWSPERSTRIP, 5);
        for (std::uint32_t y = 0; y < page.height; ++y) {
            std::string row = page.bytes.substr(y * rowBytes(page), rowBytes(page));
            ASSERT_EQ(TIFFWriteScanline(tiff_.get(), row.data(), y, 0), 1);
        }
    }
    // Tiles of 16 x 16: the last ones stick out.
    void putTiles(const Page& page) {
        TIFFSetField(tiff_.get(), TIFFTAG_TILEWIDTH, 16);
        TIFFSetField(tiff_.get(), TIFFTAG_TILELENGTH, 16);
        const std::size_t each = static_cast<std::size_t>(page.bits) / 8;
        for (std::uint32_t top = 0; top < page.height; top += 16) {
            for (std::uint32_t left = 0; left < page.width; left += 16) {
                std::string tile(16 * 16 * each, '\0');
                for (std::uint32_t y = 0; y < std::min(16u, page.height - top); ++y)
                    std::memcpy(&tile[y * 16 * each], &page.bytes[((top + y) * page.width + left) * each],
                                std::min(16u, page.width - left) * each);
                ASSERT_GT(TIFFWriteTile(tiff_.get(), tile.data(), left, top, 0, 0), 0);
            }
        }
    }

    Way way_;
    int pages_ = 0;
    std::unique_ptr<TIFF, void (*)(TIFF*)> tiff_;
};

void write(const fs::path& path, const std::vector<Page>& pages, const Way& way = {}) {
    fs::remove(path);
    TiffWriter writer(path, way);
    for (const Page& page : pages) writer.add(page);
}

// A whole number from -60 to 60 (unsigned: 0 to 120), different for neighbours and pages.
int valueAt(std::int64_t x, std::int64_t y, std::int64_t z, bool isSigned) {
    return static_cast<int>((7 * x + 13 * y + 29 * z) % 121) - (isSigned ? 60 : 0);
}

template <class T>
Page pageOf(std::int64_t z, int format, double scale = 1) {
    Page page;
    page.bits = 8 * sizeof(T);
    page.format = format;
    for (std::uint32_t y = 0; y < kHeight; ++y) {
        for (std::uint32_t x = 0; x < kWidth; ++x) {
            const T value = static_cast<T>(scale * valueAt(x, y, z, std::is_signed_v<T>));
            page.bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
        }
    }
    return page;
}

Page plain(std::int64_t z) { return pageOf<std::uint16_t>(z, SAMPLEFORMAT_UINT); }

std::vector<Page> plainPages(std::int64_t count) {
    std::vector<Page> pages;
    for (std::int64_t z = 0; z < count; ++z) pages.push_back(plain(z));
    return pages;
}

// That slice k of the image is page first + k * step of plainPages().
void expectPages(const Image& image, std::int64_t first, std::int64_t step) {
    for (std::int64_t z = 0; z < image.size[2]; ++z)
        for (std::int64_t y = 0; y < kHeight; ++y)
            for (std::int64_t x = 0; x < kWidth; ++x)
                ASSERT_EQ(image.values[static_cast<std::size_t>(x + kWidth * (y + kHeight * z))],
                          valueAt(x, y, first + step * z, false))
                    << x << " " << y << " " << z;
}

class TiffVolume : public test::ImageFiles {
  protected:
    fs::path file() const { return folder / "a.tif"; }
};

// ---- numbers

std::vector<Way> ways() {
    std::vector<Way> all;
    for (const char* mode : {"w", "wb", "w8"})
        for (const int code : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE,
                               COMPRESSION_PACKBITS, COMPRESSION_ZSTD})
            for (const bool tiled : {false, true})
                if (TIFFIsCODECConfigured(static_cast<std::uint16_t>(code)))
                    all.push_back({mode, code, tiled});
    return all;
}

template <class T>
void expectNumbers(const fs::path& path, int format, const std::string& type, double scale = 1) {
    for (const Way& way : ways()) {
        SCOPED_TRACE(type + " " + way.mode + " " + std::to_string(way.compression) +
                     (way.tiled ? " tiled" : ""));
        write(path, {pageOf<T>(0, format, scale), pageOf<T>(1, format, scale)}, way);
        const Image image = readImage(path);
        ASSERT_EQ(image.size, (Size{kWidth, kHeight, 2}));
        EXPECT_EQ(image.componentType, type);
        EXPECT_EQ(image.integral, std::is_integral_v<T>);
        for (std::int64_t k = 0; k < image.voxelCount(); ++k) {
            const std::int64_t x = k % kWidth, y = k / kWidth % kHeight, z = k / kWidth / kHeight;
            ASSERT_EQ(image.values[static_cast<std::size_t>(k)],
                      static_cast<float>(static_cast<T>(scale * valueAt(x, y, z, std::is_signed_v<T>))));
        }
    }
}

TEST_F(TiffVolume, HoldsNumbersOfEveryTypeInEveryWay) {
    expectNumbers<std::uint8_t>(file(), SAMPLEFORMAT_UINT, "uint8");
    expectNumbers<std::int8_t>(file(), SAMPLEFORMAT_INT, "int8");
    expectNumbers<std::uint16_t>(file(), SAMPLEFORMAT_UINT, "uint16", 500);
    expectNumbers<std::int16_t>(file(), SAMPLEFORMAT_INT, "int16", 500);
    expectNumbers<std::uint32_t>(file(), SAMPLEFORMAT_UINT, "uint32", 70000);
    expectNumbers<std::int32_t>(file(), SAMPLEFORMAT_INT, "int32", 70000);
    expectNumbers<float>(file(), SAMPLEFORMAT_IEEEFP, "float32", 0.37);
    expectNumbers<double>(file(), SAMPLEFORMAT_IEEEFP, "float64", 0.37);
}

// 0, 1, -2, 65504 (the largest), 2^-24 (the smallest), 1/3 rounded to 0x3555.
TEST_F(TiffVolume, HalvesBecomeFloats) {
    const std::vector<std::uint16_t> halves{0, 0x3c00, 0xc000, 0x7bff, 1, 0x3555};
    Page page;
    page.width = 3;
    page.height = 2;
    page.bits = 16;
    page.format = SAMPLEFORMAT_IEEEFP;
    page.bytes.assign(reinterpret_cast<const char*>(halves.data()), 12);
    for (const char* mode : {"w", "wb"}) {
        Way way;
        way.mode = mode;
        write(file(), {page, page}, way);
        const Image image = readImage(file());
        EXPECT_EQ(image.componentType, "float32");
        EXPECT_THAT(std::vector<float>(image.values.begin(), image.values.begin() + 6),
                    ElementsAre(0.0f, 1.0f, -2.0f, 65504.0f, std::ldexp(1.0f, -24), 1365 / 4096.0f));
    }
}

TEST_F(TiffVolume, OneBitIsAMask) {
    Page page;
    page.bits = 1;
    page.width = 10;
    page.height = 2;
    page.bytes = std::string("\xa5\x40\xff\x80", 4);  // 10100101 01, 11111111 10
    for (const int code : {COMPRESSION_NONE, COMPRESSION_CCITTFAX4, COMPRESSION_LZW}) {
        Way way;
        way.compression = code;
        write(file(), {page, page}, way);
        const Image image = readImage(file());
        EXPECT_EQ(image.componentType, "uint8");
        EXPECT_THAT(std::vector<float>(image.values.begin(), image.values.begin() + 20),
                    ElementsAre(1, 0, 1, 0, 0, 1, 0, 1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0));
    }
}

TEST_F(TiffVolume, PlacesInAPaletteAreLabels) {
    Page page = pageOf<std::uint8_t>(0, SAMPLEFORMAT_UINT);
    page.photometric = PHOTOMETRIC_PALETTE;
    write(file(), {page, page});
    const Image image = readImage(file());
    EXPECT_TRUE(image.integral);
    expectPages(image, 0, 0);
}

TEST_F(TiffVolume, SaysWhereZeroIsWhite) {
    Page page = pageOf<std::uint8_t>(0, SAMPLEFORMAT_UINT);
    page.photometric = PHOTOMETRIC_MINISWHITE;
    write(file(), {page, page});
    const Image image = readImage(file());
    expectPages(image, 0, 0);
    EXPECT_THAT(image.warnings, testing::Contains(HasSubstr("0 is white")));
}

// ---- voxel sizes

TEST_F(TiffVolume, HasTheVoxelSizeOfImageJ) {
    const std::pair<const char*, double> units[] = {{"mm", 1},           {"micron", 1e-3}, {"\\u00B5m", 1e-3},
                                                    {"\xc2\xb5m", 1e-3}, {"um", 1e-3},     {"nm", 1e-6},
                                                    {"cm", 10},          {"inch", 25.4}};
    for (const auto& [unit, millimetres] : units) {
        SCOPED_TRACE(unit);
        Way way;
        way.description = std::string("ImageJ=1.53t\nimages=3\nslices=3\nunit=") + unit + "\nspacing=1.5\n";
        way.perUnit = {4, 2};
        write(file(), plainPages(3), way);
        const Image image = readImage(file());
        const auto spacing = image.spacing();
        EXPECT_NEAR(spacing[0], millimetres / 4, 1e-9 * millimetres);
        EXPECT_NEAR(spacing[1], millimetres / 2, 1e-9 * millimetres);
        EXPECT_NEAR(spacing[2], millimetres * 1.5, 1e-9 * millimetres);
        EXPECT_THAT(image.warnings, ElementsAre());
        expectPages(image, 0, 1);
    }
}

TEST_F(TiffVolume, SaysWhereImageJHasNoUnit) {
    Way way;
    way.description = "ImageJ=1.53t\nimages=3\nslices=3\nunit=pixel\nspacing=2.0\n";
    write(file(), plainPages(3), way);
    const Image image = readImage(file());
    EXPECT_THAT(image.spacing(), ElementsAre(1, 1, 2));
    EXPECT_THAT(image.warnings,
                ElementsAre(HasSubstr("'pixel', which is no unit of length; mm are assumed")));
}

std::string ome(const std::string& pixels, const std::string& inside = "") {
    return "<?xml version=\"1.0\"?><OME xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\"><Image "
           "ID=\"Image:0\">"
           "<Pixels " +
           pixels + ">" + inside + "</Pixels></Image></OME>";
}

TEST_F(TiffVolume, HasTheVoxelSizeOfOme) {
    Way way;
    way.description =
        ome("DimensionOrder='XYZCT' SizeZ='3' SizeC='1' SizeT='1' PhysicalSizeX='250' PhysicalSizeXUnit='nm' "
            "PhysicalSizeY='0.5' PhysicalSizeZ='0.0015' PhysicalSizeZUnit='mm'");
    write(file(), plainPages(3), way);
    const Image image = readImage(file());
    const auto spacing = image.spacing();
    EXPECT_NEAR(spacing[0], 250e-6, 1e-15);
    EXPECT_NEAR(spacing[1], 0.5e-3, 1e-15);  // micrometres where no unit is said
    EXPECT_NEAR(spacing[2], 1.5e-3, 1e-15);
    EXPECT_THAT(image.warnings, ElementsAre());
}

// ---- channels and times

struct Choice {
    std::optional<std::int64_t> channel, time;
};

Image readChosen(const fs::path& path, const Choice& choice) {
    ImageReadOptions options;
    options.channel = choice.channel;
    options.time = choice.time;
    return readImage(path, options);
}

TEST_F(TiffVolume, ChannelsAndTimesOfImageJAreChosenNeverStacked) {
    Way way;
    way.description = "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\n";
    write(file(), plainPages(12), way);
    EXPECT_THAT(refusal(file()),
                HasSubstr("holds 2 channels and 2 times of 3 slices; choose one with --channel "
                          "1 to 2 and --time 1 to 2"));
    EXPECT_NE(refusal(file(), {.channel = 1}), "");
    for (const std::int64_t c : {1, 2}) {
        for (const std::int64_t t : {1, 2}) {
            const Image image = readChosen(file(), {c, t});
            ASSERT_EQ(image.size[2], 3);
            expectPages(image, (c - 1) + 6 * (t - 1), 2);  // channel fastest, then slice, then time
        }
    }
    EXPECT_THAT(refusal(file(), {.channel = 3, .time = 1}), HasSubstr("has no channel 3; it holds 2"));
}

TEST_F(TiffVolume, ChannelsOfOmeFollowItsDimensionOrder) {
    Way way;
    way.description = ome(
        "DimensionOrder=\"XYZTC\" SizeZ=\"3\" SizeC=\"2\" SizeT=\"2\"",
        "<Channel ID=\"Channel:0:0\" Name=\"DAPI\"/><Channel ID=\"Channel:0:1\" Name=\"GFP\"/><TiffData/>");
    write(file(), plainPages(12), way);
    EXPECT_THAT(refusal(file()), HasSubstr("2 channels (1 'DAPI', 2 'GFP') and 2 times"));
    expectPages(readChosen(file(), {2, 1}), 6, 1);
    expectPages(readChosen(file(), {1, 2}), 3, 1);
}

TEST_F(TiffVolume, PlanesOfOmeLieWhereTiffDataSays) {
    Way way;
    way.description = ome("DimensionOrder=\"XYZCT\" SizeZ=\"3\" SizeC=\"1\" SizeT=\"1\"",
                          "<TiffData FirstZ=\"0\" IFD=\"2\"/><TiffData FirstZ=\"1\" IFD=\"1\"/><TiffData "
                          "FirstZ=\"2\" IFD=\"0\"/>");
    write(file(), plainPages(3), way);
    expectPages(readImage(file()), 2, -1);
}

TEST_F(TiffVolume, AxesOfTifffileAreFollowedAndMustBeNamed) {
    Way way;
    way.description = "{\"shape\": [2, 3, 18, 21], \"axes\": \"CZYX\"}";
    write(file(), plainPages(6), way);
    expectPages(readChosen(file(), {2, {}}), 3, 1);
    EXPECT_THAT(refusal(file()), HasSubstr("2 channels"));
    way.description = "{\"shape\": [2, 3, 18, 21]}";
    write(file(), plainPages(6), way);
    EXPECT_THAT(refusal(file()), HasSubstr("2 axes beside x and y"));
    way.description = "{\"shape\": [6, 18, 21]}";
    write(file(), plainPages(6), way);
    expectPages(readImage(file()), 0, 1);
}

TEST_F(TiffVolume, IsRefusedWhereItsDescriptionIsNotItsOwn) {
    Way way;
    way.description = "ImageJ=1.53t\nimages=12\nchannels=2\nslices=6\n";
    write(file(), plainPages(11), way);
    EXPECT_THAT(refusal(file()), HasSubstr("slices x channels x times = 6 x 2 x 1 but it holds 11 pages"));
    way.description = ome("DimensionOrder='XYZCT' SizeZ='12' SizeC='1' SizeT='1'");
    write(file(), plainPages(11), way);
    EXPECT_THAT(refusal(file()), HasSubstr("= 12 x 1 x 1 but it holds 11 pages"));
}

// ---- pages

TEST_F(TiffVolume, NamesThePageOfAnotherSize) {
    auto pages = plainPages(4);
    pages[2].width = 20;
    pages[2].height = 17;
    write(file(), pages);
    EXPECT_THAT(refusal(file()), HasSubstr("its page 3 is 20 x 17 pixels but page 1 is 21 x 18"));
    pages = plainPages(4);
    pages[3] = pageOf<std::uint8_t>(0, SAMPLEFORMAT_UINT);
    write(file(), pages);
    EXPECT_THAT(refusal(file()), HasSubstr("its page 4 holds uint8"));
}

TEST_F(TiffVolume, PassesOverThumbnails) {
    auto pages = plainPages(3);
    pages[1].kind = FILETYPE_REDUCEDIMAGE;
    pages[1].width = 9;
    write(file(), pages);
    const Image image = readImage(file());
    EXPECT_EQ(image.size[2], 2);
    expectPages(image, 0, 2);
}

TEST_F(TiffVolume, ImagesBehindOnePageAreSlices) {
    Way way;
    way.description = "ImageJ=1.53t\nimages=3\nslices=3\n";
    Page page = plain(0);
    const std::string bytes = page.bytes + plain(1).bytes + plain(2).bytes;
    write(file(), {page}, way);
    // One strip in ImageJ's way: libtiff's lie one behind the other too.
    std::string whole = test::bytesOf(file());
    const std::size_t at = whole.find(page.bytes);
    ASSERT_NE(at, std::string::npos);
    EXPECT_THAT(refusal(file()), HasSubstr("it is truncated"));
    const std::uint32_t first = static_cast<std::uint32_t>(at);
    ASSERT_EQ(first, 8u);
    // Tables move behind the images: every offset into them grows by two images.
    TIFF* const tiff = TIFFOpen((folder / "moved.tif").c_str(), "w");
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, kWidth);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, kHeight);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, kHeight);
    TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, way.description.c_str());
    std::string all = bytes;
    ASSERT_GT(TIFFWriteRawStrip(tiff, 0, all.data(), static_cast<tmsize_t>(all.size())), 0);
    TIFFClose(tiff);
    const Image image = readImage(folder / "moved.tif");
    EXPECT_EQ(image.size, (Size{kWidth, kHeight, 3}));
    expectPages(image, 0, 1);
}

TEST_F(TiffVolume, SlicesInAFolderAreReadByTheSameCode) {
    Way way;
    way.tiled = true;
    way.compression = COMPRESSION_LZW;
    for (const std::int64_t z : {0, 1, 2})
        write(folder / ("s" + std::to_string(z) + ".tif"), {pageOf<std::int32_t>(z, SAMPLEFORMAT_INT)}, way);
    const Image image = readImage(folder);
    EXPECT_EQ(image.componentType, "int32");
    EXPECT_EQ(image.values[5], valueAt(5, 0, 0, true));
    EXPECT_EQ(image.values[2 * kWidth * kHeight + 5], valueAt(5, 0, 2, true));
}

// ---- damage

TEST_F(TiffVolume, OutlivesTruncationAndChangedBytes) {
    for (const int code : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE}) {
        Way way;
        way.compression = code;
        way.description = "ImageJ=1.53t\nimages=4\nchannels=2\nslices=2\nunit=mm\nspacing=1.5\n";
        way.perUnit = {4, 2};
        write(file(), plainPages(4), way);
        const std::string whole = test::bytesOf(file());
        const ImageReadOptions options{.channel = 2};
        ASSERT_EQ(refusal(file(), options), "");
        for (std::size_t length = 0; length < whole.size(); length += 41)
            ASSERT_NE(refusal(put(folder / "cut.tif", whole.substr(0, length)), options), "") << length;
        std::mt19937 random(57);
        for (int trial = 0; trial < 1000; ++trial) {
            std::string bad = whole;
            bad[random() % whole.size()] = static_cast<char>(random());
            refusal(put(folder / "bad.tif", bad), options);
        }
    }
}

}  // namespace
}  // namespace isowave
