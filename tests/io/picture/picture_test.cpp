// Pictures in files: the promises of io/picture's headers. Debian's Pillow (python3-pil) is the second tool: where it
// is installed, it writes every kind of file, and reads what is written here.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiffio.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "io/picture/asc.h"
#include "io/picture/bmp.h"
#include "io/picture/jpeg.h"
#include "io/picture/npy.h"
#include "io/picture/png.h"
#include "io/picture/pnm.h"
#include "io/picture/tiff.h"
#include "isowave/error.h"

namespace isowave {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using Reader = Picture (*)(std::string_view, const std::string&);

// A fresh allocation each time, so that a sanitizer sees one byte too far.
Picture readCopy(Reader read, const std::string& bytes) {
    const std::vector<char> copy(bytes.begin(), bytes.end());
    return read({copy.data(), copy.size()}, "p");
}

std::string complaint(Reader read, const std::string& bytes) {
    try {
        readCopy(read, bytes);
        return "";
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        return error.what();
    }
}

template <class T>
std::vector<T> samplesOf(const Picture& picture) {
    return {picture.as<T>().begin(), picture.as<T>().end()};
}

template <class T>
Picture pictureOf(std::int64_t width, std::int64_t height, int channels, ValueType type,
                  const std::vector<T>& samples) {
    Picture picture{.width = width, .height = height, .channels = channels, .type = type};
    picture.isColour = channels > 2;
    picture.hasOpacity = channels % 2 == 0;
    picture.samples.resize(samples.size() * sizeof(T));
    std::memcpy(picture.samples.data(), samples.data(), picture.samples.size());
    return picture;
}

template <class T>
std::vector<T> noise(std::size_t count) {
    std::mt19937 random(1);
    std::vector<T> values(count);
    for (T& v : values) v = static_cast<T>(random());
    return values;
}

// Nothing but InputError for any of these; `whole` is read.
void expectEveryCutRefused(Reader read, const std::string& whole) {
    EXPECT_EQ(complaint(read, whole), "");
    for (std::size_t n = 0; n < whole.size(); ++n)
        EXPECT_NE(complaint(read, whole.substr(0, n)), "") << n << " of " << whole.size();
}
void expectNoCrash(Reader read, const std::string& whole) {
    std::mt19937 random(2);
    for (std::size_t n = 0; n < whole.size(); ++n)
        for (const int change : {1, 128, static_cast<int>(random() % 255 + 1)}) {
            std::string damaged = whole;
            damaged[n] = static_cast<char>(damaged[n] ^ change);
            complaint(read, damaged);
        }
}

// ---- a picture

TEST(Picture, LuminanceIsRec601OnWhite) {
    const auto grey = pictureOf<std::uint8_t>(3, 1, 2, ValueType::uint8, {100, 255, 100, 0, 0, 51});
    EXPECT_THAT(luminance(grey), ElementsAre(100, 255, 204));
    const auto colour = pictureOf<std::uint8_t>(2, 1, 3, ValueType::uint8, {255, 0, 0, 10, 20, 30});
    EXPECT_FLOAT_EQ(luminance(colour)[0], 0.299f * 255);
    EXPECT_FLOAT_EQ(luminance(colour)[1], 0.299f * 10 + 0.587f * 20 + 0.114f * 30);
}

TEST(Picture, HeightsAreRefusedWhereTransparent) {
    auto picture = pictureOf<std::uint16_t>(2, 1, 2, ValueType::uint16, {7, 65535, 9, 65535});
    EXPECT_EQ(heightChannels(picture), 1);
    EXPECT_THAT(heights(picture, "p"), ElementsAre(7, 9));
    picture = pictureOf<std::uint16_t>(2, 1, 2, ValueType::uint16, {7, 65535, 9, 65534});
    try {
        heights(picture, "p");
        ADD_FAILURE();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("p: the sample at row 0, column 1 is transparent"));
    }
}

TEST(Picture, MorePixelsThanTheFileCanHoldTakeNoMemory) {
    Picture picture{.width = 1 << 20, .height = 1 << 10};
    EXPECT_THROW(allocate(picture, "p", 8, 1 << 20, 1000), InputError);
    EXPECT_TRUE(picture.samples.empty());
    picture.width = std::int64_t{1} << 40;
    EXPECT_THROW(checkSize(picture, "p"), InputError);
}

