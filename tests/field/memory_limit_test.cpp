// `--max-memory` while an image is read, format by format: what lies in a file as it is, is read through a window; what has to be
// decoded is refused before it takes more than it may.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tiffio.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <fstream>

#include "temp_folder.h"
#include "tests/field/sweep.h"
#include "tests/io/image/dicom_writer.h"
#include "tests/io/image/written.h"

namespace isowave::test {
namespace {

namespace fs = std::filesystem;

constexpr int kSize = 400;  // 64 MB of bytes
// The program, its libraries, and buffers that do not grow with an image: seen 122 MB, 50 where nothing is read.
constexpr long kProgram = 100 << 20, kLimit = 40 << 20;

struct Job {
    int code;
    long bytes;  // of memory at its peak
    std::string err;
};

// `isowave info`: all voxels are looked at, and nothing is made of them.
Job info(const TempFolder& folder, const fs::path& input, const std::vector<std::string>& more) {
    const std::string err = (folder / "err").string();
    std::vector<std::string> words{ISOWAVE_BINARY, "info", input.string(), "--max-memory",
                                   fmt::format("{}", kLimit / 1e9)};
    words.insert(words.end(), more.begin(), more.end());
    const pid_t child = ::fork();
    if (child == 0) {
        std::vector<char*> argv;
        for (std::string& w : words) argv.push_back(w.data());
        argv.push_back(nullptr);
        if (!std::freopen("/dev/null", "w", stdout) || !std::freopen(err.c_str(), "w", stderr)) ::_exit(127);
        ::execv(argv[0], argv.data());
        ::_exit(127);
    }
    int status = 0;
    rusage used{};
    ::wait4(child, &status, 0, &used);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, used.ru_maxrss * 1024, contentOf(err)};
}

// A ball of ones, 40 voxels across.
std::string voxels() {
    std::string all(std::size_t(kSize) * kSize * kSize, '\0');
    for (int z = 180; z <= 220; ++z)
        for (int y = 180; y <= 220; ++y)
            for (int x = 180; x <= 220; ++x)
                if (std::hypot(x - 200, y - 200, z - 200) <= 20)
                    all[(std::size_t(z) * kSize + std::size_t(y)) * kSize + std::size_t(x)] = 1;
    return all;
}

std::string nrrd(const char* encoding) {
    return fmt::format("type: uint8\ndimension: 3\nsizes: {0} {0} {0}\nspacings: 1 1 1\nencoding: {1}\n",
                       kSize, encoding);
}

std::string meta(const char* more) {
    return fmt::format(
        "ObjectType = Image\nNDims = 3\nDimSize = {0} {0} {0}\nElementType = MET_UCHAR\n{1}"
        "ElementDataFile = LOCAL\n",
        kSize, more);
}

NiftiFile nifti() {
    NiftiFile file;
    file.size = {kSize, kSize, kSize};
    file.type = 2;
    file.sformCode = 1;
    return file;
}

void put(const fs::path& file, const std::string& head, const std::string& rest) {
    std::ofstream(file, std::ios::binary) << head << rest;
}

void putGz(const fs::path& file, const std::string& plain, const std::string& packed) {
    put(file, plain, "");
    gzFile out = gzopen(file.c_str(), "ab1");
    gzwrite(out, packed.data(), static_cast<unsigned>(packed.size()));
    gzclose(out);
}

void putTiff(const fs::path& file, const std::string& all) {
    TIFF* const t = TIFFOpen(file.c_str(), "w");
    for (int z = 0; z < kSize; ++z) {
        for (const std::uint32_t tag : {TIFFTAG_IMAGEWIDTH, TIFFTAG_IMAGELENGTH, TIFFTAG_ROWSPERSTRIP})
            TIFFSetField(t, tag, kSize);
        TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, 8);
        TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        TIFFSetField(t, TIFFTAG_COMPRESSION, COMPRESSION_LZW);
        std::string page = all.substr(std::size_t(z) * kSize * kSize, std::size_t(kSize) * kSize);
        TIFFWriteEncodedStrip(t, 0, page.data(), static_cast<tmsize_t>(page.size()));
        TIFFWriteDirectory(t);
    }
    TIFFClose(t);
}

std::string dicom(std::string all) {
    DicomSays says;
    says.columns = says.rows = says.frames = kSize;
    says.allocated = says.stored = 8;
    says.isSigned = 0;
    says.spacing = {1, 1};
    says.more.numbers(0x00180088, {1});
    says.pixels = std::move(all);
    return dicomFile(dicomSet(says));
}

class MemoryLimit : public testing::Test {
  protected:
    MemoryLimit() {
        inAChild([&] {
            const std::string all = voxels();
            std::string packed(compressBound(all.size()), '\0');
            uLongf length = packed.size();
            compress2(reinterpret_cast<Bytef*>(packed.data()), &length,
                      reinterpret_cast<const Bytef*>(all.data()), all.size(), 1);
            packed.resize(length);
            put(folder / "a.raw", "", all);
            put(folder / "a.nrrd", nrrdFile(nrrd("raw"), ""), all);
            put(folder / "a.mha", meta("BinaryData = True\n"), all);
            put(folder / "a.nii", nifti().header(), all);
            putGz(folder / "packed.nrrd", nrrdFile(nrrd("gzip"), ""), all);
            put(folder / "packed.mha", meta("BinaryData = True\nCompressedData = True\n"), packed);
            putGz(folder / "packed.nii.gz", "", nifti().header() + all);
            putTiff(folder / "packed.tif", all);
            put(folder / "packed.dcm", dicom(all), "");
        });
    }
    TempFolder folder;
};

TEST_F(MemoryLimit, IsKeptByEveryFormatWhileReading) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers take memory of their own";
#endif
    for (const char* name : {"a.raw", "a.nrrd", "a.mha", "a.nii"}) {
        std::vector<std::string> more;
        if (std::string(name) == "a.raw")
            more = {"--size", fmt::format("{0}x{0}x{0}", kSize), "--type", "uint8", "--spacing", "1x1x1"};
        const Job job = info(folder, folder / name, more);
        EXPECT_EQ(job.code, 0) << name << ": " << job.err;
        EXPECT_LT(job.bytes, kProgram + kLimit) << name;
    }
    for (const char* name : {"packed.nrrd", "packed.mha", "packed.nii.gz", "packed.tif", "packed.dcm"}) {
        const Job job = info(folder, folder / name, {});
        EXPECT_EQ(job.code, 3) << name << ": " << job.err;
        EXPECT_NE(job.err.find("more than the limit of"), job.err.npos) << name << ": " << job.err;
        EXPECT_LT(job.bytes, kProgram + kLimit) << name;
    }
}

}  // namespace
}  // namespace isowave::test
