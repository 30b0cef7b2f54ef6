#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstring>
#include <fstream>

#include "gzip.h"
#include "io/mesh/read.h"
#include "isowave/error.h"
#include "temp_folder.h"
#include "volume/mesh_checks.h"
#include "volume/mesh_repair.h"

namespace isowave {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;
namespace fs = std::filesystem;

const fs::path kData = ISOWAVE_TEST_DATA;

fs::path written(const std::string& name, const std::string& bytes) {
    const fs::path folder = fs::temp_directory_path() / ("isowave_mesh_read_" + std::to_string(::getpid()));
    fs::create_directories(folder);
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return folder / name;
}

TriangleMesh readBytes(const std::string& name, const std::string& bytes, MeshFileInfo* info = nullptr) {
    const fs::path path = written(name, bytes);
    struct Remove {
        fs::path path;
        ~Remove() { fs::remove(path); }
    } remove{path};
    return readMesh(path, info);
}

// One line that names the file and holds these words.
auto refuses(const std::string& words) {
    return ThrowsMessage<InputError>(AllOf(HasSubstr(words), Not(HasSubstr("\n"))));
}
#define EXPECT_REFUSED(name, bytes, words) EXPECT_THAT([&] { readBytes(name, bytes); }, refuses(words))

template <class T>
void append(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string binaryStl(const TriangleMesh& mesh, std::string header = "binary") {
    header.resize(80);
    append(header, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const Triangle& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) append(header, 0.0f);
        for (const auto corner : t) {
            for (const double x : mesh.points[corner]) append(header, static_cast<float>(x));
        }
        append(header, std::uint16_t(0));
    }
    return header;
}

std::string binaryPly(const TriangleMesh& mesh, bool bigEndian = false) {
    std::string bytes =
        std::string("ply\nformat ") + (bigEndian ? "binary_big_endian" : "binary_little_endian") +
        " 1.0\ncomment SPACE=LPS\nelement vertex " + std::to_string(mesh.points.size()) +
        "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
        std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
    const auto put = [&](auto value) {
        std::string part;
        append(part, value);
        if (bigEndian) std::reverse(part.begin(), part.end());
        bytes += part;
    };
    for (const Point& p : mesh.points) {
        for (const double x : p) put(static_cast<float>(x));
    }
    for (const Triangle& t : mesh.triangles) {
        put(std::uint8_t(3));
        for (const auto corner : t) put(static_cast<std::int32_t>(corner));
    }
    return bytes;
}

const TriangleMesh kBall = shapes::sphere(10, 1, {1, 2, 3});

const std::string kTetrahedronObj =
    "# SPACE=RAS\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const std::string kTetrahedronOff =
    "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
const std::string kTetrahedronPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

void expectTetrahedron(const TriangleMesh& mesh) {
    EXPECT_EQ(mesh.points.size(), 4u);
    ASSERT_EQ(mesh.triangles.size(), 4u);
    EXPECT_TRUE(checks::isClosedAndOriented(mesh));
    EXPECT_NEAR(checks::volumeOf(mesh), 1.0 / 6, 1e-12);
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
    const auto at = text.find(what);
    EXPECT_NE(at, text.npos) << what;
    return text.replace(at, what.size(), with);
}

TEST(ReadMesh, ReadsEveryFormat) {
    MeshFileInfo info;
    const double volume = checks::volumeOf(kBall);
    for (const bool bigEndian : {false, true}) {
        const TriangleMesh ply = readBytes("a.ply", binaryPly(kBall, bigEndian), &info);
        EXPECT_EQ(info.format, "binary PLY");
        EXPECT_EQ(info.space, "LPS");
        EXPECT_EQ(ply.points.size(), kBall.points.size());
        EXPECT_NEAR(checks::volumeOf(ply), volume, 1e-4 * volume);
    }
    const TriangleMesh stl = readBytes("a.STL", binaryStl(kBall, "3D Slicer output. SPACE=RAS"), &info);
    EXPECT_EQ(info.format, "binary STL");
    EXPECT_EQ(info.space, "RAS");
    EXPECT_EQ(info.polygons, 80);
    EXPECT_EQ(stl.points.size(), kBall.points.size());  // merged by position
    EXPECT_NEAR(checks::volumeOf(stl), volume, 1e-4 * volume);
    expectTetrahedron(readBytes("a.obj", kTetrahedronObj, &info));
    EXPECT_EQ(info.format, "OBJ");
    EXPECT_EQ(info.space, "RAS");
    expectTetrahedron(readBytes("a.off", kTetrahedronOff, &info));
    EXPECT_EQ(info.format, "OFF");
    EXPECT_EQ(info.space, "");
    expectTetrahedron(readBytes("a.ply", kTetrahedronPly, &info));
    EXPECT_EQ(info.format, "ASCII PLY");
}

TEST(ReadMesh, ReadsRealFiles) {
    struct Expected {
        const char* name;
        std::size_t points, triangles;
        std::int64_t polygons;
    };
    for (const auto& [name, points, triangles, polygons] :
         {Expected{"pinion.off", 650, 1300, 1300}, Expected{"bones.off", 2154, 4204, 4204},
          Expected{"gearwheel.bin.stl", 1222, 2444, 2444},
          Expected{"catmark_toroidal_tet.obj", 20, 48, 24}}) {
        MeshFileInfo info;
        const TriangleMesh mesh = readMesh(kData / "meshes" / name, &info);
        EXPECT_EQ(mesh.points.size(), points) << name;
        EXPECT_EQ(mesh.triangles.size(), triangles) << name;
        EXPECT_EQ(info.polygons, polygons) << name;
        EXPECT_TRUE(checks::isClosedAndOriented(mesh)) << name;
        EXPECT_GT(checks::volumeOf(mesh), 0) << name;
    }
}

// The fourteen malformed files: what becomes of each. Empty words: it reads and is closed.
TEST(ReadMesh, KnowsWhatIsWrongWithBrokenStlFiles) {
    struct Expected {
        const char *name, *words;
    };
    int files = 0;
    for (const auto& [name, words] : {
             Expected{"empty.stl", "is empty; expected a mesh file"},
             Expected{"fourVertices.ascii.stl", "line 2: the facet has 4 vertices"},
             Expected{"incorrectFaceCounter.bin.stl",
                      "promises 66 triangles (3384 bytes) but the file holds 4"},
             Expected{"missingEndsolid.ascii.stl", "ends after 4 facets without 'endsolid'"},
             Expected{"missingFace.ascii.stl", "not closed: 3 boundary edges in 1 loop"},
             Expected{"missingNormal.ascii.stl", ""},
             Expected{"notANumberNormal.ascii.stl", ""},
             Expected{"quad.ascii.stl", "line 2: the facet has 4 vertices"},
             Expected{"singleFace.ascii.stl", "not closed: 3 boundary edges in 1 loop"},
             Expected{"solidNameMismatch.ascii.stl", ""},
             Expected{"twoVertices.ascii.stl", "line 2: the facet has 2 vertices"},
             Expected{"wrongHeader.bin.stl", ""},  // binary, though it starts with "solid"
             Expected{"wrongNormal.ascii.stl", ""},
             Expected{"wrongNormals.ascii.stl", ""},
         }) {
        const fs::path path = kData / "broken_stl" / name;
        const auto read = [&, file = path] { return repairMesh(readMesh(file), file.string()); };
        if (*words) {
            EXPECT_THAT([&] { read(); }, ThrowsMessage<InputError>(
                                             AllOf(HasSubstr(words), HasSubstr(name), Not(HasSubstr("\n")))));
        } else {
            const TriangleMesh mesh = read();
            EXPECT_TRUE(checks::isClosedAndOriented(mesh)) << name;
            EXPECT_GE(mesh.triangles.size(), 4u) << name;
        }
        ++files;
    }
    const auto isStl = [](const fs::directory_entry& entry) { return entry.path().extension() == ".stl"; };
    EXPECT_EQ(files, std::count_if(fs::directory_iterator(kData / "broken_stl"), {}, isStl));
}

TEST(ReadMesh, RefusesEveryTruncation) {
    const std::string stl = binaryStl(kBall), ply = binaryPly(kBall);
    for (const auto& [name, bytes] :
         {std::pair{"a.stl", stl}, {"a.ply", ply}, {"b.ply", binaryPly(kBall, true)}}) {
        EXPECT_NO_THROW(readBytes(name, bytes));
        for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 50) {
            EXPECT_THROW(readBytes(name, bytes.substr(0, size)), InputError) << name << " " << size;
        }
    }
    // Text that ends in the middle of the last number is whole to any reader; before that, nothing is.
    for (const auto& [name, bytes] :
         {std::pair{"a.obj", kTetrahedronObj.substr(0, kTetrahedronObj.find('f'))},
          {"a.off", kTetrahedronOff},
          {"a.ply", kTetrahedronPly}}) {
        for (std::size_t size = 0; size + 2 < bytes.size(); ++size) {
            EXPECT_THROW(readBytes(name, bytes.substr(0, size)), InputError) << name << " " << size;
        }
    }
    EXPECT_REFUSED("a.stl", stl.substr(0, 1000),
                   "promises 80 triangles (4084 bytes) but the file holds 18 (1000");
    EXPECT_REFUSED("a.ply", ply.substr(0, 400),
                   "promises 42 of element 'vertex' but the file ends in number");
    EXPECT_REFUSED("a.ply", ply.substr(0, 1000), "of element 'face' but the file ends in number");
    EXPECT_REFUSED("a.off", kTetrahedronOff.substr(0, kTetrahedronOff.find("0 1 0")),
                   "promises 4 points but the file ends after 2");
}