// ---- PNG

TEST(Png, WrittenIsReadBackInEveryKind) {
    for (const int channels : {1, 2, 3, 4}) {
        const auto count = static_cast<std::size_t>(13 * 7 * channels);
        const auto bytes = noise<std::uint8_t>(count);
        const Picture eight = readPng(pngBytes(pictureOf(13, 7, channels, ValueType::uint8, bytes)), "p");
        EXPECT_EQ(samplesOf<std::uint8_t>(eight), bytes);
        EXPECT_EQ(eight.channels, channels);
        EXPECT_EQ(eight.bits, 8);
        EXPECT_EQ(eight.isColour, channels > 2);
        EXPECT_EQ(eight.hasOpacity, channels % 2 == 0);
        const auto words = noise<std::uint16_t>(count);
        const Picture deep = readPng(pngBytes(pictureOf(13, 7, channels, ValueType::uint16, words)), "p");
        EXPECT_EQ(samplesOf<std::uint16_t>(deep), words);
        EXPECT_EQ(deep.bits, 16);
    }
}

TEST(Png, KeepsWhatItsFileSaysOfPixels) {
    Picture picture = pictureOf<std::uint8_t>(1, 1, 1, ValueType::uint8, {7});
    picture.pixelSize = {{0.5, 0.25}};
    picture.isSrgb = true;
    const Picture back = readPngNumbersHeader(pngBytes(picture), "p");
    EXPECT_THAT(*back.pixelSize, ElementsAre(0.5, 0.25));
    EXPECT_TRUE(back.isSrgb);
    EXPECT_TRUE(back.samples.empty());
}

TEST(Png, EveryCutIsRefusedAndNoDamageCrashes) {
    const std::string bytes = pngBytes(pictureOf(9, 5, 3, ValueType::uint8, noise<std::uint8_t>(9 * 5 * 3)));
    expectEveryCutRefused(readPng, bytes);
    expectNoCrash(readPng, bytes);
    // Every changed byte is seen: chunks have checksums.
    for (std::size_t n = 0; n < bytes.size(); ++n) {
        std::string damaged = bytes;
        damaged[n] = static_cast<char>(damaged[n] ^ 16);
        EXPECT_NE(complaint(readPng, damaged), "") << n;
    }
}

std::uint32_t crcOf(const std::string& bytes) {
    std::uint32_t crc = 0xffffffffu;
    for (const char c : bytes) {
        crc ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0u);
    }
    return ~crc;
}
std::string word(std::uint32_t value) {
    std::string bytes;
    for (int k = 3; k >= 0; --k) bytes += static_cast<char>(value >> 8 * k & 255);
    return bytes;
}

// Checksums that are right over content that is wrong: libpng itself must refuse, in every chunk.
TEST(Png, DamageWithRightChecksumsIsRefusedOrHarmless) {
    const std::string bytes = pngBytes(pictureOf(9, 5, 3, ValueType::uint8, noise<std::uint8_t>(9 * 5 * 3)));
    testing::internal::CaptureStderr();
    std::size_t refused = 0;
    for (std::size_t at = 8; at < bytes.size();) {
        std::size_t size = 0;
        for (std::size_t k = 0; k < 4; ++k) size = size << 8 | static_cast<unsigned char>(bytes[at + k]);
        for (std::size_t k = 4; k < size + 8; ++k)
            for (const int change : {1, 4, 128, 255}) {
                std::string damaged = bytes;
                damaged[at + k] = static_cast<char>(damaged[at + k] ^ change);
                damaged.replace(at + 8 + size, 4, word(crcOf(damaged.substr(at + 4, size + 4))));
                refused += !complaint(readPng, damaged).empty();
            }
        at += size + 12;
    }
    EXPECT_GT(refused, 100u);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Png, AHeaderThatPromisesTooMuchIsRefusedBeforeMemoryIsTaken) {
    std::string bytes = pngBytes(pictureOf<std::uint8_t>(1, 1, 1, ValueType::uint8, {7}));
    const auto sized = [&](std::uint32_t width, std::uint32_t height) {
        std::string other = bytes;
        other.replace(16, 8, word(width) + word(height));
        return other.replace(29, 4, word(crcOf(other.substr(12, 17))));
    };
    EXPECT_THAT(complaint(readPng, sized(46000, 46000)), HasSubstr("46000 x 46000 pixels, more than its"));
    EXPECT_THAT(complaint(readPng, sized(0x7fffffff, 0x7fffffff)), HasSubstr("2^31"));
    EXPECT_NE(complaint(readPng, sized(0, 1)), "");
}

