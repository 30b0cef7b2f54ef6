// Every format that isowave reads, damaged everywhere: the promises of SECURITY.md, and how many damaged copies are read
// all the same. A prefix may be read only where the format does not say its length or where what is cut off means nothing;
// that is written beside each format.
#include "tests/field/sweep.h"

#include <fmt/format.h>
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <signal.h>
#include <tiffio.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "curves2d/polygon_input.h"
#include "io/mesh/read.h"
#include "io/picture/npy.h"
#include "io/picture/png.h"
#include "isowave/curves.h"
#include "isowave/error.h"
#include "isowave/image.h"
#include "isowave/subdivision.h"
#include "subdivision/curves/curve_files.h"
#include "subdivision/lattice/grid_files.h"
#include "subdivision/meshes/mesh_files.h"
#include "temp_folder.h"
#include "tests/io/image/dicom_writer.h"
#include "tests/io/image/written.h"
#include "tests/io/mesh/zip.h"
#include "volume/mesh_repair.h"
#include "volume/vdb_file.h"
#include "wavelets/pyramid_file.h"
#include "zoo/zoo.h"

namespace isowave::test {
namespace {

namespace fs = std::filesystem;

// How many of a file's prefixes may be read.
enum class Prefixes { refused, maybeRead };

class Sweep : public testing::Test {
  protected:
    // The bytes as they are must be read; of the damaged ones some must be refused, and some not.
    Outcome all(const std::string& name, const std::string& bytes, const Read& read,
                Prefixes prefixes = Prefixes::refused, Extent quick = {}) {
        std::ofstream(folder / name, std::ios::binary) << bytes;
        inAChild([&] { read(folder / name); });
        const Outcome seen = sweep(folder / name, bytes, read, quick);
        EXPECT_GT(seen.flipsRead, 0u) << name << ": not every byte matters, or a sum of all of them is wrong";
        if (prefixes == Prefixes::refused) {
            EXPECT_EQ(seen.prefixesRead, 0u) << name;
        }
        EXPECT_LT(seen.prefixesRead, seen.prefixes) << name;
        return seen;
    }
    TempFolder folder;
};

// ---- meshes

void checkMesh(const TriangleMesh& mesh) {
    for (const Triangle& t : mesh.triangles)
        for (const auto corner : t)
            if (corner >= mesh.points.size()) throw std::logic_error("a corner beyond the points");
    for (const Point& p : mesh.points)
        for (const double x : p)
            if (!std::isfinite(x)) throw std::logic_error("a coordinate that is not finite");
}

// As `isowave lod` takes a mesh: read, then repaired.
void readAndRepair(const fs::path& file) {
    MeshFile read = readMeshFile(file);
    checkMesh(read.mesh);
    checkMesh(repairMesh(std::move(read.mesh), file.string()));
}

void readPolygonsOf(const fs::path& file) {
    subdivision::requireManifold(subdivision::readPolygonMesh(file), file.string());
}

// A cube of 12 triangles, and one beside it.
TriangleMesh twoCubes() {
    TriangleMesh mesh;
    for (const double shift : {0.0, 3.25})
        for (int i = 0; i < 8; ++i)
            mesh.points.push_back({shift + (i & 1), 0.5 + (i >> 1 & 1), 0.125 * (i >> 2 & 1)});
    const int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                             {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const std::uint32_t from : {0u, 8u})
        for (const auto& f : faces) {
            const auto corner = [&](int i) { return from + static_cast<std::uint32_t>(f[i]); };
            mesh.triangles.push_back({corner(0), corner(1), corner(2)});
            mesh.triangles.push_back({corner(0), corner(2), corner(3)});
        }
    return mesh;
}

std::string written(const TempFolder& folder, MeshFormat format) {
    const fs::path file = folder / (std::string("whole") + extensionOf(format));
    inAChild([&] { writeMesh(file, twoCubes(), format); });
    return contentOf(file);
}

TEST_F(Sweep, OfBinaryMeshes) {
    all("a.stl", written(folder, MeshFormat::stl), readAndRepair);
    all("a.ply", written(folder, MeshFormat::ply), readAndRepair);
    all("b.ply", written(folder, MeshFormat::ply), readPolygonsOf);
    all("a.glb", written(folder, MeshFormat::glb), readAndRepair);
}

// A box as polygons, its numbers as text, and as an archive with a checksum.
TEST_F(Sweep, OfXmlMeshes) {
    std::string points, corners, ends, vertices, triangles;
    const TriangleMesh mesh = twoCubes();
    for (const Point& p : mesh.points) {
        points += fmt::format("{} {} {} ", p[0], p[1], p[2]);
        vertices += fmt::format("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>", p[0], p[1], p[2]);
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& [a, b, c] = mesh.triangles[i];
        corners += fmt::format("{} {} {} ", a, b, c);
        ends += fmt::format("{} ", 3 * (i + 1));
        triangles += fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>", a, b, c);
    }
    all("a.vtp",
        fmt::format(
            "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"{}\" "
            "NumberOfPolys=\"{}\"><Points><DataArray "
            "type=\"Float32\" NumberOfComponents=\"3\" "
            "format=\"ascii\">{}</DataArray></Points><Polys><DataArray "
            "type=\"Int32\" Name=\"connectivity\" format=\"ascii\">{}</DataArray><DataArray type=\"Int32\" "
            "Name=\"offsets\" format=\"ascii\">{}</DataArray></Polys></Piece></PolyData></VTKFile>",
            mesh.points.size(), mesh.triangles.size(), points, corners, ends),
        readAndRepair);
    all("a.3mf",
        zipOf(
            {{"3D/3dmodel.model",
              "<model><resources><object id=\"1\"><mesh><vertices>" + vertices + "</vertices><triangles>" +
                  triangles +
                  "</triangles></mesh></object></resources><build><item objectid=\"1\"/></build></model>"}}),
        readAndRepair);
}

std::string textStl() {
    const TriangleMesh mesh = twoCubes();
    std::string text = "solid cubes\n";
    for (const Triangle& t : mesh.triangles) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (const auto c : t) {
            const Point& p = mesh.points[c];
            text += fmt::format("vertex {} {} {}\n", p[0], p[1], p[2]);
        }
        text += "endloop\nendfacet\n";
    }
    return text + "endsolid cubes\n";
}

std::string textPly() {
    const TriangleMesh mesh = twoCubes();
    std::string text = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.points.size(), mesh.triangles.size());
    for (const Point& p : mesh.points) text += fmt::format("{} {} {}\n", p[0], p[1], p[2]);
    for (const Triangle& t : mesh.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    return text;
}

// A prefix of a text is a text: without the last words, digits or line it may say a mesh all the same.
TEST_F(Sweep, OfTextMeshes) {
    all("a.stl", textStl(), readAndRepair, Prefixes::maybeRead);
    all("a.ply", textPly(), readAndRepair, Prefixes::maybeRead);
    all("a.obj", written(folder, MeshFormat::obj), readAndRepair, Prefixes::maybeRead);
    all("b.obj", written(folder, MeshFormat::obj), readPolygonsOf, Prefixes::maybeRead);
    all("a.off", written(folder, MeshFormat::off), readAndRepair, Prefixes::maybeRead);
    all("b.off", written(folder, MeshFormat::off), readPolygonsOf, Prefixes::maybeRead);
}

TEST_F(Sweep, OfDetailsOfMeshes) {
    inAChild([&] {
        subdivision::PolygonMesh mesh;
        mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        for (const auto& f : {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{1, 2, 3}, Triangle{2, 0, 3}})
            mesh.addFace({f[0], f[1], f[2]});
        subdivision::PolygonMesh fine = subdivision::subdivided(mesh, "loop", 1);
        for (Vec3& p : fine.points) p += {0.01 * p.y, 0.02 * p.x, p.z * p.x};
        subdivision::saveHierarchy(folder / "whole", subdivision::decompose(fine, "loop", {.levels = 1}));
    });
    // Its checksums leave nothing that may change but the header's spaces.
    const Outcome seen = sweep(folder / "a.details", contentOf(folder / "whole"), [](const fs::path& file) {
        subdivision::reconstruct(subdivision::loadHierarchy(file));
    });
    EXPECT_EQ(seen.prefixesRead, 0u);
}

// ---- images

constexpr std::int64_t kMemory = std::int64_t(512) << 20;

Read imageReader(ImageReadOptions options = {}) {
    options.memoryLimit = kMemory;
    return [options](const fs::path& file) {
        const Image image = readImage(file, options);
        if (image.voxelCount() != static_cast<std::int64_t>(image.values.size()))
            throw std::logic_error("voxels are missing");
        for (const double s : image.spacing())
            if (!(s > 0 && std::isfinite(s))) throw std::logic_error("a spacing that is none");
    };
}

std::vector<std::int16_t> pattern() {
    std::vector<std::int16_t> voxels(140);
    for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = static_cast<std::int16_t>(i * 37 % 251);
    return voxels;
}

NiftiFile smallNifti(bool second = false) {
    NiftiFile file;
    file.size = {7, 5, 4};
    file.sformCode = 1;
    file.srow = {0.7, 0.1, 0, -11, 0, 1.1, 0.2, 22, 0, 0, 2.5, 305};
    file.voxels = bytes(pattern());
    file.second = second;
    return file;
}

std::string gzipped(const TempFolder& folder, const std::string& text) {
    const std::string file = (folder / "whole.gz").string();
    gzFile out = gzopen(file.c_str(), "wb9");
    gzwrite(out, text.data(), static_cast<unsigned>(text.size()));
    gzclose(out);
    return contentOf(file);
}

TEST_F(Sweep, OfCompressedMeshes) {
    all("a.stl.gz", gzipped(folder, written(folder, MeshFormat::stl)), readAndRepair);
    all("a.ply.gz", gzipped(folder, written(folder, MeshFormat::ply)), readPolygonsOf);
}

// gzip's header has a time and a system that nobody checks; every bit of its data has a checksum.
TEST_F(Sweep, OfNifti) {
    all("a.nii", smallNifti().file(), imageReader());
    all("b.nii", smallNifti(true).file(), imageReader());
    all("a.nii.gz", gzipped(folder, smallNifti().file()), imageReader());
    NiftiFile pair = smallNifti();
    pair.pair = true;
    std::ofstream(folder / "p.img", std::ios::binary) << pair.voxels;
    all("p.hdr", pair.header().substr(0, 348), imageReader());
}

std::string nrrd(const std::string& encoding, const std::string& voxels) {
    return nrrdFile(
        "type: short\ndimension: 3\nsizes: 7 5 4\nendian: little\nspace: LAS\nspace units: \"um\" \"um\" "
        "\"um\"\n"
        "space directions: (0.7,0,0) (0,1.1,0) (0,0,2.5)\nspace origin: (1,2,3)\nencoding: " +
            encoding + "\n",
        voxels);
}

// Of a text's last number a digit may be missing.
TEST_F(Sweep, OfNrrd) {
    const std::string voxels = bytes(pattern());
    std::string text, hex;
    for (const auto v : pattern()) text += fmt::format("{}\n", v);
    for (const unsigned char c : voxels) hex += fmt::format("{:02x}", c);
    all("a.nrrd", nrrd("raw", voxels), imageReader());
    all("b.nrrd", nrrd("gzip", gzipped(folder, voxels)), imageReader());
    all("c.nrrd", nrrd("ascii", text), imageReader(), Prefixes::maybeRead);
    all("d.nrrd", nrrd("hex", hex), imageReader());
    std::ofstream(folder / "a.raw", std::ios::binary) << voxels;
    all("a.nhdr", nrrd("raw\ndata file: a.raw", ""), imageReader(), Prefixes::maybeRead);
}

std::string metaImage(const std::string& place) {
    return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
           "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = -11.5 22.25 305\nElementSpacing = 0.7 1.1 2.5\n"
           "DimSize = 7 5 4\nElementType = MET_SHORT\n" +
           place;
}

TEST_F(Sweep, OfMetaImage) {
    const std::string voxels = bytes(pattern());
    all("a.mha", metaImage("ElementDataFile = LOCAL\n") + voxels, imageReader());
    std::string packed(compressBound(voxels.size()), '\0');
    uLongf length = packed.size();
    compress(reinterpret_cast<Bytef*>(packed.data()), &length, reinterpret_cast<const Bytef*>(voxels.data()),
             voxels.size());
    packed.resize(length);
    all("b.mha", metaImage("CompressedData = True\nElementDataFile = LOCAL\n") + packed, imageReader());
    std::ofstream(folder / "a.raw", std::ios::binary) << voxels;
    all("a.mhd", metaImage("ElementDataFile = a.raw\n"), imageReader(), Prefixes::maybeRead);
}

// FreeSurfer's header of 284 bytes, big-endian.
std::string mgh() {
    std::string out = bytes(std::vector<std::int32_t>{1, 7, 5, 4, 1, /*short*/ 4, 0}, true);
    out += bytes(std::vector<std::int16_t>{1}, true);
    out += bytes(std::vector<float>{0.7f, 1.1f, 2.5f, -1, 0, 0, 0, 0, -1, 0, 1, 0, 5, 6, 7}, true);
    out.resize(284);
    return out + bytes(pattern(), true);
}

TEST_F(Sweep, OfMgh) {
    all("a.mgh", mgh(), imageReader());
    all("a.mgz", gzipped(folder, mgh()), imageReader());
}

TEST_F(Sweep, OfNpyVolumes) {
    all("a.npy", npyFile("<i2", true, "7, 5, 4", bytes(pattern())), imageReader());
    all("b.npy", npyFile(">i2", false, "7, 5, 4", bytes(pattern())), imageReader());
    all("a.npy.gz", gzipped(folder, npyFile("<f2", false, "7, 5, 4", bytes(pattern()))), imageReader());
}

MrcFile map() {
    MrcFile file;
    file.size = file.samples = {7, 5, 4};
    file.cell = {4.9f, 5.5f, 10};
    file.voxels = bytes(pattern());
    return file;
}

TEST_F(Sweep, OfMrc) {
    all("a.mrc", map().file(), imageReader());
    MrcFile half = map();
    half.mode = 12;
    half.axes = {3, 1, 2};
    half.extended = 16;
    all("b.map", half.file(), imageReader());
    all("a.mrc.gz", gzipped(folder, map().file()), imageReader());
}

TEST_F(Sweep, OfAnalyze) {
    NiftiFile pair = smallNifti();
    pair.pair = true;
    std::ofstream(folder / "p.img", std::ios::binary) << pair.voxels;
    std::string header = pair.header().substr(0, 348);
    header.replace(344, 4, std::string(4, '\0'));
    all("p.hdr", header, imageReader());
}

std::string base64(const std::string& text) {
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t at = 0; at < text.size(); at += 3) {
        std::uint32_t bits = 0;
        for (std::size_t i = 0; i < 3; ++i)
            bits = bits << 8 | (at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0);
        for (int i = 0; i < 4; ++i) out += at + i > text.size() ? '=' : digits[bits >> (18 - 6 * i) & 63];
    }
    return out;
}