// Whatever the name says: gzip is told by the first two bytes, the format by the name without .gz.
TEST(ReadMesh, InflatesWhatGzipHasCompressed) {
    const std::pair<const char*, std::string> files[] = {{"a.stl", binaryStl(kBall)},
                                                         {"a.ply", binaryPly(kBall, true)},
                                                         {"a.obj", kTetrahedronObj},
                                                         {"a.off", kTetrahedronOff}};
    for (const auto& [name, bytes] : files) {
        const TriangleMesh plain = readBytes(name, bytes);
        EXPECT_FALSE(plain.triangles.empty());
        for (const std::string& packedName :
             {name + std::string(".gz"), name + std::string(".GZ"), std::string(name)}) {
            MeshFileInfo info;
            const TriangleMesh mesh = readBytes(packedName, test::gzipped(bytes), &info);
            EXPECT_EQ(mesh.points, plain.points) << packedName;
            EXPECT_EQ(mesh.triangles, plain.triangles) << packedName;
            EXPECT_TRUE(isMeshPath(packedName));
        }
        EXPECT_EQ(readBytes(name + std::string(".gz"), bytes).triangles, plain.triangles) << "not compressed";
    }
    EXPECT_FALSE(isMeshPath("a.nii.gz"));
}

TEST(ReadMesh, RefusesGzipThatIsNotWholeOrTooLarge) {
    const std::string packed = test::gzipped(binaryStl(kBall));
    EXPECT_REFUSED("a.stl.gz", packed.substr(0, packed.size() / 2), "its gzip stream breaks off after");
    EXPECT_REFUSED("a.stl", "\x1f\x8b\x08 zipped", "its gzip stream is damaged (unknown header flags set)");
    EXPECT_REFUSED("a.stl.gz", test::gzipped("hello"), "a.stl.gz: 5 bytes are too few for an STL");
    EXPECT_REFUSED("a.amf.gz", packed, "is an AMF file");
    const fs::path path = written("b.stl.gz", packed);
    EXPECT_NO_THROW(readMeshFile(path, {}, 1e6));
    EXPECT_THAT([&] { readMeshFile(path, {}, 1000); },
                refuses("inflates to more than 1 kB, the limit of memory"));
    fs::remove(path);
}