// ---- TIFF

// A little-endian TIFF of one strip, made by hand: tags are {number, type, value}.
std::string tiffOf(const std::vector<std::array<unsigned, 3>>& tags, const std::string& data) {
    std::string bytes("II*\0", 4);
    const auto put = [&](unsigned value, int size) {
        for (int k = 0; k < size; ++k) bytes += static_cast<char>(value >> (8 * k) & 255);
    };
    put(8 + static_cast<unsigned>(data.size()), 4);
    bytes += data;
    put(static_cast<unsigned>(tags.size()), 2);
    for (const auto& [tag, type, value] : tags) {
        put(tag, 2);
        put(type, 2);
        put(1, 4);
        put(value, 4);
    }
    put(0, 4);
    return bytes;
}
std::string greyTiff(unsigned width, unsigned height, unsigned bits, unsigned format, const std::string& data,
                     unsigned photometric = 1) {
    return tiffOf({{256, 4, width},
                   {257, 4, height},
                   {258, 3, bits},
                   {259, 3, 1},
                   {262, 3, photometric},
                   {273, 4, 8},
                   {277, 3, 1},
                   {278, 4, height},
                   {279, 4, static_cast<unsigned>(data.size())},
                   {339, 3, format}},
                  data);
}

template <class T>
void expectTiffOf(ValueType type, unsigned format) {
    const auto values = noise<T>(12);
    const std::string data(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    const Picture picture = readTiff(greyTiff(4, 3, 8 * sizeof(T), format, data), "p");
    EXPECT_EQ(picture.type, type);
    EXPECT_EQ(samplesOf<T>(picture), values);
}

TEST(Tiff, NumbersOfEveryTypeStayAsTheyAre) {
    expectTiffOf<std::uint8_t>(ValueType::uint8, 1);
    expectTiffOf<std::int8_t>(ValueType::int8, 2);
    expectTiffOf<std::uint16_t>(ValueType::uint16, 1);
    expectTiffOf<std::int16_t>(ValueType::int16, 2);
    expectTiffOf<std::uint32_t>(ValueType::uint32, 1);
    expectTiffOf<std::int32_t>(ValueType::int32, 2);
    expectTiffOf<std::int64_t>(ValueType::int64, 2);
    expectTiffOf<float>(ValueType::float32, 3);
    expectTiffOf<double>(ValueType::float64, 3);
    const std::uint16_t halves[] = {0x3c00, 0xc000};
    const std::string data(reinterpret_cast<const char*>(halves), sizeof halves);
    EXPECT_THAT(samplesOf<float>(readTiff(greyTiff(2, 1, 16, 3, data), "p")), ElementsAre(1, -2));
    EXPECT_NE(complaint(readTiff, greyTiff(2, 1, 24, 3, "abcdef")), "");
}

TEST(Tiff, FewerBitsAreSpreadAndWhiteAsZeroIsTurnedOver) {
    EXPECT_THAT(samplesOf<std::uint8_t>(readTiff(greyTiff(3, 1, 1, 1, "\xa0"), "p")),
                ElementsAre(255, 0, 255));
    EXPECT_THAT(samplesOf<std::uint8_t>(readTiff(greyTiff(3, 1, 2, 1, "\x18"), "p")),
                ElementsAre(0, 85, 170));
    EXPECT_THAT(samplesOf<std::uint8_t>(readTiff(greyTiff(2, 1, 4, 1, "\x1f"), "p")), ElementsAre(17, 255));
    EXPECT_THAT(samplesOf<std::uint8_t>(readTiff(greyTiff(2, 1, 4, 1, "\x1f", 0), "p")), ElementsAre(238, 0));
}

// Written by libtiff: RGB of 37 x 23 in tiles or strips, planes together or apart.
template <class T>
std::string byLibtiff(const char* mode, bool tiled, bool apart, int compression, int predictor,
                      int orientation, const std::vector<T>& values) {
    constexpr std::uint32_t kWidth = 37, kHeight = 23, kTile = 16;
    const std::string path = (fs::temp_directory_path() / fmt::format("isowave_{}.tif", ::getpid())).string();
    TIFF* tiff = TIFFOpen(path.c_str(), mode);
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, kWidth);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, kHeight);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, static_cast<int>(8 * sizeof(T)));
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 3);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT,
                 std::is_floating_point_v<T> ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, apart ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression);
    TIFFSetField(tiff, TIFFTAG_ORIENTATION, orientation);
    if (predictor > 1) TIFFSetField(tiff, TIFFTAG_PREDICTOR, predictor);
    const std::uint32_t wide = tiled ? kTile : kWidth, high = tiled ? kTile : 5;
    if (tiled) {
        TIFFSetField(tiff, TIFFTAG_TILEWIDTH, wide);
        TIFFSetField(tiff, TIFFTAG_TILELENGTH, high);
    } else {
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, high);
    }
    std::uint32_t number = 0;
    for (std::uint32_t plane = 0; plane < (apart ? 3u : 1u); ++plane)
        for (std::uint32_t top = 0; top < kHeight; top += high)
            for (std::uint32_t left = 0; left < kWidth; left += wide) {
                std::vector<T> block;
                for (std::uint32_t y = top; y < (tiled ? top + high : std::min(top + high, kHeight)); ++y)
                    for (std::uint32_t x = left; x < left + wide; ++x)
                        for (std::uint32_t c = 0; c < (apart ? 1u : 3u); ++c)
                            block.push_back(
                                x < kWidth && y < kHeight ? values[(y * kWidth + x) * 3 + c + plane] : T{});
                const auto size = static_cast<tmsize_t>(block.size() * sizeof(T));
                EXPECT_EQ(tiled ? TIFFWriteEncodedTile(tiff, number, block.data(), size)
                                : TIFFWriteEncodedStrip(tiff, number, block.data(), size),
                          size);
                ++number;
            }
    TIFFClose(tiff);
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    fs::remove(path);
    return bytes;
}