std::string vti(const std::string& attributes, const std::string& array, const std::string& behind = "") {
    return "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\" header_type=\"UInt32\"" + attributes +
           "><ImageData Spacing=\"0.7 1.1 2.5\"><Piece Extent=\"0 6 0 4 0 3\"><PointData><DataArray "
           "type=\"Int16\" Name=\"a\" " +
           array + "</DataArray></PointData></Piece></ImageData>" + behind + "</VTKFile>";
}

// Behind the last number a file may end anywhere.
TEST_F(Sweep, OfVti) {
    const std::string voxels = bytes(pattern()), length = bytes(std::vector<std::uint32_t>{280});
    std::string text;
    for (const auto v : pattern()) text += fmt::format("{} ", v);
    all("a.vti", vti("", "format=\"ascii\">" + text), imageReader());
    all("b.vti", vti("", "format=\"binary\">" + base64(length + voxels)), imageReader());
    all("c.vti",
        vti("", "format=\"appended\" offset=\"0\">", "<AppendedData encoding=\"raw\">_" + length + voxels),
        imageReader(), Prefixes::maybeRead);
    std::string packed(compressBound(voxels.size()), '\0');
    uLongf size = packed.size();
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(voxels.data()),
             voxels.size());
    packed.resize(size);
    const std::string head = bytes(std::vector<std::uint32_t>{1, 280, 0, static_cast<std::uint32_t>(size)});
    all("d.vti",
        vti(" compressor=\"vtkZLibDataCompressor\"", "format=\"binary\">" + base64(head) + base64(packed)),
        imageReader());
}