TEST(ReadMesh, RefusesWhatIsNoMesh) {
    EXPECT_THAT([] { readMesh("no/such/file.stl"); }, refuses("no/such/file.stl: no such file"));
    EXPECT_THAT([] { readMesh(fs::temp_directory_path() / "x.txt"); }, refuses("'.txt' is no mesh format"));
    const test::TempFolder temporary;
    const fs::path folder = temporary / "folder.stl";
    fs::create_directories(folder);
    EXPECT_THAT([&] { readMesh(folder); }, refuses("is a folder"));
    EXPECT_REFUSED("a.obj", "", "is empty; expected a mesh file");
    EXPECT_REFUSED("a.stl", "hello", "too few for an STL");
    EXPECT_REFUSED("a.stl", "solid nothing\nendsolid\n", "no triangles");
    EXPECT_REFUSED("a.stl", binaryStl({}), "no triangles");
    EXPECT_REFUSED("a.ply", "plyx\n", "no PLY");
    EXPECT_REFUSED("a.off", "4 4 0\n0 0 0\n", "starts with 'OFF'");
    EXPECT_REFUSED("a.off", "OFF BINARY\n4 4 0\n", "binary OFF");
    EXPECT_REFUSED("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "3 points but no faces");
    EXPECT_REFUSED("a.ply", replaced(kTetrahedronPly, "element face 4", "element face 0"), "point cloud");
}

TEST(ReadMesh, SaysWhichPointIsMissing) {
    EXPECT_REFUSED("a.obj", replaced(kTetrahedronObj, "f 2 3 4", "f 2 3 5"),
                   "line 9: a face refers to point 5, but the file has only 4 points");
    EXPECT_REFUSED("a.obj", replaced(kTetrahedronObj, "f 1 3 2", "f 0 3 2"),
                   "line 6: a face refers to point 0");
    EXPECT_REFUSED("a.obj", replaced(kTetrahedronObj, "f 1 3 2", "f 1 -5 2"),
                   "line 6: a face refers to point -5");
    EXPECT_REFUSED("a.obj", replaced(kTetrahedronObj, "f 1 3 2", "f 1 3"),
                   "line 6: a face needs three corners");
    EXPECT_REFUSED("a.off", replaced(kTetrahedronOff, "3 0 2 1", "3 0 4 1"),
                   "line 7: a face refers to point '4'; there are points 0 to 3");
    EXPECT_REFUSED("a.ply", replaced(kTetrahedronPly, "3 0 2 1", "3 0 4 1"),
                   "face 1 refers to a point that is missing; the file has 4 points");
    EXPECT_REFUSED("a.ply", replaced(kTetrahedronPly, "3 0 2 1", "2 0 2"), "face 1 has 2 corners");
}

TEST(ReadMesh, SaysWhichCoordinateIsNotFinite) {
    for (const char* bad : {"nan", "inf", "-inf"}) {
        EXPECT_REFUSED("a.obj", replaced(kTetrahedronObj, "v 0 1 0", std::string("v 0 ") + bad + " 0"),
                       "line 4: coordinate " + std::string(bad) + " is not finite");
        EXPECT_REFUSED("a.off", replaced(kTetrahedronOff, "0 1 0", std::string("0 ") + bad + " 0"), "line 5");
        EXPECT_REFUSED("a.ply", replaced(kTetrahedronPly, "0 1 0", std::string("0 ") + bad + " 0"),
                       "line 12");
    }
    EXPECT_REFUSED(
        "a.stl",
        "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 nan 0\nvertex 0 1 0\nendloop\n"
        "endfacet\nendsolid\n",
        "line 5: coordinate nan is not finite");
    TriangleMesh mesh = kBall;
    mesh.points[7][1] = NAN;
    EXPECT_REFUSED("a.ply", binaryPly(mesh), "point 8: y = nan is not finite");
    EXPECT_REFUSED("a.stl", binaryStl(mesh), "coordinate nan is not finite");
    mesh.points[7][1] = HUGE_VAL;
    EXPECT_REFUSED("a.ply", binaryPly(mesh), "point 8: y = inf is not finite");
    EXPECT_REFUSED("a.stl", binaryStl(mesh), "coordinate inf is not finite");
}

TEST(ReadMesh, TakesNumbersTooSmallForZeroAndTooLargeForInfinite) {
    expectTetrahedron(readBytes("a.obj", replaced(kTetrahedronObj, "v 0 1 0", "v -1e-999 +1 1E-400")));
    expectTetrahedron(
        readBytes("a.ply", replaced(replaced(kTetrahedronPly, "double y", "float y"), "0 1 0", "0 1 1e-99")));
    for (const char* large : {"1e400", "-1.5E999", "1e+400"})
        EXPECT_REFUSED("a.obj", replaced(kTetrahedronObj, "v 0 1 0", std::string("v 0 1 ") + large),
                       std::string("line 4: coordinate ") + large + " is not finite");
    EXPECT_REFUSED("a.ply", replaced(replaced(kTetrahedronPly, "double y", "float y"), "0 1 0", "0 1e40 0"),
                   "line 12: 'y' of element 'vertex' is not finite");
}

TEST(ReadMesh, RefusesCoordinatesBeyondReason) {
    TriangleMesh mesh = kBall;
    mesh.points[7][2] = 3e30;
    EXPECT_REFUSED("a.stl", binaryStl(mesh), "beyond 1e15");
    EXPECT_REFUSED("a.ply", binaryPly(mesh), "beyond 1e15");
    for (auto& point : mesh.points) point = {};
    EXPECT_REFUSED("a.stl", binaryStl(mesh), "all its points are (0, 0, 0)");
    // 20 across at 1e6: float32 has steps of 1/16 there, 320 of them; at 1e5, 2560.
    EXPECT_REFUSED("a.stl", binaryStl(shapes::sphere(10, 2, {1e6, 0, 0})), "fewer than 1024 steps are left");
    EXPECT_NO_THROW(readBytes("a.stl", binaryStl(shapes::sphere(10, 2, {1e5, 0, 0}))));
    // Text: float32 where all its numbers are.
    const auto text = [](const std::string& tip) {
        std::string facets = "solid x\n";
        const std::string corners[] = {"1000000 0 0", "1000010 0 0", "1000000 10 0", tip};
        for (const auto& [a, b, c] : {std::array{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}})
            facets += "facet normal 0 0 0\nouter loop\nvertex " + corners[a] + "\nvertex " + corners[b] +
                      "\nvertex " + corners[c] + "\nendloop\nendfacet\n";
        return facets + "endsolid x\n";
    };
    EXPECT_REFUSED("a.stl", text("1000000 0 10.25"), "fewer than 1024 steps are left");
    EXPECT_EQ(readBytes("a.stl", text("1000000.01 0 10")).points.size(), 4u);
    const std::string far = replaced(kTetrahedronObj, "v 0 0 0", "v 1e9 0 0");
    EXPECT_NO_THROW(readBytes("a.obj", far));  // decimal: float64
}

TEST(ReadMesh, UnderstandsWhatExportersWrite) {
    expectTetrahedron(readBytes("a.obj", replaced(kTetrahedronObj, "f 1 3 2", "f 1/1/1 3//2 2/5")));
    expectTetrahedron(readBytes("a.obj", replaced(kTetrahedronObj, "f 1 3 2", "f\t1\t3\t2")));
    expectTetrahedron(readBytes("a.obj", replaced(kTetrahedronObj, "f 1 3 2", "f 1 \\\n3 2")));
    expectTetrahedron(readBytes("a.obj", replaced(kTetrahedronObj, "f 1 3 2", "l 1 2\nf -4 -2 -3\n")));
    expectTetrahedron(readBytes("a.obj", replaced(kTetrahedronObj, "v 0 0 0",
                                                  "mtllib a.mtl\no x\nvn 0 0 1\nv 0 0 0 "
                                                  "0.5 0.5 0.5")));
    std::string windows;
    for (const char c : kTetrahedronObj) windows += c == '\n' ? "\r\n" : std::string(1, c);
    expectTetrahedron(readBytes("a.obj", windows));
    expectTetrahedron(readBytes("a.off", replaced(kTetrahedronOff, "OFF\n", "OFF # made by hand\n\n")));
    expectTetrahedron(readBytes("a.off", replaced(kTetrahedronOff, "3 0 2 1", "3 0 2 1 255 0 0")));
    std::ifstream file(kData / "broken_stl" / "wrongNormal.ascii.stl");
    std::string text(std::istreambuf_iterator<char>(file), {});
    EXPECT_EQ(readBytes("a.stl", text).triangles.size(), 4u);
    EXPECT_EQ(readBytes("a.stl", replaced(text, "solid tetrahedron", "solid a facet of an endsolid"))
                  .triangles.size(),
              4u);
    EXPECT_EQ(readBytes("a.stl", text + text).triangles.size(), 8u);  // two solids
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    EXPECT_EQ(readBytes("a.stl", text).triangles.size(), 4u);
}

std::string withLineEnd(const std::string& text, const std::string& end) {
    std::string result;
    for (const char c : text) result += c == '\n' ? end : std::string(1, c);
    return result;
}

std::string asciiStl() {
    std::ifstream file(kData / "broken_stl" / "wrongNormal.ascii.stl");
    return std::string(std::istreambuf_iterator<char>(file), {});
}

TEST(ReadMesh, ReadsTextHoweverItIsEncodedAndBroken) {
    for (const auto& file : {std::pair{"a.obj", kTetrahedronObj},
                             {"a.off", kTetrahedronOff},
                             {"a.ply", kTetrahedronPly},
                             {"a.stl", asciiStl()}}) {
        const std::string name = file.first, text = file.second;
        const TriangleMesh mesh = readBytes(name, text);
        for (const char* end : {"\r\n", "\r", " \t\n"})
            EXPECT_EQ(readBytes(name, withLineEnd(text, end)).points, mesh.points) << name;
        EXPECT_EQ(readBytes(name, "\xef\xbb\xbf" + text).triangles, mesh.triangles) << name;
        for (const char* mark : {"\xff\xfe", "\xfe\xff"})
            EXPECT_REFUSED(name, mark + withLineEnd(text, std::string("\0\n", 2)), "is text in UTF-16");
    }
}

TEST(ReadMesh, JoinsContinuedLinesOfObjButNotComments) {
    const std::string continued = withLineEnd(kTetrahedronObj.substr(kTetrahedronObj.find('f')), " # c\n");
    expectTetrahedron(readBytes("a.obj", kTetrahedronObj.substr(0, kTetrahedronObj.find('f')) + continued));
    expectTetrahedron(readBytes("a.obj", replaced(kTetrahedronObj, "v 1 0 0", "v \\\r\n1 0\\ \n\\\n 0")));
    expectTetrahedron(readBytes("a.obj", replaced(kTetrahedronObj, "v 0 0 0", "# C:\\parts\\\nv 0 0 0")));
    // Lines are counted as an editor does.
    EXPECT_REFUSED("a.obj", replaced(kTetrahedronObj, "f 1 3 2\nf 1 2 4", "f 1 \\\n3 2\nf 1 2 x"),
                   "line 8: corner 'x'");
}

TEST(ReadMesh, TakesLineBreaksOfOffForBlanks) {
    expectTetrahedron(readBytes("a.off", replaced(kTetrahedronOff, "3 0 2 1", "3\n0\n2 1")));
    expectTetrahedron(readBytes("a.off", replaced(kTetrahedronOff, "1 0 0", "1\n0 # x\n\n0")));
    expectTetrahedron(readBytes("a.off", withLineEnd(kTetrahedronOff, " ")));
    expectTetrahedron(readBytes("a.off", replaced(kTetrahedronOff, "4 4 0", "4 4")));
    expectTetrahedron(
        readBytes("a.off", replaced(replaced(kTetrahedronOff, "OFF", "4OFF"), "0 0 0\n1 0 0\n0 1 0\n0 0 1",
                                    "0 0 0 1\n2 0 0 2\n0 3 0 3\n0 0 1 1")));
    expectTetrahedron(readBytes("a.off", replaced(kTetrahedronOff, "OFF\n4 4 0", "OFF4 4 0")));
    // Normals, colours, texture coordinates behind the points, and faces over several lines.
    const std::string broken = replaced(kTetrahedronOff, "3 0 2 1", "3\n0\n2 1");
    for (const auto& [keyword, more] : {std::pair{"NOFF", " 0 0 1"},
                                        {"COFF", " 1 0 0 1"},
                                        {"CNOFF", " 0 0 1 1 0 0 1"},
                                        {"STOFF", " 0.5 0.5"}}) {
        std::string points;
        for (const char* point : {"0 0 0", "1 0 0", "0 1 0", "0 0 1"})
            points += std::string(point) + more + "\n";
        const std::string text =
            replaced(replaced(broken, "OFF", keyword), "0 0 0\n1 0 0\n0 1 0\n0 0 1\n", points);
        expectTetrahedron(readBytes("a.off", text));
        expectTetrahedron(readBytes("a.off", replaced(text, "3\n0\n2 1", "3 0 2 1")));
    }
    // A coordinate is gone, a line is there twice: as many words as there should be, but not by accident.
    EXPECT_REFUSED("a.off",
                   replaced(replaced(kTetrahedronOff, "1 0 0\n0 1 0", " 1 0"), "3 0 2 1", "3 0 2 1\n3 0 2 1"),
                   "line 4: a point needs three coordinates, found 2");
}

TEST(ReadMesh, PassesOverWhatPlyRowsHoldBesides) {
    expectTetrahedron(readBytes("a.ply", replaced(kTetrahedronPly, "3 0 2 1", "3 0 2 1 0.5 0.5")));
    expectTetrahedron(readBytes(
        "a.ply", replaced(replaced(kTetrahedronPly, "double z\n", "double z\nproperty float nx\n"),
                          "0 0 0\n1 0 0\n0 1 0\n0 0 1\n", "0 0 0 nan\n1 0 0 0\n0 1 0 0\n0 0 1 0\n")));
    expectTetrahedron(readBytes("a.ply", replaced(kTetrahedronPly, "uchar int", "uint short")));
    EXPECT_REFUSED("a.ply", replaced(kTetrahedronPly, "double y", "double x"), "lack x, y or z");
    EXPECT_REFUSED("a.ply", replaced(kTetrahedronPly, "double z\n", "double z\nproperty double z\n"),
                   "twice");
}

// The name of its solid was taken to be the whole file: "ends after 0 facets".
TEST(ReadMesh, ReadsTextStlThatStandsOnOneLine) {
    const auto onOneLine = [](std::string text) {
        std::replace(text.begin(), text.end(), '\n', ' ');
        return text;
    };
    const std::string text = asciiStl();
    expectTetrahedron(readBytes("a.stl", onOneLine(text)));
    MeshFileInfo info;
    const TriangleMesh two = readBytes("a.stl", onOneLine(text + text), &info);
    EXPECT_EQ(two.triangles.size(), 8u);
    EXPECT_REFUSED("a.stl", onOneLine(replaced(text, "endsolid", "")),
                   "ends after 4 facets without 'endsolid'");
    // Names may hold the words.
    expectTetrahedron(
        readBytes("a.stl", replaced(replaced(text, "solid tetrahedron", "solid facet of a solid"),
                                    "endsolid tetrahedron", "endsolid facet of a solid")));
}

// As Cyberware's scanners and plyconvert write them. They were taken for point clouds.
TEST(ReadMesh, ReadsTriangleStripsOfPly) {
    const std::string head =
                          "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double "
                          "y\nproperty double z\n",
                      list = "property list int int vertex_indices\nend_header\n",
                      points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    const auto read = [&](const std::string& strips, const std::string& rows) {
        return readBytes("a.ply", head + "element tristrips " + strips + "\n" + list + points + rows);
    };
    expectTetrahedron(read("1", "6 0 2 1 3 0 2\n"));
    // One after the other in a list, whose turns begin anew; with corners given twice; in rows of their own.
    expectTetrahedron(read("1", "14 2 1 0 3 -1 3 1 2 -1 0 0 2 3 -1\n"));
    expectTetrahedron(read("2", "4 2 1 0 3\n8 3 1 2 -1 0 0 2 3\n"));
    EXPECT_REFUSED("a.ply", head + "element tristrips 1\n" + list + points + "3 0 1 4\n", "refers to");
    EXPECT_REFUSED(
        "a.ply",
        head + "element tristrips 1\nproperty list int int strip\nend_header\n" + points + "3 0 1 2\n",
        "its triangle strips lack the list 'vertex_indices'");
    // Beside faces they say the same again.
    expectTetrahedron(readBytes(
        "a.ply", replaced(replaced(kTetrahedronPly, "end_header",
                                   "element tristrips 1\nproperty list int int vertex_indices\nend_header"),
                          "3 1 2 3\n", "3 1 2 3\n6 0 2 1 3 0 2\n")));
}

TEST(ReadMesh, DoesNotLoseFacetsSilently) {
    const std::string text = asciiStl();
    EXPECT_REFUSED("a.stl", replaced(text, "facet normal", "fcet normal"), "'fcet' is no STL keyword");
    EXPECT_REFUSED("a.stl", replaced(text, "endfacet", ""), "has no 'endfacet'");
    EXPECT_REFUSED("a.stl", "solid a\n" + text, "line 2: 'solid' inside the solid of line 1");
}

// Counts in a header are believed when the file holds as much, and not before: neither memory nor time is spent on them.
TEST(ReadMesh, BelievesNoCount) {
    const std::string many = "4000000000";
    EXPECT_REFUSED("a.off", replaced(kTetrahedronOff, "4 4 0", many + " 4 0"), "ends after 8");
    EXPECT_REFUSED("a.off", replaced(kTetrahedronOff, "4 4 0", "4 " + many + " 0"), "ends after 4");
    EXPECT_REFUSED("a.off", replaced(kTetrahedronOff, "3 0 2 1", many + " 0 2 1"), "but lists 3");
    EXPECT_REFUSED("a.ply", replaced(kTetrahedronPly, "vertex 4", "vertex " + many), "ends in number 9");
    EXPECT_REFUSED("a.ply", replaced(kTetrahedronPly, "3 0 2 1", many + " 0 2 1"),
                   "line 14: element 'face' lacks");
    EXPECT_REFUSED("a.ply", replaced(binaryPly(kBall), "face 80", "face " + many), "ends in number 81");
    EXPECT_REFUSED("a.ply", replaced(binaryPly(kBall), "uchar int", "uint int"), "it is truncated");
}

// The signed area of a flat mesh seen from above, and the sum of its triangles' areas: the same where none overlaps.
std::pair<double, double> areasOf(const TriangleMesh& mesh) {
    double sum = 0, all = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Point &p = mesh.points[a], &q = mesh.points[b], &r = mesh.points[c];
        const double twice = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        sum += twice / 2;
        all += std::abs(twice) / 2;
    }
    return {sum, all};
}