template <class T>
void expectEveryLayoutReadsTheSame(int predictor) {
    const auto values = noise<T>(37 * 23 * 3);
    // libtiff 4.5 does not read back the big-endian floats that it wrote with a predictor.
    const std::vector<const char*> modes = {"wl", "w8", predictor < 3 ? "wb" : "wl"};
    for (const char* mode : modes)
        for (const bool tiled : {false, true})
            for (const bool apart : {false, true})
                for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE}) {
                    SCOPED_TRACE(fmt::format("{} {} {} {}", mode, tiled, apart, compression));
                    const std::string bytes =
                        byLibtiff(mode, tiled, apart, compression,
                                  compression == COMPRESSION_NONE ? 1 : predictor, 1, values);
                    EXPECT_EQ(samplesOf<T>(readTiff(bytes, "p")), values);
                    for (std::size_t n = 0; n < bytes.size(); n += 97)
                        complaint(readTiff, bytes.substr(0, n));
                }
}

TEST(Tiff, StripsTilesPlanesOrdersAndPredictorsHoldTheSameNumbers) {
    expectEveryLayoutReadsTheSame<std::uint8_t>(2);
    expectEveryLayoutReadsTheSame<std::uint16_t>(2);
    expectEveryLayoutReadsTheSame<float>(3);
}

TEST(Tiff, RowsComeFromTheTopAndPixelsFromTheLeft) {
    const auto values = noise<std::uint8_t>(37 * 23 * 3);
    for (const int orientation : {1, 2, 3, 4}) {
        const Picture picture =
            readTiff(byLibtiff("w", false, false, COMPRESSION_NONE, 1, orientation, values), "p");
        const std::size_t x = orientation == 2 || orientation == 3 ? 36 : 0, y = orientation > 2 ? 22 : 0;
        EXPECT_EQ(picture.as<std::uint8_t>()[(y * 37 + x) * 3 + 1], values[1]) << orientation;
    }
}