// Every byte is a voxel: nothing but the length can be wrong.
TEST_F(Sweep, OfRaw) {
    ImageReadOptions options;
    options.raw = RawLayout{{7, 5, 4}, "int16"};
    const Outcome seen = sweep(folder / "a.raw", bytes(pattern()), imageReader(options));
    EXPECT_EQ(seen.prefixesRead, 0u);
    EXPECT_EQ(seen.flipsRead, seen.flips);
}

// pages of 21 x 18 pixels of 16 bits
std::string tiff(const TempFolder& folder, int pages, int compression, const char* mode = "w") {
    const fs::path file = folder / "whole.tif";
    inAChild([&] {
        TIFF* const t = TIFFOpen(file.c_str(), mode);
        for (int z = 0; z < pages; ++z) {
            TIFFSetField(t, TIFFTAG_IMAGEWIDTH, 21);
            TIFFSetField(t, TIFFTAG_IMAGELENGTH, 18);
            TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, 16);
            TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 1);
            TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
            TIFFSetField(t, TIFFTAG_COMPRESSION, compression);
            TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, 5);
            for (int y = 0; y < 18; ++y) {
                std::uint16_t row[21];
                for (int x = 0; x < 21; ++x) row[x] = static_cast<std::uint16_t>(300 * x + 7 * y + z);
                TIFFWriteScanline(t, row, static_cast<std::uint32_t>(y), 0);
            }
            TIFFWriteDirectory(t);
        }
        TIFFClose(t);
    });
    return contentOf(file);
}