TEST(ReadMesh, CutsConcavePolygonsWithoutOverlaps) {
    for (const int corners : {10, 16, 150, 300, 900}) {  // stars; by weight, and by ears
        for (const int first : {0, 1}) {
            std::string obj, face = "f";
            double area = 0;
            Point last{}, before{};
            for (int i = 0; i < corners; ++i) {
                const double r = (i + first) % 2 ? 10 : 4, at = 2 * M_PI * i / corners;
                const Point p{r * std::cos(at), r * std::sin(at), 0};
                obj += "v " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " 0\n";
                face += " " + std::to_string(i + 1);
                if (i == 0) before = p;
                if (i > 0) area += (last[0] * p[1] - last[1] * p[0]) / 2;
                last = p;
            }
            area += (last[0] * before[1] - last[1] * before[0]) / 2;
            const TriangleMesh mesh = readBytes("a.obj", obj + face + "\n");
            ASSERT_EQ(mesh.triangles.size(), static_cast<std::size_t>(corners - 2));
            const auto [sum, all] = areasOf(mesh);
            EXPECT_NEAR(sum, area, 1e-4) << corners;
            EXPECT_NEAR(all, area, 1e-4) << corners;
        }
    }
    // A plate with a hole, cut in by a bridge that is walked both ways.
    const TriangleMesh plate =
        readBytes("a.obj",
                  "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nv 3 3 0\nv 3 7 0\nv 7 7 0\nv 7 3 0\n"
                  "f 1 2 3 4 1 5 6 7 8 5\n");
    const auto [sum, all] = areasOf(plate);
    EXPECT_NEAR(sum, 84, 1e-9);
    EXPECT_NEAR(all, 84, 1e-9);
}