TEST(Tiff, EveryCutIsRefusedAndNoDamageCrashesOrPrints) {
    const std::string data = "0123456789ab", whole = greyTiff(4, 3, 8, 1, data);
    testing::internal::CaptureStderr();
    // The last four bytes say that there is no other page; libtiff takes their absence for that.
    for (std::size_t n = 0; n < whole.size(); ++n)
        EXPECT_EQ(complaint(readTiff, whole.substr(0, n)).empty(), n + 4 >= whole.size()) << n;
    expectNoCrash(readTiff, greyTiff(4, 3, 8, 1, data));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Tiff, AHeaderThatPromisesTooMuchIsRefused) {
    EXPECT_THAT(complaint(readTiff, greyTiff(40000, 40000, 8, 1, "0123")), HasSubstr("40000 x 40000 pixels"));
    EXPECT_NE(complaint(readTiff, greyTiff(4000000000u, 4000000000u, 8, 1, "0123")), "");
    EXPECT_NE(complaint(readTiff, greyTiff(0, 3, 8, 1, "0123")), "");
}

// ---- BMP, PGM, PBM

TEST(Bmp, RunsAndPalettesBecomeColours) {
    std::string header("BM\0\0\0\0\0\0\0\0\x3e\0\0\0\x28\0\0\0\3\0\0\0\2\0\0\0\1\0\x08\0\1\0\0\0", 34);
    header += std::string(12, '\0') + std::string("\2\0\0\0\0\0\0\0", 8);
    const std::string palette("\1\2\3\0\x0a\x0b\x0c\0", 8);
    // From the bottom: three times colour 1, end of the row; one and two as they are, end.
    const std::string runs("\3\1\0\0\1\0\2\1\0\1", 10);
    const Picture picture = readBmp(header + palette + runs, "p");
    EXPECT_THAT(samplesOf<std::uint8_t>(picture),
                ElementsAre(3, 2, 1, 12, 11, 10, 12, 11, 10, 12, 11, 10, 12, 11, 10, 12, 11, 10));
    expectEveryCutRefused(readBmp, header + palette + runs);
    expectNoCrash(readBmp, header + palette + runs);
}

TEST(Pnm, LargestValueDecidesTheWidthOfSamples) {
    EXPECT_THAT(samplesOf<std::uint8_t>(readPnm("P2 # text\n2 1\n255\n7 255\n", "p")), ElementsAre(7, 255));
    EXPECT_THAT(samplesOf<std::uint16_t>(readPnm(std::string("P5 1 1 65535\n\1\2", 15), "p")),
                ElementsAre(258));
    EXPECT_THAT(samplesOf<std::uint8_t>(readPnm("P1 3 1 101", "p")), ElementsAre(0, 255, 0));
    EXPECT_THAT(samplesOf<std::uint8_t>(readPnm("P4\n3 1\n\xa0", "p")), ElementsAre(0, 255, 0));
    for (const std::string& whole : {std::string("P5\n2 2\n65535\n12345678"), std::string("P4 9 2\nabcd")}) {
        expectEveryCutRefused(readPnm, whole);
        expectNoCrash(readPnm, whole);
    }
    expectNoCrash(readPnm, "P2 2 2 300 1 22 300 4");
    EXPECT_THAT(complaint(readPnm, "P5 40000 40000 255\nabc"), HasSubstr("truncated"));
}

// ---- arrays

std::string npy(const std::string& dictionary, const std::string& data) {
    std::string header = dictionary + "\n", bytes = "\x93NUMPY\x01";
    bytes += '\0';
    bytes += static_cast<char>(header.size() & 255);
    bytes += static_cast<char>(header.size() >> 8);
    return bytes + header + data;
}

TEST(Npy, WrittenIsReadBack) {
    for (const int channels : {1, 3}) {
        std::vector<double> values;
        for (int k = 0; k < 12 * channels; ++k) values.push_back(0.1 * k - 0.5);
        const Picture again = readNpy(npyBytes(pictureOf(4, 3, channels, ValueType::float64, values)), "n");
        EXPECT_EQ(samplesOf<double>(again), values);
        EXPECT_EQ(again.height, 3);
        EXPECT_EQ(again.channels, channels);
        EXPECT_EQ(heightChannels(again), channels);  // points, not colours
    }
    const auto words = noise<std::uint16_t>(6);
    EXPECT_EQ(samplesOf<std::uint16_t>(readNpy(npyBytes(pictureOf(3, 2, 1, ValueType::uint16, words)), "n")),
              words);
}

