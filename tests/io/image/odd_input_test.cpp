// Inputs that are odd but legal, or broken in ways that were once passed over: right, or a line that says what is wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <tiffio.h>

#include "gzip.h"
#include "tests/io/image/files.h"
#include "tests/io/image/itk.h"
#include "tests/io/image/written.h"

namespace isowave {
namespace {

namespace fs = std::filesystem;
using test::bytes;
using test::bytesOf;
using test::put;
using test::refusal;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t kMegabyte = 1 << 20;

class BadImageOrOdd : public test::ImageFiles {
  protected:
    // Four voxels of int16, 1 to 4, with these lines in the header.
    fs::path nrrd(const std::string& lines) {
        return put(folder / "a.nrrd", "NRRD0005\ntype: int16\ndimension: 3\nsizes: 2 2 1\nencoding: raw\n" +
                                          lines + "\n" + bytes<std::int16_t>({1, 2, 3, 4}));
    }
    fs::path slice(const std::string& name, unsigned char value) {
        const auto image = itk::Image<unsigned char, 2>::New();
        image->SetRegions(itk::Image<unsigned char, 2>::RegionType({3, 2}));
        image->Allocate();
        image->FillBuffer(value);
        fs::create_directories((folder / name).parent_path());
        test::writeItk(image.GetPointer(), folder / name);
        return folder / name;
    }
};

// ---- gzip

TEST_F(BadImageOrOdd, GzipThatGivesNoHeaderSaysThatItIsTheGzip) {
    test::NiftiFile file;
    file.sformCode = 1;
    const std::string plain = file.file(), packed = test::gzipped(plain);
    for (const char* name :
         {"a.nii.gz", "a.nrrd.gz", "a.mha.gz", "a.mgz", "a.mrc.gz", "a.npy.gz", "a.vti.gz", "a.nii"})
        EXPECT_THAT(refusal(put(folder / name, packed.substr(0, packed.size() / 2))),
                    AllOf(HasSubstr("gzip stream breaks off"), HasSubstr("copy or download it again")))
            << name;
    std::string changed = packed;
    changed[packed.size() - 8] = static_cast<char>(changed[packed.size() - 8] ^ 1);  // the checksum
    EXPECT_THAT(refusal(put(folder / "a.nii.gz", changed)),
                AllOf(HasSubstr("is damaged (incorrect data check)"),
                      HasSubstr("after " + std::to_string(plain.size()))));
    EXPECT_THAT(refusal(put(folder / "a.nii.gz", test::gzipped(packed))), HasSubstr("gzip twice"));
    // Padding behind the end, and several streams after one another, are right.
    EXPECT_EQ(refusal(put(folder / "a.nii.gz", packed + std::string(100, '\0'))), "");
    EXPECT_EQ(refusal(put(folder / "a.nii.gz",
                          test::gzipped(plain.substr(0, 100)) + test::gzipped(plain.substr(100)))),
              "");
}

// ---- names

TEST_F(BadImageOrOdd, APipeIsNotWaitedFor) {
    for (const char* name : {"a.nii", "a.nrrd", "a.png", "a"}) {
        ASSERT_EQ(::mkfifo((folder / name).c_str(), 0600), 0);
        EXPECT_THAT(voxelFilesOf(folder / name), IsEmpty());  // which opened it, and waited for who writes it
        EXPECT_THAT(refusal(folder / name), HasSubstr("is neither a file nor a folder")) << name;
    }
}

TEST_F(BadImageOrOdd, ANameThatCannotBeLookedAtIsSaidSo) {
    fs::create_symlink("loop.nii", folder / "loop.nii");
    EXPECT_THAT(refusal(folder / "loop.nii"),
                HasSubstr("cannot be looked at (Too many levels of symbolic links)"));
    EXPECT_THAT(refusal(folder / (std::string(300, 'y') + ".nii")),
                HasSubstr("cannot be looked at (File name too long)"));
    EXPECT_THAT(refusal(folder / "none.nii"), HasSubstr("no such file or folder"));
}

// ---- NRRD and MetaImage

TEST_F(BadImageOrOdd, NrrdSkipsThatCannotBeAreRefused) {
    const std::string little = "endian: little\n";
    EXPECT_THAT(readImage(nrrd(little)).values, ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(readImage(nrrd(little + "byte skip: -1\n")).values, ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(refusal(nrrd(little + "byte skip: -2\n")), HasSubstr("'byte skip' says -2"));
    EXPECT_THAT(refusal(nrrd(little + "line skip: -1\n")), HasSubstr("'line skip' says -1"));
    // It was taken for 0, and what lies there for voxels.
    for (const char* key : {"byte skip", "line skip"})
        EXPECT_THAT(refusal(nrrd(little + key + ": 99999999999999999999\n")),
                    AllOf(HasSubstr("99999999999999999999"), HasSubstr("expected whole numbers below 2^63")));
    EXPECT_THAT(refusal(nrrd(little + "byte skip: 9223372036854775807\n")), HasSubstr("'byte skip' says"));
}

TEST_F(BadImageOrOdd, NrrdGeometryThatSaysNothingIsRefused) {
    const std::string little = "endian: little\n";
    const auto expect = [&](const std::string& lines, const std::string& part) {
        EXPECT_THAT(refusal(nrrd(lines)), HasSubstr(part)) << lines;
    };
    expect("", "its header has no 'endian'");
    expect("endian: middle\n", "'endian' says 'middle'");
    expect(little + "spacings: 0.7 0.8\n", "'spacings' says '0.7 0.8'; expected 3 numbers");
    expect(little + "spacings: a b c\n", "expected 3 numbers");
    expect(little + "axis mins: 1\n", "'axis mins' says '1'");
    EXPECT_EQ(refusal(nrrd(little + "spacings: 0.7 0.8 nan\n")), "");
    const std::string lps = little + "space: LPS\nspace directions: ";
    expect(lps + "none none none\n", "'space directions' gives 0 of its 3 axes a direction");
    expect(lps + "(1,0,0) (0,1,0) (nan,0,1)\n", "which are not all finite");
}

TEST_F(BadImageOrOdd, AHeaderWithoutAnEndIsSaidSo) {
    const std::string comment = "# " + std::string(kMegabyte, 'x') + "\n";
    EXPECT_THAT(refusal(nrrd("endian: little\n" + comment)), HasSubstr("goes on beyond 1048576 bytes"));
}

TEST_F(BadImageOrOdd, IntensityOfMetaImageIsNotAppliedAndSaid) {
    const std::string header =
        "ObjectType = Image\nNDims = 3\nDimSize = 2 2 1\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\n";
    const auto warnings = [&](const std::string& lines) {
        const Image image =
            readImage(put(folder / "a.mha", header + lines + "ElementDataFile = LOCAL\n\1\2\3\4"));
        EXPECT_THAT(image.values, ElementsAre(1, 2, 3, 4));
        return image.warnings;
    };
    EXPECT_THAT(warnings("ElementToIntensityFunctionSlope = 2\n"), ElementsAre(HasSubstr("are not applied")));
    EXPECT_THAT(warnings("ElementToIntensityFunctionOffset = -5\n"),
                ElementsAre(HasSubstr("are not applied")));
    EXPECT_THAT(warnings("ElementToIntensityFunctionSlope = 1\nElementToIntensityFunctionOffset = 0\n"),
                IsEmpty());
}

// ---- NumPy

TEST_F(BadImageOrOdd, NumpyHeadersAreTakenByTheWord) {
    const auto file = [&](const std::string& dictionary) {
        std::string header = dictionary + std::string(117 - dictionary.size(), ' ') + "\n";
        return put(folder / "a.npy",
                   std::string("\x93NUMPY\1\0\x76\0", 10) + header + bytes<std::int16_t>({1, 2, 3, 4}));
    };
    EXPECT_EQ(refusal(file("{'descr': '<i2', 'fortran_order': True, 'shape': (2, 2, 1), }")), "");
    // json.dumps() writes so, and numpy.load() takes it.
    EXPECT_THAT(readImage(file("{\"descr\":\"<i2\",\"fortran_order\":True,\"shape\":(2,2,1)}")).values,
                ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(refusal(file("{'descr': '<i2', 'fortran_order': True, 'shape': (-2, 2, 1), }")),
                HasSubstr("(-2,2,1)"));
    EXPECT_THAT(refusal(file("{'descr': '<i2', 'fortran_order': Maybe, 'shape': (2, 2, 1), }")),
                HasSubstr("'fortran_order': Maybe; expected True or False"));
}

// ---- pictures

TEST_F(BadImageOrOdd, APictureIsWhatItBeginsWithWhateverItsName) {
    for (int k = 0; k < 3; ++k) {
        const std::string number = std::to_string(k);
        const auto value = static_cast<unsigned char>(10 * k);
        fs::rename(slice("png/s" + number + ".png", value), folder / "png" / ("s" + number + ".tif"));
        fs::rename(slice("tif/s" + number + ".tif", value), folder / "tif" / ("s" + number + ".png"));
        fs::rename(slice("bmp/s" + number + ".bmp", value), folder / "bmp" / ("s" + number + ".jpg"));
    }
    EXPECT_EQ(readImage(folder / "png").format, "PNG slices");
    EXPECT_EQ(readImage(folder / "tif").format, "TIFF slices");
    EXPECT_EQ(readImage(folder / "bmp").format, "BMP slices");
    for (const char* name : {"png", "tif", "bmp"})
        EXPECT_EQ(readImage(folder / name).values.back(), 20) << name;
}

TEST_F(BadImageOrOdd, SlicesThatMayBeMissingAreSaid) {
    const auto warned = [&](const std::string& stack, const std::vector<std::string>& names) {
        for (const std::string& name : names) slice(stack + "/" + name + ".png", 1);
        for (const std::string& warning : readImage(folder / stack).warnings)
            if (warning.find("slices may be missing") != std::string::npos) return warning;
        return std::string();
    };
    EXPECT_THAT(warned("gap", {"ct_03_a", "ct_04_a", "ct_05_a", "ct_07_a", "ct_08_a"}),
                HasSubstr("numbers jump from ct_05_a.png to ct_07_a.png where they go up by 1 otherwise"));
    EXPECT_THAT(warned("tens", {"s10", "s20", "s30", "s60", "s70"}), HasSubstr("from s30.png to s60.png"));
    EXPECT_EQ(warned("even", {"s9", "s10", "s11", "s12"}), "");
    EXPECT_EQ(warned("odd", {"s1", "s3", "s5", "s7"}), "");
    EXPECT_EQ(warned("places", {"z_0.50", "z_1.00", "z_1.50", "z_2.00"}), "");  // millimetres, not counted
    EXPECT_EQ(warned("letters", {"a", "b", "d"}), "");
}

TEST_F(BadImageOrOdd, SlicesOfPnmAreNamedWithWhatToDo) {
    fs::create_directory(folder / "pgm");
    put(folder / "pgm" / "1.pgm", "P5 1 1 255 x");
    EXPECT_THAT(refusal(folder / "pgm"),
                AllOf(HasSubstr("holds 1 slices as .pgm"), HasSubstr("mogrify -format png")));
}

// Of 3 x 2 pixels.
struct OddTiff {
    int depth = 1, samples = 1, pages = 1;
};
void writeTiff(const fs::path& path, const OddTiff& odd) {
    const std::unique_ptr<TIFF, void (*)(TIFF*)> file(TIFFOpen(path.c_str(), "w"), TIFFClose);
    TIFF* const t = file.get();
    for (int page = 0; page < odd.pages; ++page) {
        TIFFSetField(t, TIFFTAG_IMAGEWIDTH, 3);
        TIFFSetField(t, TIFFTAG_IMAGELENGTH, 2);
        if (odd.depth > 1) TIFFSetField(t, TIFFTAG_IMAGEDEPTH, odd.depth);
        TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, 8);
        TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, odd.samples);
        TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        TIFFSetField(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
        TIFFSetField(t, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
        TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, 2);
        std::string strip(static_cast<std::size_t>(6 * odd.depth * odd.samples), static_cast<char>(page + 1));
        ASSERT_GT(TIFFWriteEncodedStrip(t, 0, strip.data(), static_cast<tmsize_t>(strip.size())), 0);
        ASSERT_TRUE(TIFFWriteDirectory(t));
    }
}

TEST_F(BadImageOrOdd, TiffsSayWhatTheyHoldAndWhichPageIsDamaged) {
    const fs::path path = folder / "a.tif";
    writeTiff(path, {.depth = 4});
    EXPECT_THAT(refusal(path), HasSubstr("holds 4 slices in one page (ImageDepth)"));
    writeTiff(path, {.samples = 2, .pages = 3});
    EXPECT_THAT(refusal(path), HasSubstr("holds grey and opacity voxels of 2 numbers"));
    writeTiff(path, {.pages = 3});
    ASSERT_EQ(refusal(path), "");
    std::string damaged = bytesOf(path);
    const std::unique_ptr<TIFF, void (*)(TIFF*)> file(TIFFOpen(path.c_str(), "r"), TIFFClose);
    ASSERT_TRUE(TIFFSetDirectory(file.get(), 1));
    char& inside = damaged.at(TIFFGetStrileOffset(file.get(), 0) + 3);
    inside = static_cast<char>(~inside);
    EXPECT_THAT(refusal(put(path, damaged)), HasSubstr("its page 2 cannot be read"));
}

// ---- numbers

TEST_F(BadImageOrOdd, NumbersBeyondFloat32AreNotSaidToBeInfinite) {
    test::NiftiFile file;
    file.sformCode = 1;
    file.type = 64;
    file.voxels = bytes<double>({1, 1e300, 3, 4, 5, 6, 7, 8});
    EXPECT_THAT(refusal(put(folder / "a.nii", file.file())),
                AllOf(HasSubstr("voxel (1, 0, 0) is inf"), HasSubstr("or beyond float32's 3.4e38")));
}

}  // namespace
}  // namespace isowave