TEST(ReadMesh, SaysWhatIsNotKept) {
    const auto noteOf = [](const char* name, const std::string& bytes) {
        return readMeshFile(written(name, bytes)).droppedNote;
    };
    EXPECT_EQ(noteOf("a.obj", kTetrahedronObj), "");
    EXPECT_EQ(noteOf("a.obj",
                     "mtllib a.mtl\no x\nvt 0 0\n" + replaced(kTetrahedronObj, "v 0 0 0", "v 0 0 0 1 1 0.5")),
              "colours, texture coordinates, materials and groups are not kept");
    EXPECT_EQ(noteOf("a.obj", "vn 0 0 1\n" + kTetrahedronObj), "normals are not kept");
    EXPECT_EQ(noteOf("a.ply", kTetrahedronPly), "");
    EXPECT_EQ(noteOf("a.ply", replaced(replaced(kTetrahedronPly, "double z\n",
                                                "double z\nproperty uchar red\nproperty float quality\n"),
                                       "0 0 0\n1 0 0\n0 1 0\n0 0 1\n",
                                       "0 0 0 1 1\n1 0 0 1 1\n0 1 0 1 1\n0 0 1 1 1\n")),
              "colours and other properties are not kept");
    EXPECT_EQ(noteOf("a.off", kTetrahedronOff), "");
    EXPECT_EQ(noteOf("a.off", replaced(kTetrahedronOff, "3 0 2 1", "3 0 2 1 255 0 0")),
              "colours are not kept");
    EXPECT_EQ(noteOf("a.stl", binaryStl(kBall)), "");
    std::string coloured = binaryStl(kBall);
    coloured[84 + 49] = '\x7f';
    EXPECT_EQ(noteOf("a.stl", coloured), "colours are not kept");
}