TEST_F(Sweep, OfTiff) {
    all("a.tif", tiff(folder, 2, COMPRESSION_NONE), imageReader());
    all("b.tif", tiff(folder, 2, COMPRESSION_LZW), imageReader());
    all("c.tif", tiff(folder, 2, COMPRESSION_ADOBE_DEFLATE, "wb8"), imageReader());
    all("d.tif", tiff(folder, 1, COMPRESSION_PACKBITS),
        [](const fs::path& file) { curves2d::readInput(file); });
}

std::string dicom(double z, const std::string& instance) {
    DicomSays says;
    says.at(1, 2, z).instance = instance;
    says.uid = "1.2.3." + instance;
    says.pixels = slicePixels(static_cast<int>(z));
    return dicomFile(dicomSet(says));
}

// Pixels come last and are as long as rows and columns say.
TEST_F(Sweep, OfDicom) {
    DicomSays says;
    says.frames = 2;
    says.at(1, 2, 3);
    std::vector<DicomOut> groups;
    for (const double z : {3.0, 5.0}) {
        DicomOut position, group;
        position.numbers(0x00200032, {1, 2, z});
        groups.push_back(group.sequence(0x00209113, {position}));
    }
    says.more.numbers(0x00281053, {0.5}).sequence(0x52009230, groups);
    says.pixels = slicePixels(1) + slicePixels(2);
    all("a.dcm", dicomFile(dicomSet(says)), imageReader());
    const DicomOut packed = dicomSet(says, Vr::explicitLittle, false)
                                .pieces({runLength(slicePixels(1)), runLength(slicePixels(2))});
    all("b.dcm", dicomFile(packed, "1.2.840.10008.1.2.5"), imageReader(), Prefixes::maybeRead,
        {.flips = 2000});
}