TEST(Npy, ReadsOtherTypesAndOrders) {
    const std::string big("\x00\x01\x00\x02\xff\xff\x01\x00", 8);
    const Picture a = readNpy(npy("{'descr': '>i2', 'fortran_order': False, 'shape': (2, 2), }", big), "n");
    EXPECT_THAT(samplesOf<std::int16_t>(a), ElementsAre(1, 2, -1, 256));
    const Picture b = readNpy(
        npy("{'descr': '|u1', 'fortran_order': True, 'shape': (2, 3), }", std::string("\1\2\3\4\5\6")), "n");
    EXPECT_THAT(samplesOf<std::uint8_t>(b), ElementsAre(1, 3, 5, 2, 4, 6));
    const float value = 1.5f;
    std::string floats(16, '\0');
    for (int k = 0; k < 4; ++k) std::memcpy(floats.data() + 4 * k, &value, 4);
    EXPECT_EQ(
        heights(readNpy(npy("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), }", floats), "n"),
                "n")[3],
        1.5);
}

TEST(Npy, BadFilesAreRefusedWithTheReason) {
    const auto tell = [](const std::string& bytes) { return complaint(readNpy, bytes); };
    const std::string good = npyBytes(pictureOf<double>(2, 2, 1, ValueType::float64, {1, 2, 3, 4}));
    EXPECT_THAT(tell("hello world"), HasSubstr("p: is not a NumPy array"));
    EXPECT_THAT(tell(good.substr(0, good.size() - 1)),
                HasSubstr("needs 32 bytes but the file holds 31; it is truncated"));
    EXPECT_THAT(tell(npy("{'descr': '<c16', 'fortran_order': False, 'shape': (2, 2), }", "")),
                HasSubstr("type '<c16'"));
    EXPECT_THAT(tell(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (4,), }", "")),
                HasSubstr("shape (4,)"));
    EXPECT_THAT(tell(npy("{'descr': '<f8', 'fortran_order': False, }", "")), HasSubstr("no 'shape'"));
    EXPECT_THAT(
        tell(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999, 99999999999), }", "")),
        HasSubstr("2^20"));
    expectEveryCutRefused(readNpy, good);
    expectNoCrash(readNpy, good);
}

TEST(AsciiGrid, IsRead) {
    const Picture grid = readAsc(
        "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 5\nNODATA_value -1\n1 2 3\n4 +5 6.5e0\n",
        "a");
    EXPECT_EQ(grid.height, 2);
    EXPECT_THAT(samplesOf<double>(grid), ElementsAre(1, 2, 3, 4, 5, 6.5));
}

TEST(AsciiGrid, BadFilesAreRefusedWithTheReason) {
    const auto tell = [](const char* text) { return complaint(readAsc, text); };
    EXPECT_THAT(tell("1 2 3"), HasSubstr("no 'ncols'"));
    EXPECT_THAT(tell("ncols 3\nnrows 2\n1 2 3 4"), HasSubstr("say 6 samples but 4 can be read"));
    EXPECT_THAT(tell("ncols 1e6\nnrows 1e6\n1 2 3 4"), HasSubstr("but 4 can be read"));
    EXPECT_THAT(tell("ncols 3\nnrows x\n"), HasSubstr("'nrows' has no number"));
    EXPECT_THAT(tell("ncols -3\nnrows 2\n"), HasSubstr("from 2 to 2^20"));
    EXPECT_THAT(tell("ncols 2\nnrows 2\n1 2 -9999 -9999"),
                HasSubstr("2 of 4 samples are without data, the first at row 1, column 0"));
    expectNoCrash(readAsc, "ncols 2\nnrows 2\nNODATA_value -1\n1 2 3 4");
}

// ---- beside Pillow

constexpr const char* kPillow = R"(
import sys, struct, zlib
from PIL import Image
folder = sys.argv[1]
W, H = 37, 23
g = [(x * 7 + y * 31) % 256 for y in range(H) for x in range(W)]
def image(mode, values):
    im = Image.new(mode, (W, H)); im.putdata(values); return im