TEST(ReadMesh, KnowsHowFineItsNumbersAre) {
    const auto stepOf = [](const char* name, const std::string& bytes) {
        return readMeshFile(written(name, bytes)).step;
    };
    const TriangleMesh ball = shapes::sphere(10, 1, {1, 2, 3});  // largest coordinate 13
    EXPECT_EQ(stepOf("a.stl", binaryStl(ball)), std::ldexp(1.0, 3 - 23));
    std::string digits;
    for (const char* p : {"v 0 0 0", "v 12.3456 0 0", "v 0 1 0", "v 0 0 1"}) digits += std::string(p) + "\n";
    EXPECT_DOUBLE_EQ(stepOf("a.obj", digits + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"), 1e-4);
    EXPECT_EQ(stepOf("a.ply", binaryPly(ball)), std::ldexp(1.0, 3 - 23));
}

// Two nodes over one mesh of a triangle strip that makes a tetrahedron's four faces, in another node that is turned and far
// away; the second one is mirrored.
std::string tetrahedraGlb(const std::string& nodes, const std::string& ofMesh = "",
                          const std::string& ofPrimitive = "") {
    std::string binary;
    for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f}) append(binary, x);
    for (const int i : {0, 2, 1, 3, 0, 2}) append(binary, static_cast<std::uint16_t>(i));
    std::string json =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
        R"(,"meshes":[{)" + ofMesh + R"("primitives":[{)" + ofPrimitive +
        R"("attributes":{"POSITION":0},"indices":1,"mode":5,"material":0}]}],)"
        R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
        R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],)"
        R"("bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],)"
        R"("buffers":[{"byteLength":60}]})";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string glb = "glTF";
    append(glb, std::uint32_t{2});
    append(glb, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary.size()));
    append(glb, static_cast<std::uint32_t>(json.size()));
    append(glb, std::uint32_t{0x4e4f534a});
    glb += json;
    append(glb, static_cast<std::uint32_t>(binary.size()));
    append(glb, std::uint32_t{0x004e4942});
    return glb + binary;
}