// One slice of three is damaged; the folder is read, and no slice is left out in silence.
TEST_F(Sweep, OfASliceInAFolder) {
    const Read folderReader = [](const fs::path& file) {
        const Image image = readImage(file.parent_path());
        if (image.size[2] == 3) return;
        for (const std::string& remark : image.warnings)
            if (remark.find(file.filename().string()) != remark.npos) return;
        throw std::logic_error("a slice is missing, and nothing says so");
    };
    fs::create_directory(folder / "ct");
    for (const double z : {3.0, 7.0})
        std::ofstream(folder / "ct" / fmt::format("{}.dcm", z), std::ios::binary)
            << dicom(z, fmt::format("{}", z));
    const Outcome slices = sweep(folder / "ct" / "damaged.dcm", dicom(5, "5"), folderReader);
    // Where it is no DICOM any more, the other two are a volume, with a remark; where it is and is too short, nothing is.
    EXPECT_LT(slices.prefixesRead, slices.prefixes);
    fs::create_directory(folder / "png");
    Picture picture{.width = 7, .height = 5};
    for (int i = 0; i < 35; ++i) picture.samples.push_back(static_cast<std::byte>(i * 7));
    for (const char* name : {"1.png", "3.png"})
        std::ofstream(folder / "png" / name, std::ios::binary) << pngBytes(picture);
    const Outcome pictures = sweep(folder / "png" / "2.png", pngBytes(picture), folderReader);
    EXPECT_EQ(pictures.prefixesRead, 0u);
}