grey = image("L", g)
rgb = image("RGB", [(v, 255 - v, v // 2) for v in g])
rgba = image("RGBA", [(v, 255 - v, v // 2, (v * 3) % 256) for v in g])
la = image("LA", [(v, (v * 3) % 256) for v in g])
pal = rgb.quantize(13)
clear = pal.copy(); clear.info["transparency"] = 3
bit = image("1", [255 * (v > 100) for v in g])
deep = Image.new("I;16", (W, H)); deep.putdata([v * 257 - v // 3 for v in g])
deep32 = Image.new("I", (W, H)); deep32.putdata([v * 100000 for v in g])
real = Image.new("F", (W, H)); real.putdata([v / 7 for v in g])
images = {"grey": grey, "rgb": rgb, "rgba": rgba, "la": la, "pal": pal, "clear": clear, "bit": bit, "deep": deep,
          "deep32": deep32, "real": real}
def save(name, im, **options):
    im.save(f"{folder}/{name}", **options)
    if name.endswith(".jpg"): im = Image.open(f"{folder}/{name}")
    if im.mode in ("P", "1") and "transparency" in im.info: im = im.convert("RGBA")
    if im.mode == "P": im = im.convert("RGB")
    if im.mode == "1": im = im.convert("L")
    with open(f"{folder}/{name}.txt", "w") as out:
        for p in im.getdata():
            for v in (p if isinstance(p, tuple) else (p,)): out.write(f"{v!r}\n")
for name in ("grey", "rgb", "rgba", "la", "pal", "clear", "bit", "deep"):
    save(name + ".png", images[name])
save("pal2.png", rgb.quantize(3), bits=2)
save("pal4.png", rgb.quantize(13), bits=4)
for name in ("grey", "rgb", "pal", "bit", "rgba"):
    save(name + ".bmp", images[name])
for name in ("grey", "rgb"):
    save(name + ".jpg", images[name], quality=90)
    save("progressive_" + name + ".jpg", images[name], quality=80, progressive=True, subsampling=2)
for name in ("grey", "bit"):
    save(name + (".pgm" if name == "grey" else ".pbm"), images[name])
for name in ("grey", "rgb", "rgba", "la", "pal", "bit", "deep", "deep32", "real"):
    for compression in (None, "tiff_lzw", "tiff_adobe_deflate", "packbits"):
        save(f"{name}_{compression}.tif", images[name], compression=compression)
save("group4.tif", bit, compression="group4")
save("jpeg.tif", rgb.resize((W, H)), compression="jpeg", quality=100)
# Interlaced, and of 2 and 4 bits: Pillow writes none.
def chunk(kind, body): return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
raw = b""
for x0, y0, dx, dy in ((0,0,8,8),(4,0,8,8),(0,4,4,8),(2,0,4,4),(0,2,2,4),(1,0,2,2),(0,1,1,2)):
    for y in range(y0, H, dy):
        row = bytes(g[y * W + x] for x in range(x0, W, dx))
        if row: raw += b"\0" + row
def png(name, bits, interlaced, rows, values):
    header = struct.pack(">IIBBBBB", W, H, bits, 0, 0, 0, interlaced)
    open(f"{folder}/{name}", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
                                         chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
    open(f"{folder}/{name}.txt", "w").write("".join(f"{v}\n" for v in values))
png("interlaced.png", 8, 1, raw, g)
def rows(bits, values):
    out = b""
    for y in range(H):
        b = "".join(format(values[y * W + x] >> (8 - bits), f"0{bits}b") for x in range(W))
        b += "0" * (-len(b) % 8)
        out += b"\0" + bytes(int(b[k:k + 8], 2) for k in range(0, len(b), 8))
    return out
for bits in (2, 4):
    png(f"grey{bits}.png", bits, 0, rows(bits, g), [(v >> (8 - bits)) * 255 // ((1 << bits) - 1) for v in g])
)";

class Pillow : public testing::Test {
  protected:
    void SetUp() override {
        std::filesystem::create_directories(folder);
        std::ofstream(folder / "make.py") << kPillow;
        if (std::system(
                fmt::format("/usr/bin/python3 {0}/make.py {0} 2> {0}/said", folder.string()).c_str()) != 0)
            GTEST_SKIP() << "no Pillow (python3-pil), or it failed: " << textOf(folder / "said");
    }
    void TearDown() override { std::filesystem::remove_all(folder); }
    static std::string textOf(const fs::path& path) {
        std::ifstream file(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    static std::vector<double> numbersOf(const fs::path& path) {
        std::ifstream file(path);
        return {std::istream_iterator<double>(file), {}};
    }

    fs::path folder = fs::temp_directory_path() / fmt::format("isowave_pillow_{}", ::getpid());
};

Reader readerOf(const fs::path& path) {
    const std::string extension = path.extension();
    return extension == ".png"   ? readPng
           : extension == ".tif" ? readTiff
           : extension == ".bmp" ? readBmp
           : extension == ".jpg" ? readJpeg
                                 : readPnm;
}

// All samples as numbers, in 8 bits where Pillow says 8.
std::vector<double> valuesOf(const Picture& picture, double scale) {
    std::vector<double> values;
    withType(picture.type, [&]<class T>(T) {
        for (const T v : picture.as<T>()) values.push_back(static_cast<double>(v) * scale);
    });
    return values;
}

TEST_F(Pillow, ReadsTheSameNumbers) {
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const fs::path& path = entry.path();
        if (!fs::exists(path.string() + ".txt")) continue;
        ++files;
        SCOPED_TRACE(path.filename().string());
        const std::string bytes = textOf(path);
        const Picture picture = readerOf(path)(bytes, "p");
        EXPECT_EQ(picture.width, 37);
        EXPECT_EQ(picture.height, 23);
        std::vector<double> expected = numbersOf(path.string() + ".txt");
        const bool isTiffPalette = path.filename().string().starts_with("pal_");  // 16 bits, Pillow: v << 8
        std::vector<double> values = valuesOf(picture, isTiffPalette ? 1.0 / 256 : 1.0);
        if (path.extension() == ".bmp" && expected.size() == 37 * 23) {  // always colours here
            for (std::size_t k = 0; k < expected.size(); ++k) values[k] = values[3 * k];
            values.resize(expected.size());
        }
        ASSERT_EQ(values.size(), expected.size());
        const double allowed = path.filename() == "jpeg.tif"                  ? 40
                               : path.filename().string().starts_with("real") ? 1e-5
                                                                              : 0;
        double most = 0;
        for (std::size_t k = 0; k < values.size(); ++k)
            most = std::max(most, std::abs(values[k] - expected[k]));
        EXPECT_LE(most, allowed);
    }
    EXPECT_GE(files, 59u);
}

TEST_F(Pillow, NoCutOfItsFilesIsReadAndNoDamageCrashes) {
    testing::internal::CaptureStderr();
    for (const char* name : {"pal.png", "clear.png", "interlaced.png", "bit.png", "rgba_tiff_lzw.tif",
                             "deep_None.tif", "pal_packbits.tif", "group4.tif", "jpeg.tif",
                             "la_tiff_adobe_deflate.tif", "pal.bmp", "grey.jpg", "progressive_rgb.jpg"}) {
        SCOPED_TRACE(name);
        const std::string bytes = textOf(folder / name);
        const Reader read = readerOf(folder / name);
        for (std::size_t n = 0; n < bytes.size(); n += 1 + bytes.size() / 400) {
            if (!std::string(name).ends_with(".tif")) {
                EXPECT_NE(complaint(read, bytes.substr(0, n)), "") << n << " of " << bytes.size();
            } else {
                complaint(read, bytes.substr(0, n));  // its last bytes may be tags that nobody needs
            }
            std::string damaged = bytes;
            damaged[n] = static_cast<char>(damaged[n] ^ (1 << n % 8));
            complaint(read, damaged);
        }
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(Pillow, ReadsWhatIsWrittenHere) {
    std::ofstream(folder / "compare.py") << "import sys\nfrom PIL import Image\n"
                                            "for p in Image.open(sys.argv[1]).getdata():\n"
                                            "    for v in (p if isinstance(p, tuple) else (p,)): print(v)\n";
    for (const int channels : {1, 2, 3, 4}) {
        const auto values = noise<std::uint8_t>(static_cast<std::size_t>(5 * 4 * channels));
        std::ofstream(folder / "w.png", std::ios::binary)
            << pngBytes(pictureOf(5, 4, channels, ValueType::uint8, values));
        ASSERT_EQ(
            std::system(fmt::format("/usr/bin/python3 {0}/compare.py {0}/w.png > {0}/w.out", folder.string())
                            .c_str()),
            0);
        EXPECT_THAT(numbersOf(folder / "w.out"),
                    testing::ElementsAreArray(std::vector<double>(values.begin(), values.end())));
    }
}

}  // namespace
}  // namespace isowave