TEST(ReadMesh, ReadsGlbWithTheTransformsOfItsNodes) {
    MeshFileInfo info;
    const std::string glb = tetrahedraGlb(
        R"([{"children":[1,2],"translation":[500000,0,100]},{"mesh":0,"rotation":[0,0,0.7071067811865476,0.7071067811865476]},)"
        R"({"mesh":0,"matrix":[-2,0,0,0, 0,2,0,0, 0,0,2,0, 10,0,0,1]}])");
    const TriangleMesh mesh = readBytes("a.glb", glb, &info);
    EXPECT_EQ(info.format, "GLB");
    ASSERT_EQ(mesh.points.size(), 8u);
    EXPECT_EQ(mesh.triangles.size(), 8u);
    EXPECT_TRUE(checks::isClosedAndOriented(mesh));
    EXPECT_NEAR(checks::volumeOf(mesh), (1 + 8) / 6.0 * 1e9, 1e3);  // in mm, the mirrored one not inside out
    // The quarter turn about z takes (1, 0, 0) to (0, 1, 0), y up; in mm and z up.
    EXPECT_NEAR(mesh.points[1][0], 500000e3, 1e-6);
    EXPECT_NEAR(mesh.points[1][1], -100e3, 1e-6);
    EXPECT_NEAR(mesh.points[1][2], 1e3, 1e-6);
    EXPECT_EQ(readMeshFile(written("a.glb", glb)).droppedNote, "materials and groups are not kept");
}