// ---- pictures and grids of heights

void readShape(const fs::path& file) { curves2d::readInput(file, {.pixels = 64}); }
void readHeights(const fs::path& file) { subdivision::readGrid(file); }

std::string bmp() {
    std::string out("BM\x46\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\2\0\0\0\2\0\0\0\1\0\x18\0", 30);
    out.resize(54);
    return out + std::string("\xff\xff\xff\0\0\0\0\0\0\0\0\xff\xff\xff\0\0", 16);
}

// A 4 x 2 picture of 8 bits by runs (RLE8): rows of 4 white and of 2 white, 2 black.
std::string packedBmp() {
    const std::string runs("\4\1\0\0\2\1\2\0\0\1", 10);
    const auto u32 = [](std::uint32_t v) { return bytes(std::vector<std::uint32_t>{v}); };
    const auto u16 = [](std::uint16_t v) { return bytes(std::vector<std::uint16_t>{v}); };
    const std::uint32_t start = 14 + 40 + 8;
    return "BM" + u32(start + 10) + u32(0) + u32(start) + u32(40) + u32(4) + u32(2) + u16(1) + u16(8) +
           u32(1) + u32(10) + u32(0) + u32(0) + u32(2) + u32(0) + u32(0) + u32(0xffffff) + runs;
}

TEST_F(Sweep, OfPictures) {
    Picture picture{.width = 7, .height = 5, .channels = 3, .isColour = true};
    for (int i = 0; i < 105; ++i) picture.samples.push_back(static_cast<std::byte>(i * 11));
    all("a.png", pngBytes(picture), readShape);
    all("b.png", pngBytes(picture), readHeights);
    all("a.bmp", bmp(), readShape);
    all("b.bmp", packedBmp(), readShape, Prefixes::maybeRead);  // rows that are missing are black
    all("a.pgm", std::string("P5\n# grey\n4 3\n255\n") + "abcd\1\2\3\4wxyz", readShape);
    all("b.pgm", "P2\n4 3\n255\n1 2 3 4\n5 6 7 80\n9 100 110 120\n", readShape, Prefixes::maybeRead);
    all("a.pbm", std::string("P4\n9 2\n") + "\x55\x80\xaa\x80", readShape);
    all("b.pbm", "P1\n4 3\n1 0 0 1\n0 1 1 0\n1 1 1 0\n", readShape, Prefixes::maybeRead);
}

TEST_F(Sweep, OfHeights) {
    Picture heights{.width = 7, .height = 5, .type = ValueType::float32};
    heights.samples.resize(35 * sizeof(float));
    for (std::size_t i = 0; i < 35; ++i) {
        const float value = 0.25f * static_cast<float>(i);
        std::memcpy(&heights.samples[i * sizeof value], &value, sizeof value);
    }
    all("a.npy", npyBytes(heights), readHeights);
    all("a.asc",
        "ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n1 2 3 4\n5 6 7 8\n9 10 "
        "11 12\n",
        readHeights, Prefixes::maybeRead);
}

// ---- lines and polygons

const std::string kFeatures =
    R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"a"},"geometry":)"
    R"({"type":"Polygon","coordinates":[[[0,0],[4.5,0],[4,3e0],[0,0]]]}},{"type":"Feature","geometry":null}]})";
const std::string kTopology = R"({"type":"Topology","transform":{"scale":[0.5,2],"translate":[10,20]},)"
                              R"("arcs":[[[0,0],[4,0],[0,4],[-4,0],[0,-4]]],)"
                              R"("objects":{"a":{"type":"Polygon","arcs":[[0]]}}})";
const std::string kLines =
    R"({"type":"LineString","coordinates":[[0,0],[4.5,1],[4,3e0],[0,2],[1,1],[3,2],[5,5]]})";
