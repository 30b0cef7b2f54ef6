// Every image that is wrong is refused in one line, nothing is printed beside it, and nothing crashes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "isowave/image.h"
#include "tests/io/image/files.h"
#include "tests/io/image/itk.h"

namespace isowave {
namespace {

namespace fs = std::filesystem;
using test::bytesOf;
using test::put;
using test::refusal;
using testing::AllOf;
using testing::HasSubstr;

class BadImage : public test::ImageFiles {
  protected:
    // A small NRRD, field by field; what is given replaces or adds a line.
    fs::path nrrd(const std::string& extra, const std::string& sizes = "4 3 2",
                  const std::string& type = "uint8", const std::string& voxels = std::string(24, '\7')) {
        std::istringstream count(sizes);
        int dimension = 0;
        for (std::int64_t n; count >> n;) ++dimension;
        return put(folder / "a.nrrd", "NRRD0005\ntype: " + type +
                                          "\ndimension: " + std::to_string(dimension) + "\nsizes: " + sizes +
                                          "\nendian: little\nencoding: raw\n" + extra + "\n" + voxels);
    }
    fs::path mha(const std::string& extra, const std::string& sizes = "4 3 2",
                 const std::string& type = "MET_UCHAR") {
        return put(folder / "a.mha", "ObjectType = Image\nNDims = 3\nDimSize = " + sizes + "\n" + extra +
                                         "ElementType = " + type + "\nElementDataFile = LOCAL\n" +
                                         std::string(24, '\7'));
    }
    // A small NIfTI whose header bytes at `offset` are those of `value`.
    template <class T>
    fs::path nifti(std::size_t offset, T value) {
        test::writeItk(test::patternImage<short>({4, 3, 2}).GetPointer(), folder / "whole.nii");
        std::string bytes = bytesOf(folder / "whole.nii");
        bytes.replace(offset, sizeof value, reinterpret_cast<const char*>(&value), sizeof value);
        return put(folder / "a.nii", bytes);
    }
};

TEST_F(BadImage, FixturesAreGoodBeforeTheyAreSpoilt) {
    EXPECT_EQ(refusal(nrrd("")), "");
    EXPECT_EQ(refusal(mha("")), "");
    EXPECT_EQ(refusal(nifti<short>(40, 3)), "");
    for (const float v : readImage(folder / "a.nrrd").values) EXPECT_EQ(v, 7);
    for (const float v : readImage(folder / "a.mha").values) EXPECT_EQ(v, 7);
}

TEST_F(BadImage, MissingOrEmpty) {
    EXPECT_THAT(refusal(folder / "no.nrrd"), HasSubstr("no.nrrd: no such file"));
    for (const char* name : {"e.nrrd", "e.nii", "e.nii.gz", "e.mha", "e.tif", "e.png", "e.dcm", "e"})
        EXPECT_THAT(refusal(put(folder / name, "")), HasSubstr("is empty")) << name;
    fs::create_directory(folder / "none");
    EXPECT_THAT(refusal(folder / "none"),
                HasSubstr("is a folder without DICOM, TIFF, PNG, BMP or JPEG slices"));
    EXPECT_THAT(refusal("/dev/null"), HasSubstr("is neither a file nor a folder"));
    EXPECT_THAT(refusal(put(folder / "a.abc", "what?")), HasSubstr("is of no known image format"));
}

TEST_F(BadImage, GarbageUnderAGoodName) {
    for (const char* name : {"g.nrrd", "g.nhdr", "g.nii", "g.nii.gz", "g.mha", "g.mhd", "g.tif", "g.png",
                             "g.bmp", "g.jpg", "g.dcm"}) {
        EXPECT_NE(refusal(put(folder / name, std::string(2000, '\xA5'))), "") << name;
        EXPECT_NE(refusal(put(folder / name, "hello\n")), "") << name;
    }
}

TEST_F(BadImage, Flat) {
    for (const std::string name : {"a.png", "a.bmp", "a.jpg", "a.tif", "a.nrrd", "a.mha", "a.nii"}) {
        test::writeItk(test::patternImage<unsigned char, 2>({7, 5}).GetPointer(), folder / name);
        EXPECT_THAT(refusal(folder / name), HasSubstr("is a 2D image (7 x 5); expected a volume")) << name;
    }
}

TEST_F(BadImage, Colours) {
    using Rgb = itk::Image<itk::RGBPixel<unsigned char>, 3>;
    using Vector = itk::Image<itk::Vector<float, 2>, 3>;
    const auto rgb = Rgb::New();
    rgb->SetRegions(Rgb::RegionType({7, 5, 4}));
    rgb->Allocate(true);
    const auto vector = Vector::New();
    vector->SetRegions(Vector::RegionType({7, 5, 4}));
    vector->Allocate(true);
    for (const std::string name : {"a.nrrd", "a.mha", "a.nii", "a.tif"}) {
        test::writeItk(rgb.GetPointer(), folder / name);
        EXPECT_THAT(refusal(folder / name), HasSubstr("expected one number a voxel")) << name;
        if (name == "a.tif") continue;
        test::writeItk(vector.GetPointer(), folder / name);
        EXPECT_THAT(refusal(folder / name),
                    testing::AnyOf(HasSubstr("expected one"), HasSubstr("choose one")))
            << name;
    }
    using Rgb2 = itk::Image<itk::RGBPixel<unsigned char>, 2>;
    const auto slice = Rgb2::New();
    slice->SetRegions(Rgb2::RegionType({7, 5}));
    slice->Allocate(true);
    fs::create_directory(folder / "stack");
    for (const char* name : {"1.png", "1.bmp", "1.jpg"}) {
        fs::remove_all(folder / "stack");
        fs::create_directory(folder / "stack");
        itk::RGBPixel<unsigned char> red;
        red.Set(200, 100, 100);
        slice->FillBuffer(red);
        test::writeItk(slice.GetPointer(), folder / "stack" / name);
        EXPECT_THAT(refusal(folder / "stack"), AllOf(HasSubstr(name), HasSubstr("RGB")));
        red.Set(100, 100, 100);
        slice->FillBuffer(red);
        test::writeItk(slice.GetPointer(), folder / "stack" / name);
        EXPECT_EQ(refusal(folder / "stack").empty(), name != std::string("1.png")) << name;
    }
}

// An option that chooses among what the format cannot hold is not passed over.
TEST_F(BadImage, OptionsOfOtherFormats) {
    const fs::path image = nrrd("");
    const auto says = [&](const fs::path& path, const ImageReadOptions& options) -> std::string {
        try {
            readImage(path, options);
        } catch (const UsageError& e) {
            return e.what();
        }
        return "";
    };
    EXPECT_EQ(says(image, {.volume = 1}), "");
    EXPECT_THAT(says(image, {.series = "1"}),
                HasSubstr("--series is for DICOM; " + image.string() + " is NRRD"));
    EXPECT_THAT(says(image, {.stack = 1}), HasSubstr("--stack is for DICOM"));
    EXPECT_THAT(says(image, {.time = 1}), HasSubstr("--time is for DICOM, TIFF"));
    EXPECT_THAT(says(image, {.channel = 1}), HasSubstr("--channel is for TIFF"));
    EXPECT_THAT(says(image, {.resampleSlices = true}), HasSubstr("--resample-slices is for DICOM"));
    test::writeItk(test::patternImage<unsigned char>({7, 5, 4}).GetPointer(), folder / "a.tif");
    EXPECT_EQ(says(folder / "a.tif", {.channel = 1, .time = 1}), "");
    EXPECT_THAT(says(folder / "a.tif", {.volume = 1}), HasSubstr("a.tif is TIFF; leave it out"));
}

TEST_F(BadImage, NotANumber) {
    auto image = test::patternImage<float>({7, 5, 4});
    image->SetPixel({3, 2, 1}, std::numeric_limits<float>::quiet_NaN());
    image->SetPixel({3, 2, 2}, std::numeric_limits<float>::infinity());
    test::writeItk(image.GetPointer(), folder / "a.nrrd");
    EXPECT_THAT(refusal(folder / "a.nrrd"),
                HasSubstr("voxel (3, 2, 1) is nan, the first of 2 that are not finite"));
    auto doubles = test::patternImage<double>({7, 5, 4});
    doubles->SetPixel({6, 4, 3}, -1e300);  // more than float32 reaches
    test::writeItk(doubles.GetPointer(), folder / "b.mha");
    EXPECT_THAT(refusal(folder / "b.mha"), HasSubstr("voxel (6, 4, 3) is -inf, the first of 1"));
}

TEST_F(BadImage, SpacingThatIsNotPositive) {
    const std::string expected = "expected positive numbers";
    EXPECT_THAT(refusal(nrrd("spacings: 1 0 1\n")),
                AllOf(HasSubstr("its spacing is 1 x 0 x 1"), HasSubstr(expected)));
    EXPECT_THAT(refusal(nrrd("spacings: 1 1 -2\n")), HasSubstr("its spacing is 1 x 1 x -2"));
    EXPECT_THAT(refusal(nrrd("spacings: 1 inf 1\n")), HasSubstr("its spacing is 1 x inf x 1"));
    EXPECT_THAT(refusal(nrrd("space: left-posterior-superior\nspace directions: (1,0,0) (0,0,0) (0,0,1)\n")),
                HasSubstr("a spacing of zero"));
    EXPECT_THAT(refusal(mha("ElementSpacing = 1 -1 1\n")), HasSubstr("its spacing is 1 x -1 x 1"));
    EXPECT_THAT(refusal(mha("ElementSpacing = 0 1 1\n")), HasSubstr("its spacing is 0 x 1 x 1"));
    EXPECT_THAT(refusal(mha("ElementSize = 1 1 0\n")), HasSubstr("its spacing is 1 x 1 x 0"));
    ImageReadOptions options;
    options.spacing = {{1, -1, 1}};
    EXPECT_THAT(refusal(nrrd(""), options), HasSubstr("the given spacing 1 x -1 x 1 must be positive"));
}

TEST_F(BadImage, AGivenSpacingHealsAWrongOne) {
    ImageReadOptions options;
    options.spacing = {{1, 2, 3}};
    EXPECT_EQ(refusal(nrrd("spacings: 1 -2 1\n"), options), "");
    EXPECT_EQ(refusal(mha("ElementSpacing = 1 -1 1\n"), options), "");
}

TEST_F(BadImage, AxesThatSpanNoSpace) {
    EXPECT_THAT(refusal(nrrd("space: left-posterior-superior\nspace directions: (1,0,0) (1,0,0) (0,0,1)\n")),
                HasSubstr("its axes point along (1, 0, 0) (1, 0, 0) (0, 0, 1), a direction matrix that "
                          "cannot be inverted"));
    EXPECT_THAT(refusal(mha("TransformMatrix = 1 0 0 0 1 0 0 1 0\n")), HasSubstr("cannot be inverted"));
    EXPECT_THAT(refusal(mha("TransformMatrix = 1 0 0 0 0 0 0 0 1\n")), HasSubstr("cannot be inverted"));
    EXPECT_THAT(refusal(mha("Offset = 0 nan 0\n")),
                HasSubstr("'Offset' says '0 nan 0'; expected 3 finite numbers"));
    EXPECT_NE(refusal(nrrd("space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
                           "space origin: (0,inf,0)\n")),
              "");
    EXPECT_THAT(refusal(nifti<float>(280, std::numeric_limits<float>::infinity())),
                HasSubstr("its sform holds inf; expected a finite number"));
    EXPECT_THAT(refusal(nifti<float>(280, 0.0f)), HasSubstr("its spacing is 0 x 1 x 1"));  // sform
    EXPECT_THAT(refusal(nifti<float>(284, 1e9f)), HasSubstr("cannot be inverted"));
}

TEST_F(BadImage, EncodingThatIsNotRead) {
    EXPECT_THAT(refusal(put(folder / "a.nrrd",
                            "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 4 3 2\n"
                            "encoding: bzip2\n\nBZh9")),
                HasSubstr("'encoding' says bzip2; expected raw, gzip, ascii or hex"));
}

TEST_F(BadImage, SizesThatCannotBe) {
    EXPECT_THAT(refusal(nrrd("", "4 0 2")), HasSubstr("its size is 4 x 0 x 2; expected at least 1"));
    EXPECT_THAT(refusal(nrrd("", "4 -3 2")), HasSubstr("its size is 4 x -3 x 2"));
    EXPECT_THAT(refusal(nrrd("", "4294967296 4294967296 4294967296")),
                HasSubstr("more than can be addressed"));
    EXPECT_THAT(refusal(nrrd("", "99999999999999999999999 2 2")), HasSubstr("expected whole numbers"));
    EXPECT_THAT(refusal(nrrd("", "100000 100000 100000")),
                HasSubstr("'sizes' says 100000 x 100000 x 100000 (1000 TB) but the file holds 24 bytes"));
    EXPECT_THAT(refusal(mha("", "4 0 2")), HasSubstr("its size is 4 x 0 x 2"));
    EXPECT_THAT(refusal(mha("", "2000000000 2000000000 2000000000")),
                HasSubstr("more than can be addressed"));
    EXPECT_THAT(refusal(nifti<short>(42, -4)), HasSubstr("its size is -4 x 3 x 2"));
    EXPECT_THAT(refusal(nifti<short>(42, 32767)), HasSubstr("its header says 32767 x 3 x 2"));
    EXPECT_THAT(refusal(nifti<short>(40, 9)), HasSubstr("its header says 9 dimensions"));
}

// Holes in the file stand in for the voxels.
TEST_F(BadImage, MoreThanMemoryHolds) {
    std::ofstream(folder / "a.raw").close();
    fs::resize_file(folder / "a.raw", std::uintmax_t(1) << 30);
    ImageReadOptions options;
    options.raw = RawLayout{{1024, 1024, 1024}, "uint8"};
    options.memoryLimit = std::int64_t(1) << 32;
    EXPECT_THAT(
        refusal(folder / "a.raw", options),
        HasSubstr("its 1024 x 1024 x 1024 voxels take 4362 MB to read, more than the limit of 4295 MB"));
}

TEST_F(BadImage, RawThatDoesNotFit) {
    const fs::path path = put(folder / "a.raw", std::string(100, 'x'));
    ImageReadOptions options;
    options.raw = RawLayout{{4, 5, 6}, "uint8"};
    EXPECT_THAT(refusal(path, options),
                HasSubstr("4 x 5 x 6 uint8 voxels take 120 bytes but the file holds 100"));
    options.raw = RawLayout{{4, 5, 5}, "uint8", false, 1};
    EXPECT_THAT(refusal(path, options), HasSubstr("holds 99 after a header of 1"));
    options.raw = RawLayout{{4, 5, 5}, "uint8", false, -1};
    EXPECT_THAT(refusal(path, options), HasSubstr("a header of -1 bytes"));
    options.raw = RawLayout{{4, 5, 5}, "uint24"};
    EXPECT_THAT(refusal(path, options), HasSubstr("said to be 'uint24'; expected int8"));
    options.raw = RawLayout{{4, 5, 0}, "uint8"};
    EXPECT_THAT(refusal(path, options), HasSubstr("its size is 4 x 5 x 0"));
    options.raw = RawLayout{{1L << 40, 1L << 40, 1}, "uint8"};
    EXPECT_THAT(refusal(path, options), HasSubstr("more than can be addressed"));
}

TEST_F(BadImage, DetachedVoxelsThatAreMissing) {
    const auto image = test::patternImage<short>({7, 5, 4});
    test::writeItk(image.GetPointer(), folder / "a.nhdr");
    fs::remove(folder / "a.raw");
    EXPECT_THAT(refusal(folder / "a.nhdr"), AllOf(HasSubstr("a.raw, which is missing")));
    test::writeItk(image.GetPointer(), folder / "b.mhd");
    fs::remove(folder / "b.raw");
    EXPECT_THAT(refusal(folder / "b.mhd"), AllOf(HasSubstr("b.raw, which is missing")));
}

TEST_F(BadImage, SlicesThatDiffer) {
    test::writeItk(test::patternImage<unsigned char, 2>({7, 5}).GetPointer(), folder / "1.png");
    test::writeItk(test::patternImage<unsigned char, 2>({7, 6}).GetPointer(), folder / "2.png");
    EXPECT_THAT(refusal(folder),
                HasSubstr("2.png: is a slice of 7 x 6 x 1 but the first, 1.png, is 7 x 5 x 1"));
    test::writeItk(test::patternImage<unsigned short, 2>({7, 5}).GetPointer(), folder / "2.png");
    EXPECT_THAT(refusal(folder),
                HasSubstr("2.png: is a slice of uint16 voxels but the first, 1.png, holds uint8"));
    put(folder / "2.png", "");
    EXPECT_THAT(refusal(folder), HasSubstr("2.png: is empty"));
    test::writeItk(test::patternImage<unsigned char, 2>({7, 5}).GetPointer(), folder / "2.tif");
    EXPECT_THAT(refusal(folder), HasSubstr("holds 2 PNG and 1 TIFF slices"));
    const fs::path other = folder / "other";
    fs::create_directory(other);
    test::writeItk(test::patternImage<unsigned char, 2>({7, 5}).GetPointer(), other / "1.jpg");
    test::writeItk(test::patternImage<unsigned char, 2>({7, 6}).GetPointer(), other / "2.jpg");
    EXPECT_THAT(refusal(other),
                HasSubstr("2.jpg: is a slice of 7 x 6 x 1 but the first, 1.jpg, is 7 x 5 x 1"));
    test::writeItk(test::patternImage<unsigned char, 2>({7, 6}).GetPointer(), other / "2.bmp");
    EXPECT_THAT(refusal(other), HasSubstr("holds 2 JPEG and 1 BMP slices"));
}

// ---- truncations

enum class Cut { refused, refusedOrWhole };

class Truncation : public BadImage {
  protected:
    // Cuts `file` at every `step`-th byte; `image` is what is then read (the file, its header, its folder).
    // refusedOrWhole: the last bytes hold nothing that is needed (PNG's end mark), so the voxels may be
    // whole.
    void sweep(const fs::path& file, const fs::path& image, Cut cut = Cut::refused, std::size_t step = 1,
               const ImageReadOptions& options = {}) {
        SCOPED_TRACE(file.filename().string());
        ASSERT_EQ(refusal(image, options), "");
        const std::vector<float> whole = readImage(image, options).values;
        const std::string bytes = bytesOf(file);
        testing::internal::CaptureStderr();
        testing::internal::CaptureStdout();
        std::size_t refused = 0, tried = 0;
        for (std::size_t length = 0; length < bytes.size(); length += step, ++tried) {
            put(file, bytes.substr(0, length));
            try {
                const Image read = readImage(image, options);
                EXPECT_EQ(cut, Cut::refusedOrWhole) << "cut at " << length << " of " << bytes.size();
                EXPECT_EQ(read.values, whole) << "cut at " << length << " of " << bytes.size();
            } catch (const InputError& e) {
                ++refused;
                EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
            }
        }
        const std::string printed =
            testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout();
        EXPECT_EQ(printed.substr(0, 500), "");
        EXPECT_GE(refused, cut == Cut::refused ? tried : tried / 3);
        put(file, bytes);
    }
};

TEST_F(Truncation, OfNrrd) {
    const auto image = test::patternImage<short>({7, 5, 4});
    for (const bool compress : {false, true}) {
        test::writeItk(image.GetPointer(), folder / "a.nrrd", compress);
        sweep(folder / "a.nrrd", folder / "a.nrrd");
    }
    test::writeItk(image.GetPointer(), folder / "b.nhdr");
    sweep(folder / "b.raw", folder / "b.nhdr");
    test::writeItk(image.GetPointer(), folder / "c.nhdr", true);
    sweep(folder / "c.raw.gz", folder / "c.nhdr");
}

// Cut within the last line, the name of the data file, a detached header can only name another file.
TEST_F(Truncation, OfADetachedHeader) {
    const auto image = test::patternImage<short>({7, 5, 4});
    test::writeItk(image.GetPointer(), folder / "b.nhdr");
    sweep(folder / "b.nhdr", folder / "b.nhdr", Cut::refusedOrWhole);
    test::writeItk(image.GetPointer(), folder / "b.mhd");
    sweep(folder / "b.mhd", folder / "b.mhd", Cut::refusedOrWhole);
}

TEST_F(Truncation, OfMetaImage) {
    const auto image = test::patternImage<short>({7, 5, 4});
    for (const bool compress : {false, true}) {
        test::writeItk(image.GetPointer(), folder / "a.mha", compress);
        sweep(folder / "a.mha", folder / "a.mha");
    }
    test::writeItk(image.GetPointer(), folder / "b.mhd");
    sweep(folder / "b.raw", folder / "b.mhd");
    test::writeItk(image.GetPointer(), folder / "c.mhd", true);
    sweep(folder / "c.zraw", folder / "c.mhd");
}

TEST_F(Truncation, OfNifti) {
    for (const std::string name : {"a.nii", "a.nii.gz"}) {
        test::writeItk(test::patternImage<short>({7, 5, 4}).GetPointer(), folder / name);
        sweep(folder / name, folder / name);
    }
}

TEST_F(Truncation, OfRaw) {
    put(folder / "a.raw", std::string(120 + 8, 'x'));
    ImageReadOptions options;
    options.raw = RawLayout{{4, 5, 3}, "int16", true, 8};
    sweep(folder / "a.raw", folder / "a.raw", Cut::refused, 1, options);
}

TEST_F(Truncation, OfTiff) {
    for (const bool compress : {false, true}) {
        test::writeItk(test::patternImage<unsigned short>({7, 5, 4}).GetPointer(), folder / "a.tif",
                       compress);
        sweep(folder / "a.tif", folder / "a.tif");
    }
}

TEST_F(Truncation, OfAPngSlice) {
    const fs::path stack = folder / "stack";
    fs::create_directory(stack);
    test::writeItk(test::patternImage<unsigned short, 2>({37, 25}).GetPointer(), stack / "1.png");
    test::writeItk(test::patternImage<unsigned short, 2>({37, 25}).GetPointer(), stack / "2.png");
    sweep(stack / "1.png", stack);
    sweep(stack / "2.png", stack);
}

TEST_F(Truncation, OfABmpOrJpegSlice) {
    for (const std::string extension : {".bmp", ".jpg"}) {
        const fs::path stack = folder / extension.substr(1);
        fs::create_directory(stack);
        for (const char* name : {"1", "2"})
            test::writeItk(test::patternImage<unsigned char, 2>({37, 25}).GetPointer(),
                           stack / (name + extension));
        sweep(stack / ("1" + extension), stack);
        sweep(stack / ("2" + extension), stack);
    }
}

// ---- corruptions

}  // namespace
}  // namespace isowave