// They were passed over without a remark: a face that is scanned at rest and shown smiling came at rest.
TEST(ReadMesh, MorphTargetsOfGlbMoveAsFarAsTheirWeightsSay) {
    // The target of each point is the point itself, so that a weight of w makes the tetrahedron 1 + w as large.
    const auto morphed = [](const std::string& nodes, const std::string& ofMesh = "") {
        return tetrahedraGlb(nodes, ofMesh, R"("targets":[{"POSITION":0}],)");
    };
    const double volume = checks::volumeOf(readBytes("a.glb", tetrahedraGlb(R"([{"mesh":0}])")));
    const auto grown = [&](const std::string& glb) {
        return std::cbrt(checks::volumeOf(readBytes("a.glb", glb)) / volume);
    };
    EXPECT_NEAR(grown(morphed(R"([{"mesh":0}])")), 1, 1e-9);
    EXPECT_NEAR(grown(morphed(R"([{"mesh":0}])", R"("weights":[0.5],)")), 1.5, 1e-9);
    EXPECT_NEAR(grown(morphed(R"([{"mesh":0,"weights":[1]}])", R"("weights":[0.5],)")), 2, 1e-9);
    EXPECT_THAT(readMeshFile(written("a.glb", morphed(R"([{"mesh":0}])"))).droppedNote,
                ::testing::HasSubstr("morph targets"));
    EXPECT_REFUSED("a.glb", morphed(R"([{"mesh":0}])", R"("weights":[null],)"), "'weights' holds no numbers");
}

TEST(ReadMesh, RefusesGlbThatItCannotRead) {
    const std::string glb = tetrahedraGlb(R"([{"mesh":0}])");
    for (std::size_t size = 1; size < glb.size(); ++size)
        EXPECT_THROW(readBytes("a.glb", glb.substr(0, size)), InputError) << size;
    EXPECT_REFUSED("a.glb", tetrahedraGlb(R"([{"mesh":1}])"), "refers to number 1 of 'meshes', which has 1");
    EXPECT_REFUSED("a.glb", tetrahedraGlb(R"([{"children":[0]}])"), "its nodes hold each other");
    EXPECT_REFUSED("a.glb", replaced(glb, "\"count\":4", "\"count\":5"), "reaches beyond its data");
    EXPECT_REFUSED("a.glb", replaced(glb, "\"count\":4", "\"count\":2"), "a triangle refers to point 2");
    EXPECT_REFUSED("a.glb", replaced(glb, "\"scene\":0", "\"scene\"=0"), "not valid JSON");
    EXPECT_REFUSED("a.glb", "glTX" + glb.substr(4), "does not start with 'glTF'");
}

TEST(ReadMesh, SaysHowToConvertWhatItDoesNotRead) {
    for (const char* name : {"a.amf", "a.fbx", "a.gltf", "a.dae"})
        EXPECT_THAT([&] { readMesh(name); }, refuses("export it as STL, OBJ, PLY, OFF or GLB")) << name;
    for (const char* name : {"a.STEP", "a.stp", "a.igs"})
        EXPECT_THAT([&] { readMesh(name); }, refuses("make a mesh of it: gmsh")) << name;
}

TEST(ReadMesh, CutsPolygonsIntoFans) {
    MeshFileInfo info;
    const TriangleMesh mesh =
        readBytes("a.obj", "v 0 0 0\nv 2 0 0\nv 3 1 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n", &info);
    EXPECT_EQ(info.polygons, 1);
    EXPECT_THAT(mesh.triangles,
                ::testing::ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{0, 3, 4}));
}

TEST(ReadMesh, IsSilentAndSurvivesDamage) {
    // Any byte may be anything: it reads or throws InputError, and CGAL prints nothing.
    ::testing::internal::CaptureStderr();
    ::testing::internal::CaptureStdout();
    for (const auto& [name, bytes] : {std::pair{"a.stl", binaryStl(kBall)},
                                      {"a.ply", binaryPly(kBall)},
                                      {"a.obj", kTetrahedronObj},
                                      {"a.off", kTetrahedronOff},
                                      {"b.ply", kTetrahedronPly},
                                      {"b.stl", asciiStl()},
                                      {"a.glb", tetrahedraGlb(R"([{"mesh":0}])")}}) {
        std::mt19937 random(7);
        for (int trial = 0; trial < 3000; ++trial) {
            std::string damaged = bytes;
            for (int i = 0; i < 1 + trial % 3; ++i) {
                damaged[random() % std::min<std::size_t>(damaged.size(), 1200)] =
                    static_cast<char>(random() % 256);
            }
            try {
                const TriangleMesh mesh = readBytes(name, damaged);
                for (const Triangle& t : mesh.triangles) {
                    for (const auto corner : t) ASSERT_LT(corner, mesh.points.size());
                }
            } catch (const InputError& error) {
                EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
            }
        }
    }
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}

TEST(IsMeshPath, GoesByTheExtension) {
    for (const char* name : {"a.stl", "b.STL", "c.Obj", "d.ply", "e.off", "f.glb", "a.stl.gz"})
        EXPECT_TRUE(isMeshPath(name)) << name;
    for (const char* name : {"a.nrrd", "stl", "a.nii.gz", ""}) EXPECT_FALSE(isMeshPath(name)) << name;
}

}  // namespace
}  // namespace isowave