const std::string kDrawing =
    "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\"><path d=\"M0 0L4.5,1l1-1H8v3z\"/>\n"
    "<polyline points=\"0,0 1,1 2,0 3 2\"/><polygon class='a' points=\"0,0 1,1 2,0\"/></svg>\n";
const std::string kRows = "# two\n> a\n0 0\n4 1\n3.5 3e0\n1,2\n\n> b\n10 10\n14 10\n12 13\n";

void readLines(const fs::path& file) { subdivision::CurveFile::read(file); }

// JSON ends with its last bracket; a drawing's lines are read although </svg> is missing.
TEST_F(Sweep, OfVectors) {
    all("a.geojson", kFeatures, readShape);
    all("a.json", kTopology, readShape);
    all("b.geojson", kLines, readLines);
    all("a.svg", kDrawing, readLines, Prefixes::maybeRead);
    all("a.txt", kRows, readShape, Prefixes::maybeRead);
    all("b.txt", kRows, readLines, Prefixes::maybeRead);
}

// ---- grids of OpenVDB

std::string sphereFile(const TempFolder& folder, bool ours) {
    const fs::path file = folder / "whole.vdb";
    inAChild([&] {
        initializeVdb();
        const auto sphere =
            openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(2.0f, openvdb::Vec3f(4), 1.0f);
        if (ours)
            writeVdb(file, {sphere});
        else
            openvdb::io::File(file.string()).write({sphere});
    });
    return contentOf(file);
}

void readSurface(const fs::path& file) { readLevelSet(file); }

// What isowave wrote has a hash of everything; what others wrote is parsed in a child of the child.
TEST_F(Sweep, OfLevelSets) {
    initializeVdb();
    const Outcome own = sweep(folder / "own.vdb", sphereFile(folder, true), readSurface);
    EXPECT_EQ(own.prefixesRead, 0u);
    const Outcome foreign = all("foreign.vdb", sphereFile(folder, false), readSurface, Prefixes::refused,
                                {.prefixes = 1000, .flips = 1000});
    EXPECT_GT(foreign.flipsRead, 100u);
}

TEST_F(Sweep, OfPyramids) {
    initializeVdb();
    inAChild([&] {
        wavelets::writePyramid(folder / "whole", wavelets::analyse(zoo::binaryField(zoo::thinSolids()[1])));
    });
    const Outcome seen =
        sweep(folder / "a.pyramid.vdb", contentOf(folder / "whole"),
              [](const fs::path& file) { wavelets::readPyramid(file); }, {.prefixes = 300, .flips = 300});
    EXPECT_EQ(seen.prefixesRead, 0u);
}

// ---- that a sweep can fail

TEST_F(Sweep, FindsWhatBreaksARule) {
    const auto failures = [&](const Read& read) {
        testing::TestPartResultArray found;
        {
            testing::ScopedFakeTestPartResultReporter catches(&found);
            sweep(folder / "a", "0123456789", read, {.flips = 0});
        }
        return found.size();
    };
    EXPECT_EQ(failures([](const fs::path&) {}), 0);
    EXPECT_EQ(
        failures([](const fs::path& file) { throw InputError(file.string(), "is too short for a file"); }),
        0);
    const auto atSeven = [](auto act) {
        return [act](const fs::path& file) {
            if (fs::file_size(file) == 7) act(file);
        };
    };
    EXPECT_EQ(failures(atSeven([](const fs::path&) { ::raise(SIGSEGV); })), 1);
    EXPECT_EQ(failures(atSeven([](const fs::path&) { throw std::runtime_error("no"); })), 1);
    // An error's message is one line, whatever is said: that rule cannot be broken.
    EXPECT_EQ(
        failures(atSeven([](const fs::path& f) { throw InputError(f.string(), "two\nlines of words"); })), 0);
    EXPECT_EQ(
        failures(atSeven([](const fs::path&) { throw InputError("b", "is another file, not the one"); })), 1);
    EXPECT_EQ(failures(atSeven([](const fs::path&) { std::cerr << "words"; })), 2);  // and what was printed
    EXPECT_EQ(failures(atSeven([](const fs::path&) {
                  std::vector<char> much(1100UL << 20);
                  std::memset(much.data(), 1, much.size());
              })),
              1);
}

}  // namespace
}  // namespace isowave::test
