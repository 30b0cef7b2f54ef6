#include "io/mesh/write.h"
#include "io/mesh/equal_points.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "io/mesh/distance/recolour_glb.h"
#include "io/mesh/read.h"
#include "isowave/error.h"
#include "polygonize/fields.h"
#include "polygonize/polygonize.h"
#include "polygonize/topology.h"

namespace isowave {
namespace {

using namespace isowave::testing;
namespace fs = std::filesystem;

constexpr std::array kFormats{MeshFormat::stl, MeshFormat::ply, MeshFormat::obj,    MeshFormat::off,
                              MeshFormat::glb, MeshFormat::vtp, MeshFormat::threeMf};

fs::path freshFolder(const std::string& name) {
    const fs::path folder =
        fs::temp_directory_path() / ("isowave_mesh_writer_" + name + std::to_string(::getpid()));
    fs::remove_all(folder);
    fs::create_directories(folder);
    return folder;
}

std::string bytesOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

openvdb::math::Transform::Ptr scaledAndMoved(double spacing, const Vec3d& origin) {
    auto transform = openvdb::math::Transform::createLinearTransform(spacing);
    transform->postTranslate(origin);
    return transform;
}

TriangleMesh ringMesh(double spacing = 1, const Vec3d& origin = Vec3d(0)) {
    return polygonize(fieldFromDistance(16, torus(8, 3), scaledAndMoved(spacing, origin)));
}

// ---- readers of a few lines each, sharing nothing with the writer

template <class T>
T take(const std::string& bytes, std::size_t& at) {
    T value;
    EXPECT_LE(at + sizeof value, bytes.size());
    std::memcpy(&value, bytes.data() + at, sizeof value);
    at += sizeof value;
    return value;
}

struct ReadMesh : TriangleMesh {
    std::string comment;  // "LPS", "RAS" or nothing
    bool wide = false;
    nlohmann::json json;
};

std::string spaceIn(const std::string& text) {
    const auto at = text.find("SPACE=");
    return at == std::string::npos ? "" : text.substr(at + 6, 3);
}

ReadMesh readStl(const std::string& bytes) {
    ReadMesh mesh;
    mesh.comment = spaceIn(bytes.substr(0, 80));
    EXPECT_NE(bytes.substr(0, 5), "solid");
    std::size_t at = 80;
    const auto count = take<std::uint32_t>(bytes, at);
    EXPECT_EQ(bytes.size(), 84 + 50 * std::size_t{count});
    for (std::uint32_t t = 0; t < count; ++t) {
        std::array<float, 12> x;
        for (float& v : x) v = take<float>(bytes, at);
        EXPECT_EQ(take<std::uint16_t>(bytes, at), 0);
        const Vec3d a(x[3], x[4], x[5]), b(x[6], x[7], x[8]), c(x[9], x[10], x[11]);
        const Vec3d normal(x[0], x[1], x[2]), facet = (b - a).cross(c - a);
        if (facet.length() > 0) {
            EXPECT_LT((normal - facet / facet.length()).length(), 1e-6);
        }
        for (const Vec3d& p : {a, b, c}) mesh.points.push_back({p[0], p[1], p[2]});
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return mesh;
}

ReadMesh readPly(const std::string& bytes) {
    ReadMesh mesh;
    const std::size_t end = bytes.find("end_header\n");
    const std::string header = bytes.substr(0, end);
    EXPECT_EQ(header.substr(0, 43), "ply\nformat binary_little_endian 1.0\ncomment");
    mesh.comment = spaceIn(header);
    mesh.wide = header.find("property double x") != std::string::npos;
    const bool normals = header.find("property float nx") != std::string::npos;
    const auto numberAfter = [&](const char* key) {
        return std::stoul(header.substr(header.find(key) + strlen(key)));
    };
    const std::size_t vertices = numberAfter("element vertex "), faces = numberAfter("element face ");
    std::size_t at = end + 11;
    for (std::size_t i = 0; i < vertices; ++i) {
        Point p;
        for (double& x : p) x = mesh.wide ? take<double>(bytes, at) : take<float>(bytes, at);
        mesh.points.push_back(p);
        if (normals) mesh.normals.push_back(take<std::array<float, 3>>(bytes, at));
    }
    for (std::size_t i = 0; i < faces; ++i) {
        EXPECT_EQ(take<std::uint8_t>(bytes, at), 3);
        mesh.triangles.push_back(take<Triangle>(bytes, at));
    }
    EXPECT_EQ(at, bytes.size());
    return mesh;
}

ReadMesh readObj(const std::string& bytes) {
    ReadMesh mesh;
    std::istringstream lines(bytes);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string key;
        words >> key;
        if (key == "#" && mesh.comment.empty()) mesh.comment = spaceIn(line);
        Point p;
        if (key == "v" || key == "vn") words >> p[0] >> p[1] >> p[2];
        if (key == "v") mesh.points.push_back(p);
        if (key == "vn")
            mesh.normals.push_back(
                {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
        if (key == "f") {
            Triangle t;
            for (auto& v : t) {
                std::string corner;
                words >> corner;
                v = static_cast<std::uint32_t>(std::stoul(corner) - 1);
                const auto slash = corner.find("//");
                EXPECT_EQ(slash != std::string::npos, !mesh.normals.empty());
                if (slash != std::string::npos) {
                    EXPECT_EQ(std::stoul(corner.substr(slash + 2)), v + 1);
                }
            }
            mesh.triangles.push_back(t);
        }
        EXPECT_FALSE(words.fail()) << line;
    }
    return mesh;
}

ReadMesh readOff(const std::string& bytes) {
    ReadMesh mesh;
    EXPECT_EQ(bytes.substr(0, 4), "OFF\n");
    std::istringstream lines(bytes.substr(4));
    std::string text;
    for (std::string line; std::getline(lines, line);)
        if (line[0] == '#')
            mesh.comment = spaceIn(line);
        else
            text += line + "\n";
    std::istringstream words(text);
    std::size_t vertices, faces, edges, n;
    words >> vertices >> faces >> edges;
    mesh.points.resize(vertices);
    mesh.triangles.resize(faces);
    for (Point& p : mesh.points) words >> p[0] >> p[1] >> p[2];
    for (Triangle& t : mesh.triangles) {
        words >> n >> t[0] >> t[1] >> t[2];
        EXPECT_EQ(n, 3u);
    }
    EXPECT_FALSE(words.fail());
    return mesh;
}

ReadMesh readGlb(const std::string& bytes) {
    ReadMesh mesh;
    std::size_t at = 0;
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    at = 4;
    EXPECT_EQ(take<std::uint32_t>(bytes, at), 2u);
    EXPECT_EQ(take<std::uint32_t>(bytes, at), bytes.size());
    const auto length = take<std::uint32_t>(bytes, at);
    EXPECT_EQ(length % 4, 0u);
    EXPECT_EQ(take<std::uint32_t>(bytes, at), 0x4e4f534au);
    mesh.json = nlohmann::json::parse(bytes.substr(at, length));
    at += length;
    mesh.comment = mesh.json["asset"].value("extras", nlohmann::json::object()).value("SPACE", "");
    if (!mesh.json.contains("meshes")) {
        EXPECT_EQ(at, bytes.size());
        return mesh;
    }
    const auto binary = take<std::uint32_t>(bytes, at);
    EXPECT_EQ(take<std::uint32_t>(bytes, at), 0x004e4942u);
    EXPECT_EQ(at + binary, bytes.size());
    EXPECT_EQ(mesh.json["buffers"][0]["byteLength"], binary);
    const auto& primitive = mesh.json["meshes"][0]["primitives"][0];
    const auto accessor = [&](const nlohmann::json& index) {
        return mesh.json["accessors"][index.get<int>()];
    };
    const auto start = [&](const nlohmann::json& a) {
        return at + mesh.json["bufferViews"][a["bufferView"].get<int>()]["byteOffset"].get<std::size_t>();
    };
    const auto positions = accessor(primitive["attributes"]["POSITION"]);
    std::size_t p = start(positions);
    Point low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};
    for (int i = 0; i < positions["count"]; ++i) {
        const auto x = take<std::array<float, 3>>(bytes, p);
        mesh.points.push_back({x[0], x[1], x[2]});
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min<double>(low[a], x[a]);
            high[a] = std::max<double>(high[a], x[a]);
        }
    }
    EXPECT_EQ(positions["min"].get<Point>(), low);
    EXPECT_EQ(positions["max"].get<Point>(), high);
    if (primitive["attributes"].contains("NORMAL")) {
        const auto normals = accessor(primitive["attributes"]["NORMAL"]);
        p = start(normals);
        for (int i = 0; i < normals["count"]; ++i)
            mesh.normals.push_back(take<std::array<float, 3>>(bytes, p));
    }
    const auto indices = accessor(primitive["indices"]);
    EXPECT_EQ(indices["componentType"], 5125);
    p = start(indices);
    for (int i = 0; i < indices["count"].get<int>() / 3; ++i)
        mesh.triangles.push_back(take<Triangle>(bytes, p));
    EXPECT_EQ(p, bytes.size());
    return mesh;
}

// XML's formats, by the reader that xml_test.cpp and tests/field/meshes.py test.
ReadMesh readXml(const std::string& bytes, MeshFormat format) {
    const PolygonSoup soup = parseMesh(bytes, format, "written");
    ReadMesh mesh;
    mesh.comment = soup.space;
    mesh.wide = !soup.float32;
    mesh.points = soup.points;
    for (std::size_t c = 0; c + 2 < soup.corners.size(); c += 3)
        mesh.triangles.push_back({soup.corners[c], soup.corners[c + 1], soup.corners[c + 2]});
    return mesh;
}

ReadMesh readMesh(const fs::path& path, MeshFormat format) {
    const std::string bytes = bytesOf(path);
    switch (format) {
        case MeshFormat::stl:
            return readStl(bytes);
        case MeshFormat::ply:
            return readPly(bytes);
        case MeshFormat::obj:
            return readObj(bytes);
        case MeshFormat::off:
            return readOff(bytes);
        case MeshFormat::glb:
            return readGlb(bytes);
        case MeshFormat::vtp:
        case MeshFormat::threeMf:
            return readXml(bytes, format);
    }
    return {};
}

ReadMesh writeAndRead(const TriangleMesh& mesh, MeshFormat format, const MeshWriteOptions& options = {}) {
    const fs::path folder = freshFolder("round"), path = folder / (std::string("mesh") + extensionOf(format));
    writeMesh(path, mesh, format, options);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
    ReadMesh read = readMesh(path, format);
    fs::remove_all(folder);
    return read;
}

bool good(const TriangleMesh& mesh) {
    const MeshTopology t = topologyOf(mesh);
    return t.closed() && t.manifold() && t.oriented();
}

// ---- names

TEST(MeshFormat, IsKnownByExtensionAndNameInAnyCase) {
    for (const MeshFormat format : kFormats) {
        EXPECT_EQ(meshFormatOf(std::string("a/b.c") + extensionOf(format)), format);
        EXPECT_EQ(meshFormatFromName(extensionOf(format) + 1), format);
    }
    EXPECT_EQ(meshFormatOf("PART.STL"), MeshFormat::stl);
    EXPECT_EQ(meshFormatFromName("Ply"), MeshFormat::ply);
}

TEST(MeshFormat, NamesThemAllForAnother) {
    for (const char* path : {"a.amf", "a", "a.stl.gz"}) {
        try {
            meshFormatOf(path);
            FAIL() << path;
        } catch (const InputError& e) {
            for (const MeshFormat format : kFormats)
                EXPECT_NE(std::string(e.what()).find(extensionOf(format)), std::string::npos) << e.what();
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
        }
    }
    EXPECT_THROW(meshFormatFromName("step"), InputError);
}

// ---- what is read back

TEST(MeshWriter, IndexedFormatsKeepTrianglesAndNormals) {
    const TriangleMesh mesh = ringMesh();
    for (const MeshFormat format :
         {MeshFormat::ply, MeshFormat::obj, MeshFormat::off, MeshFormat::glb, MeshFormat::vtp}) {
        const ReadMesh read = writeAndRead(mesh, format);
        EXPECT_EQ(read.triangles, mesh.triangles) << extensionOf(format);
        ASSERT_EQ(read.points.size(), mesh.points.size());
        EXPECT_EQ(read.comment, "");
        if (format != MeshFormat::off && format != MeshFormat::vtp) {  // whose normals the reader drops
            EXPECT_EQ(read.normals.size(), mesh.normals.size());
        }
        if (format == MeshFormat::ply || format == MeshFormat::obj) {
            EXPECT_EQ(read.normals, mesh.normals);
        }
    }
}

TEST(MeshWriter, TextFormatsReadBackExactly) {
    const TriangleMesh mesh = ringMesh(0.1, Vec3d(1000, 1e-7, -3));
    EXPECT_EQ(writeAndRead(mesh, MeshFormat::obj).points, mesh.points);
    EXPECT_EQ(writeAndRead(mesh, MeshFormat::off).points, mesh.points);
}

TEST(MeshWriter, WritesMeshesWithoutNormalsAndEmptyOnes) {
    TriangleMesh mesh = ringMesh();
    mesh.normals.clear();
    for (const MeshFormat format : kFormats) {
        const ReadMesh read = writeAndRead(mesh, format);
        EXPECT_EQ(read.triangles.size(), mesh.triangles.size()) << extensionOf(format);
        EXPECT_TRUE(read.normals.empty());
        EXPECT_TRUE(writeAndRead({}, format).triangles.empty()) << extensionOf(format);
    }
}

TEST(MeshWriter, StlMergedByPositionIsTheMeshAgain) {
    const TriangleMesh mesh = ringMesh();
    const TriangleMesh merged = mergeEqualPoints(writeAndRead(mesh, MeshFormat::stl));
    EXPECT_EQ(merged.points.size(), mesh.points.size());
    EXPECT_TRUE(good(merged));
    EXPECT_EQ(topologyOf(merged).genus, 1);
}

TEST(MeshWriter, GlbIsMetresWithYUp) {
    const TriangleMesh mesh = ringMesh(2.5, Vec3d(10, 20, 30));
    const ReadMesh read = writeAndRead(mesh, MeshFormat::glb);
    EXPECT_EQ(read.json["asset"]["version"], "2.0");
    EXPECT_EQ(read.json["asset"]["generator"], "isowave");
    EXPECT_EQ(read.json["nodes"][0]["name"], "mesh");
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const Point& p = mesh.points[i];
        EXPECT_NEAR(read.points[i][0], 0.001 * p[0], 1e-8);
        EXPECT_NEAR(read.points[i][1], 0.001 * p[2], 1e-8);
        EXPECT_NEAR(read.points[i][2], -0.001 * p[1], 1e-8);
        EXPECT_EQ(read.normals[i][1], mesh.normals[i][2]);
        EXPECT_EQ(read.normals[i][2], -mesh.normals[i][1] + 0.0f);
    }
    EXPECT_GT(topologyOf(read).volume, 0);
    const ReadMesh inches = writeAndRead(mesh, MeshFormat::glb, {.metresPerUnit = 0.0254});
    EXPECT_NEAR(inches.points[0][0], 0.0254 * mesh.points[0][0], 1e-6);
}

TEST(MeshWriter, SaysItsSpaceAndTurnsToRas) {
    const TriangleMesh mesh = ringMesh();
    const double volume = topologyOf(mesh).volume;
    for (const MeshFormat format : kFormats) {
        // So that coordinates are read back as they were: GLB is read in metres, 3MF in mm.
        const double metres = format == MeshFormat::threeMf ? 0.001 : 1;
        const ReadMesh lps = writeAndRead(mesh, format, {.space = Space::lps, .metresPerUnit = metres});
        const ReadMesh ras = writeAndRead(mesh, format, {.space = Space::ras, .metresPerUnit = metres});
        EXPECT_EQ(lps.comment, "LPS") << extensionOf(format);
        EXPECT_EQ(ras.comment, "RAS") << extensionOf(format);
        const int y = format == MeshFormat::glb ? 2 : 1;  // where the y coordinate went
        for (std::size_t i = 0; i < lps.points.size(); ++i) {
            ASSERT_EQ(ras.points[i][0], -lps.points[i][0]);
            ASSERT_EQ(ras.points[i][y], -lps.points[i][y]);
            ASSERT_EQ(ras.points[i][3 - y], lps.points[i][3 - y]);
        }
        for (std::size_t i = 0; i < lps.normals.size(); ++i) ASSERT_EQ(ras.normals[i][0], -lps.normals[i][0]);
        EXPECT_NEAR(topologyOf(mergeEqualPoints(ras)).volume / volume, 1, 1e-5) << extensionOf(format);
    }
}

TEST(MeshWriter, BytesDependOnTheMeshAlone) {
    const BSplineField field = noiseField(24, 4);
    for (const MeshFormat format : kFormats) {
        std::string first;
        for (const std::size_t threads : {1, 2, 4}) {
            tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
            const fs::path path = freshFolder("bytes") / (std::string("a") + extensionOf(format));
            writeMesh(path, polygonize(field), format, {.space = Space::lps});
            const std::string bytes = bytesOf(path);
            fs::remove_all(path.parent_path());
            if (threads == 1) first = bytes;
            EXPECT_EQ(bytes, first) << extensionOf(format) << " " << threads;
        }
        EXPECT_GT(first.size(), 100000u);
    }
}

// ---- distances to level 0

TEST(MeshWriter, DistancesAreAPropertyOfPly) {
    const TriangleMesh mesh = ringMesh();
    MeshWriteOptions options;
    for (std::size_t i = 0; i < mesh.points.size(); ++i)
        options.distanceToLevel0.push_back(0.25F * static_cast<float>(i));
    const fs::path path = freshFolder("distances") / "a.ply";
    writeMesh(path, mesh, MeshFormat::ply, options);
    const std::string bytes = bytesOf(path);
    const std::string last = "property float nz\nproperty float distance_to_level0\nelement face";
    EXPECT_NE(bytes.find(last), std::string::npos);
    constexpr std::size_t kVertex = 7 * sizeof(float);
    std::size_t at = bytes.find("end_header\n") + 11 + 6 * sizeof(float);
    for (std::size_t i = 0; i < mesh.points.size(); ++i, at += kVertex) {
        std::size_t here = at;
        ASSERT_EQ(take<float>(bytes, here), options.distanceToLevel0[i]);
    }
    EXPECT_EQ(isowave::readMesh(path).triangles, mesh.triangles);
    fs::remove_all(path.parent_path());
}

// Pale for no distance, dark for the range; linear light of sRGB 226 222 211 and 66 10 62 (IEC 61966-2-1).
TEST(MeshWriter, DistancesAreAnAttributeAndColoursOfGlb) {
    const TriangleMesh mesh = ringMesh();
    MeshWriteOptions options;
    options.distanceToLevel0.assign(mesh.points.size(), 0);
    options.distanceToLevel0[1] = 2;
    options.distanceToLevel0[2] = 0.5;
    const fs::path path = freshFolder("distances") / "a.glb";
    writeMesh(path, mesh, MeshFormat::glb, options);
    const std::string bytes = bytesOf(path);
    const nlohmann::json json = readGlb(bytes).json;
    fs::remove_all(path.parent_path());
    const auto& attributes = json["meshes"][0]["primitives"][0]["attributes"];
    const std::size_t binary = bytes.size() - json["buffers"][0]["byteLength"].get<std::size_t>();
    const auto startOf = [&](const char* name) {
        const auto& accessor = json["accessors"][attributes[name].get<std::size_t>()];
        EXPECT_EQ(accessor["count"], mesh.points.size());
        return binary + json["bufferViews"][accessor["bufferView"].get<std::size_t>()]["byteOffset"]
                            .get<std::size_t>();
    };
    std::size_t at = startOf("_DISTANCE_TO_LEVEL0");
    EXPECT_EQ(take<float>(bytes, at), 0);
    EXPECT_EQ(take<float>(bytes, at), 2);
    EXPECT_EQ(take<float>(bytes, at), 0.5F);
    at = startOf("COLOR_0");
    const auto linear = [](double c) { return std::pow((c / 255 + 0.055) / 1.055, 2.4); };
    const std::array<double, 3> pale{linear(226), linear(222), linear(211)},
        dark{linear(66), 10 / 255.0 / 12.92, linear(62)};
    for (const auto& expected : {pale, dark}) {
        const auto colour = take<std::array<std::uint16_t, 4>>(bytes, at);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(colour[k] / 65'535.0, expected[k], 1e-5);
        EXPECT_EQ(colour[3], 65'535);
    }
    EXPECT_EQ(json["meshes"][0]["extras"]["distance_of_last_colour"], 2);
}

// A ladder knows the range of its colours when its last mesh is measured.
TEST(MeshWriter, RecolouredGlbIsTheOneOfThatRange) {
    const TriangleMesh mesh = ringMesh();
    MeshWriteOptions options;
    for (std::size_t i = 0; i < mesh.points.size(); ++i)
        options.distanceToLevel0.push_back(0.01F * static_cast<float>(i));
    const fs::path folder = freshFolder("recoloured");
    for (const double range : {123.456789, 3e-7}) {  // one beyond all distances, one that most are beyond
        writeMesh(folder / "a.glb", mesh, MeshFormat::glb, options);
        const std::string before = bytesOf(folder / "a.glb");
        recolourGlb(folder / "a.glb", range);
        MeshWriteOptions given = options;
        given.distanceRange = range;
        const std::string recoloured = bytesOf(folder / "a.glb");
        writeMesh(folder / "a.glb", mesh, MeshFormat::glb, given);
        EXPECT_TRUE(recoloured == bytesOf(folder / "a.glb")) << range;  // too long to print
        EXPECT_FALSE(recoloured == before) << range;
    }
    writeMesh(folder / "empty.glb", {}, MeshFormat::glb);
    recolourGlb(folder / "empty.glb", 1);
    fs::remove_all(folder);
}

// ---- float32

TEST(MeshWriter, PlyTurnsToFloat64FarFromTheOrigin) {
    EXPECT_FALSE(writeAndRead(ringMesh(), MeshFormat::ply).wide);
    EXPECT_FALSE(writeAndRead(ringMesh(1, Vec3d(300, 0, 0)), MeshFormat::ply).wide);
    const TriangleMesh far = ringMesh(0.1, Vec3d(1000, -1000, 500));
    const ReadMesh read = writeAndRead(far, MeshFormat::ply);
    EXPECT_TRUE(read.wide);
    EXPECT_EQ(read.points, far.points);
    EXPECT_EQ(read.normals, far.normals);
}

// What STL would leave must be enough for the reader, which asks for 1024 steps across.
TEST(MeshWriter, RefusesStlWhereReadMeshWould) {
    const fs::path folder = freshFolder("steps"), file = folder / "a.stl";
    writeMesh(file, ringMesh(1, Vec3d(5e4, 0, 0)), MeshFormat::stl);  // steps of 1/256
    EXPECT_NO_THROW(isowave::readMesh(file));
    fs::remove(file);
    try {
        writeMesh(file, ringMesh(1, Vec3d(1e6, 0, 0)), MeshFormat::stl);  // of 1/16
        FAIL() << "was written";
    } catch (const OperationError& error) {
        EXPECT_NE(std::string(error.what()).find("steps of 0.062 at 1.00001e+06, fewer than 1024 across"),
                  std::string::npos)
            << error.what();
    }
    EXPECT_TRUE(fs::is_empty(folder));
    fs::remove_all(folder);
}

// Vertices of white noise crowd at the margins around lattice points, 1e-3 voxel apart: 1.4e-4 mm for 0.1 mm
// voxels, where float32 has steps of 6e-5 mm at 1000 mm and 4.9e-4 mm at 5000 mm.
TEST(MeshWriter, StlFarFromTheOriginStaysAManifoldWhenMergedByPosition) {
    for (const double far : {1000.0, 5000.0}) {
        BSplineField field = noiseField(24, 6);
        field.controlPoints->setTransform(scaledAndMoved(0.1, Vec3d(far, -far, far / 2)));
        const TriangleMesh mesh = polygonize(field);
        ASSERT_TRUE(good(mesh));

        TriangleMesh rounded = mesh;  // what plain rounding makes of it
        for (Point& p : rounded.points)
            for (double& x : p) x = static_cast<float>(x);
        const bool fuses = mergeEqualPoints(rounded).points.size() < mesh.points.size();
        EXPECT_EQ(fuses, far > 2000) << far;
        if (fuses) {
            EXPECT_FALSE(good(mergeEqualPoints(rounded)));
        }

        const ReadMesh read = writeAndRead(mesh, MeshFormat::stl);
        const TriangleMesh merged = mergeEqualPoints(read);
        EXPECT_EQ(merged.points.size(), mesh.points.size()) << far;
        EXPECT_TRUE(good(merged)) << far;
        EXPECT_EQ(topologyOf(merged).genus, topologyOf(mesh).genus);
        const double step =
            std::nextafter(static_cast<float>(far) * 1.01f, 1e30f) - static_cast<float>(far) * 1.01f;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
            for (int k = 0; k < 3; ++k)
                for (int a = 0; a < 3; ++a)
                    ASSERT_NEAR(read.points[3 * t + k][a], mesh.points[mesh.triangles[t][k]][a], 2.51 * step);
        EXPECT_TRUE(good(mergeEqualPoints(writeAndRead(mesh, MeshFormat::glb))));
    }
}

TEST(MeshWriter, RefusesFloat32WhereVerticesCannotBeToldApartAndRecommendsPly) {
    // 10 nm voxels at 1000 mm: all of the ring lies within a few float32 steps.
    TriangleMesh mesh = ringMesh();
    for (Point& p : mesh.points)
        for (double& x : p) x = 1000 + 1e-5 * x;
    const fs::path path = freshFolder("refuse") / "a.stl";
    try {
        writeMesh(path, mesh, MeshFormat::stl);
        FAIL();
    } catch (const OperationError& e) {
        EXPECT_NE(std::string(e.what()).find("STL"), std::string::npos);
        EXPECT_NE(std::string(e.what()).find("PLY"), std::string::npos) << e.what();
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    }
    EXPECT_TRUE(fs::is_empty(path.parent_path()));
    fs::remove_all(path.parent_path());
    // GLB has a translation in double for the place.
    EXPECT_TRUE(good(mergeEqualPoints(writeAndRead(mesh, MeshFormat::glb))));
    EXPECT_TRUE(good(mergeEqualPoints(writeAndRead(mesh, MeshFormat::ply))));
    TriangleMesh huge = ringMesh();
    huge.points[5][1] = 1e39;
    EXPECT_THROW(writeAndRead(huge, MeshFormat::stl), OperationError);
    EXPECT_EQ(writeAndRead(huge, MeshFormat::ply).points, huge.points);
}

// A ball of radius 5 at UTM coordinates in metres, as surveys have it: float32 has steps of 0.5 there.
TEST(MeshWriter, KeepsTheShapeOfWhatIsFarFromTheOriginInGlb) {
    const Vec3 centre{500123.4, 5812345.6, 37.2};
    TriangleMesh ball = ringMesh();
    for (Point& p : ball.points) {
        const Vec3 from{p[0], p[1], p[2]}, out = from / length(from);
        p = {centre.x + 5 * out.x, centre.y + 5 * out.y, centre.z + 5 * out.z};
    }
    const fs::path folder = freshFolder("far"), path = folder / "a.glb";
    for (const double metres : {1.0, 0.001}) {
        writeMesh(path, ball, MeshFormat::glb, {.metresPerUnit = metres});
        const ReadMesh stored = readGlb(bytesOf(path));
        const auto place = stored.json["nodes"][0]["translation"].get<Point>();
        EXPECT_NEAR(place[0], centre.x * metres, 5 * metres);
        EXPECT_NEAR(place[2], -centre.y * metres, 5 * metres);
        const TriangleMesh back = isowave::readMesh(path);
        ASSERT_EQ(back.points.size(), ball.points.size());
        EXPECT_EQ(back.triangles, ball.triangles);
        for (const Point& p : back.points) {
            const double mm = 1000 * metres;
            EXPECT_NEAR(length(Vec3{p[0] / mm, p[1] / mm, p[2] / mm} - centre), 5,
                        1e-6);  // seen 3e-7; before, 0.5
        }
    }
    writeMesh(path, ringMesh(), MeshFormat::glb);
    EXPECT_FALSE(readGlb(bytesOf(path)).json["nodes"][0].contains("translation"));
    fs::remove_all(folder);
}

// ---- failures

TEST(MeshWriter, SaysThatTheDiskIsFullAndKeepsTheOldFile) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
    const TriangleMesh small = ringMesh(),
                       large = polygonize(noiseField(40, 1));  // below and above one piece
    for (const MeshFormat format : kFormats)
        for (const TriangleMesh* mesh : {&small, &large}) {
            const fs::path folder = freshFolder("full"),
                           path = folder / (std::string("a") + extensionOf(format));
            std::ofstream(path) << "old";
            fs::create_symlink("/dev/full", path.string() + ".part-" + std::to_string(::getpid()));
            EXPECT_THROW(writeMesh(path, *mesh, format), OperationError) << extensionOf(format);
            EXPECT_EQ(bytesOf(path), "old");
            EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
            fs::remove_all(folder);
        }
}

TEST(MeshWriter, RefusesAMissingFolder) {
    const fs::path folder = freshFolder("missing");
    for (const MeshFormat format : kFormats)
        EXPECT_THROW(writeMesh(folder / "no" / (std::string("a") + extensionOf(format)), ringMesh(), format),
                     OperationError);
    fs::remove_all(folder);
}

}  // namespace
}  // namespace isowave
