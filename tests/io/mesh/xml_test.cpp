// VTK's .vtp and 3MF: what their files say, and what is taken from it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zip.h>

#include <filesystem>
#include <fstream>

#include "io/mesh/read.h"
#include "io/mesh/xml/solid_parts.h"
#include "io/mesh/xml/three_mf.h"
#include "io/mesh/xml/three_mf_writer.h"
#include "io/mesh/xml/vtp.h"
#include "io/mesh/xml/vtp_writer.h"
#include "isowave/error.h"
#include "tests/io/mesh/zip.h"

namespace isowave {
namespace {

using test::zipOf;
using testing::ElementsAre;
using testing::HasSubstr;

template <class T>
std::string bytesOf(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// The message of an InputError, one line that begins with "file"; "" when there is none.
template <class Read>
std::string refusal(const Read& read) {
    try {
        read();
        return "";
    } catch (const InputError& e) {
        EXPECT_TRUE(std::string(e.what()).starts_with("file: ")) << e.what();
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        return e.what();
    }
}

// ---- VTP

std::string vtp(const std::string& piece, const std::string& behind = "") {
    return "<?xml version=\"1.0\"?>\n<!-- SPACE=RAS -->\n<VTKFile type=\"PolyData\" "
           "byte_order=\"LittleEndian\">\n<PolyData>" +
           piece + "</PolyData>" + behind + "</VTKFile>";
}

std::string ascii(const char* type, const char* name, int components, const std::string& numbers) {
    return fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">{}</DataArray>\n",
        type, name, components, numbers);
}

const std::string kPoints =
    "<Points>" + ascii("Float32", "Points", 3, "0 0 0  1 0 0  0 1 0  0 0 1") + "</Points>";

std::string polys(const std::string& corners, const std::string& ends, const char* part = "Polys") {
    return fmt::format("<{0}>{1}{2}</{0}>", part, ascii("Int64", "connectivity", 1, corners),
                       ascii("Int32", "offsets", 1, ends));
}

TEST(Vtp, PolygonsOfAllPiecesAreRead) {
    const std::string piece = "<Piece NumberOfPoints=\"4\" NumberOfPolys=\"2\">" + kPoints +
                              polys("0 1 2 0 1 2 3", "3 7") + "</Piece>";
    const PolygonSoup soup = readVtp(vtp(piece + piece), "file");
    EXPECT_EQ(soup.format, "VTP");
    EXPECT_EQ(soup.space, "RAS");
    ASSERT_EQ(soup.points.size(), 8u);
    EXPECT_EQ(soup.points[7], (Point{0, 0, 1}));
    EXPECT_THAT(soup.corners, ElementsAre(0, 1, 2, 0, 1, 2, 3, 4, 5, 6, 4, 5, 6, 7));
    EXPECT_THAT(soup.faceBegin, ElementsAre(0, 3, 7, 10, 14));
}

TEST(Vtp, StripsTurnEverySecondTriangle) {
    const std::string piece = "<Piece NumberOfPoints=\"4\" NumberOfStrips=\"1\" NumberOfLines=\"1\">" +
                              kPoints + polys("0 1 2 3", "4", "Strips") + "</Piece>";
    const PolygonSoup soup = readVtp(vtp(piece), "file");
    EXPECT_THAT(soup.corners, ElementsAre(0, 1, 2, 1, 3, 2));
    EXPECT_THAT(soup.droppedNote(), HasSubstr("lines"));
}

TEST(Vtp, AppendedArraysAreRead) {
    const auto element = [](const char* type, const char* name, int components, std::size_t offset) {
        return fmt::format(
            "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
            "offset=\"{}\"/>",
            type, name, components, offset);
    };
    const std::string points = bytesOf(std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1e-9}),
                      corners = bytesOf(std::vector<std::int32_t>{0, 1, 3}),
                      ends = bytesOf(std::vector<std::int64_t>{3});
    const auto length = [](const std::string& data) {
        return bytesOf(std::vector<std::uint32_t>{static_cast<std::uint32_t>(data.size())});
    };
    const std::string piece = "<Piece NumberOfPoints=\"4\" NumberOfPolys=\"1\"><Points>" +
                              element("Float64", "Points", 3, 0) + "</Points><Polys>" +
                              element("Int32", "connectivity", 1, 100) + element("Int64", "offsets", 1, 116) +
                              "</Polys></Piece>";
    const PolygonSoup soup =
        readVtp(vtp(piece, "<AppendedData encoding=\"raw\">_" + length(points) + points + length(corners) +
                               corners + length(ends) + ends + "</AppendedData>"),
                "file");
    EXPECT_FALSE(soup.float32);
    EXPECT_EQ(soup.points[3], (Point{0, 0, 1e-9}));
    EXPECT_THAT(soup.corners, ElementsAre(0, 1, 3));
}

TEST(Vtp, DamageIsRefused) {
    const auto refused = [](const std::string& attributes, const std::string& cells) {
        return refusal(
            [&] { readVtp(vtp("<Piece " + attributes + ">" + kPoints + cells + "</Piece>"), "file"); });
    };
    const std::string four = "NumberOfPoints=\"4\" NumberOfPolys=\"1\"";
    EXPECT_EQ(refused(four, polys("0 1 2", "3")), "");
    EXPECT_THAT(refused(four, polys("0 1 2", "4")), HasSubstr("'connectivity' breaks off"));
    EXPECT_THAT(refused(four, polys("0 1 2", "-1")), HasSubstr("offset 0 of its Polys is -1"));
    EXPECT_THAT(refused(four, ""), HasSubstr("has no array 'offsets' in 'Polys'"));
    EXPECT_THAT(refused("NumberOfPoints=\"-4\"", ""), HasSubstr("NumberOfPoints is '-4'"));
    EXPECT_THAT(refused("NumberOfPoints=\"5\"", ""), HasSubstr("'Points' breaks off"));
    // A corner that no point has is refused by whoever makes triangles of it.
    const PolygonSoup soup =
        readVtp(vtp("<Piece " + four + ">" + kPoints + polys("0 1 4", "3") + "</Piece>"), "file");
    EXPECT_GE(soup.corners[2], soup.points.size());
    EXPECT_THAT(refusal([] { readVtp("<VTKFile type=\"PolyData\"", "file"); }),
                HasSubstr("ends within its XML"));
}

// ---- 3MF

std::string threeMf(const std::string& model) { return zipOf({{"3D/3dmodel.model", model}}); }

const std::string kTetrahedron =
    "<mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" "
    "y=\"2\" z=\"0\"/>"
    "<vertex x=\"0\" y=\"0\" z=\"3\"/></vertices><triangles><triangle v1=\"0\" v2=\"2\" v3=\"1\"/><triangle "
    "v1=\"0\" v2=\"1\" v3=\"3\"/>"
    "<triangle v1=\"1\" v2=\"2\" v3=\"3\"/><triangle v1=\"2\" v2=\"0\" v3=\"3\"/></triangles></mesh>";

std::string model(const std::string& resources, const std::string& build,
                  const std::string& attributes = "") {
    return "<?xml version=\"1.0\"?><model " + attributes + "><resources>" + resources +
           "</resources><build>" + build + "</build></model>";
}

// Six times the volume that the polygons enclose: 6 for the tetrahedron, since 1 * 2 * 3 = 6.
double sixVolumes(const PolygonSoup& soup) {
    double sum = 0;
    for (std::size_t f = 0; f < soup.faceCount(); ++f) {
        const auto at = [&](std::size_t k) {
            const Point& p = soup.points[soup.corners[soup.faceBegin[f] + k]];
            return Vec3{p[0], p[1], p[2]};
        };
        sum += dot(at(0), cross(at(1), at(2)));
    }
    return sum;
}

TEST(ThreeMf, TheUnitCounts) {
    const std::string object = "<object id=\"7\">" + kTetrahedron + "</object>",
                      item = "<item objectid=\"7\"/>";
    const PolygonSoup soup = readThreeMf(threeMf(model(object, item)), "file");
    EXPECT_EQ(soup.format, "3MF");
    EXPECT_EQ(soup.faceCount(), 4u);
    EXPECT_DOUBLE_EQ(sixVolumes(soup), 6);
    const PolygonSoup inches = readThreeMf(threeMf(model(object, item, "unit=\"inch\"")), "file");
    EXPECT_EQ(inches.points[1], (Point{25.4, 0, 0}));
    EXPECT_THAT(refusal([&] { readThreeMf(threeMf(model(object, item, "unit=\"mile\"")), "file"); }),
                HasSubstr("unit is 'mile'"));
}

TEST(ThreeMf, TheBuildIsReadWithItsComponentsAndTransforms) {
    const std::string objects =
        "<object id=\"1\">" + kTetrahedron +
        "</object><object id=\"2\"><components><component objectid=\"1\"/>"
        "<component objectid=\"1\" transform=\"2 0 0 0 1 0 0 0 1 10 20 30\"/></components></object>"
        "<object id=\"3\">" +
        kTetrahedron + "</object>";
    const PolygonSoup soup = readThreeMf(
        threeMf(model(objects, "<item objectid=\"2\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 5\"/>")), "file");
    EXPECT_EQ(soup.faceCount(), 8u);
    EXPECT_EQ(soup.points[1], (Point{-1, 0, 5}));
    EXPECT_EQ(soup.points[5], (Point{-12, 20, 35}));
    // Twice as wide, and still outside out though the item is mirrored.
    EXPECT_NEAR(sixVolumes(soup), 6 + 12, 1e-9);
    // Without a build all objects.
    EXPECT_EQ(readThreeMf(threeMf(model(objects, "")), "file").faceCount(), 4u + 8u + 4u);
}

TEST(ThreeMf, TheRelationSaysWhereTheModelIs) {
    const std::string relations =
        "<Relationships><Relationship Target=\"/3D/part.model\" Id=\"a\" "
        "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
    const std::string text =
        model("<object id=\"1\">" + kTetrahedron + "</object>", "<item objectid=\"1\"/>");
    EXPECT_EQ(readThreeMf(zipOf({{"_rels/.rels", relations}, {"3D/part.model", text}}), "file").faceCount(),
              4u);
    EXPECT_THAT(refusal([&] {
                    readThreeMf(zipOf({{"_rels/.rels", relations}}), "file");
                }),
                HasSubstr("has no part '3D/part.model'"));
}

// The production extension, as Bambu Studio and OrcaSlicer write every file. It was refused.
TEST(ThreeMf, ObjectsMayLieInPartsOfTheirOwn) {
    const std::string space = "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\"",
                      object = "<object id=\"1\">" + kTetrahedron + "</object>",
                      part = model(object, "<item objectid=\"1\"/>"),
                      inches = model(object, "", "unit=\"inch\""),
                      bad = model("<object id=\"1\"><vertex x=\"a\"/></object>", "");
    const auto read = [&](const std::string& objects, const std::string& build) {
        const std::string root = model(objects, build, space + " requiredextensions=\"p\"");
        return readThreeMf(zipOf({{"3D/3dmodel.model", root},
                                  {"3D/Objects/a.model", part},
                                  {"3D/Objects/inch.model", inches},
                                  {"3D/Objects/bad.model", bad}}),
                           "file");
    };
    const PolygonSoup item = read(
        "", "<item objectid=\"1\" p:path=\"/3D/Objects/a.model\" transform=\"2 0 0 0 1 0 0 0 1 0 0 5\"/>");
    EXPECT_EQ(item.faceCount(), 4u);  // what the part itself would build is not asked
    EXPECT_EQ(item.points[1], (Point{2, 0, 5}));
    const PolygonSoup components = read(
        "<object id=\"1\"><components><component objectid=\"1\" p:path=\"/3D/Objects/a.model\"/>"
        "<component objectid=\"1\" p:path=\"/3D/Objects/inch.model\" transform=\"1 0 0 0 1 0 0 0 1 0 0 "
        "5\"/></components></object>",
        "<item objectid=\"1\"/>");
    EXPECT_EQ(components.faceCount(), 8u);
    EXPECT_EQ(components.points[5], (Point{25.4, 0, 5}));
    EXPECT_THAT(refusal([&] { read("", "<item objectid=\"1\" p:path=\"/3D/Objects/bad.model\"/>"); }),
                HasSubstr("of its part '3D/Objects/bad.model': x is 'a'"));
    EXPECT_THAT(refusal([&] { read("", "<item objectid=\"9\" p:path=\"/3D/Objects/a.model\"/>"); }),
                HasSubstr("its part '3D/Objects/a.model' has no object '9'"));
}

// They were left out without a word, and the rest was taken for the shape.
TEST(ThreeMf, WhatIsNoTriangleIsRefusedWhereItIsPartOfTheShape) {
    const auto refused = [](const std::string& mesh, const std::string& attributes = "") {
        const std::string object = "<object id=\"1\">" + mesh + "</object>";
        return refusal(
            [&] { readThreeMf(threeMf(model(object, "<item objectid=\"1\"/>", attributes)), "file"); });
    };
    const auto needs = [&](const std::string& prefix, const std::string& space) {
        return refused(kTetrahedron,
                       "requiredextensions=\"" + prefix + "\" xmlns:" + prefix + "=\"" + space + "\"");
    };
    const std::string schemas = "http://schemas.microsoft.com/3dmanufacturing/";
    EXPECT_THAT(
        refused(
            "<b:beamlattice xmlns:b=\"b\"><b:beams><b:beam v1=\"0\" v2=\"1\"/></b:beams></b:beamlattice>"),
        HasSubstr("holds a 'beam', which is not read"));
    EXPECT_THAT(needs("b", schemas + "beamlattice/2017/02"),
                HasSubstr("beamlattice/2017/02', which is not read"));
    EXPECT_THAT(needs("v", "http://schemas.3mf.io/3dmanufacturing/volumetric/2022/01"),
                HasSubstr("needs 3MF's extension"));
    EXPECT_THAT(refused(kTetrahedron, "requiredextensions=\"x\""), HasSubstr("needs 3MF's extension 'x'"));
    EXPECT_EQ(needs("m", schemas + "material/2015/02"), "");
    EXPECT_EQ(needs("p", schemas + "production/2015/06"), "");
}

TEST(ThreeMf, DamageIsRefused) {
    const auto refused = [](const std::string& text) {
        return refusal([&] { readThreeMf(threeMf(text), "file"); });
    };
    const std::string object = "<object id=\"1\">" + kTetrahedron + "</object>";
    EXPECT_THAT(refused("<model>"), HasSubstr("line 1 of its model is no XML"));
    EXPECT_THAT(refused("<a/>"), HasSubstr("is no model"));
    EXPECT_THAT(refused(model(object, "<item objectid=\"2\"/>")), HasSubstr("has no object '2'"));
    EXPECT_THAT(refused(model(object + object, "")), HasSubstr("a second object 1"));
    EXPECT_THAT(
        refused(model("<object id=\"1\"><component objectid=\"1\"/></object>", "<item objectid=\"1\"/>")),
        HasSubstr("hold each other without end"));
    EXPECT_THAT(refused(model("<object id=\"1\"><vertex x=\"a\"/></object>", "")),
                HasSubstr("x is 'a'; expected a number"));
    EXPECT_THAT(refused(model(object, "<item objectid=\"1\" transform=\"1 2\"/>")),
                HasSubstr("expected 12 numbers"));
    EXPECT_THAT(refused(model(object, "<item objectid=\"1\" p:path=\"/b.model\" xmlns:p=\"p\"/>")),
                HasSubstr("has no part 'b.model', which its model refers to"));
    const std::string whole = threeMf(model(object, "<item objectid=\"1\"/>"));
    for (std::size_t length = 1; length < whole.size(); ++length)
        EXPECT_NE(refusal([&] { readThreeMf(whole.substr(0, length), "file"); }), "") << length;
}

// ---- written

// A cube of side 2 h about c: facing outwards, or inwards as a cavity does.
void addCube(TriangleMesh& mesh, double h, const Vec3& c, bool inwards = false) {
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    for (int i = 0; i < 8; ++i)
        mesh.points.push_back({c.x + (i & 1 ? h : -h), c.y + (i & 2 ? h : -h), c.z + (i & 4 ? h : -h)});
    constexpr Triangle kSides[] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    for (auto [a, b, d] : kSides) {
        if (inwards) std::swap(b, d);
        mesh.triangles.push_back({first + a, first + b, first + d});
    }
}

// A cube with two cavities, in one of them a cube that has a cavity too, and a cube beside. Rays along x from the cavities' corners
// run through edges of the other cubes.
TriangleMesh cubesInCubes() {
    TriangleMesh mesh;
    addCube(mesh, 1, {6, 0, 0}, /*inwards=*/true);
    addCube(mesh, 10, {0, 0, 0});
    addCube(mesh, 3, {-4, 0, 0}, /*inwards=*/true);
    addCube(mesh, 2, {-4, 0, 0});
    addCube(mesh, 1, {-4, 0, 0}, /*inwards=*/true);
    addCube(mesh, 1, {20, 0, 0});
    return mesh;
}

TEST(SolidParts, CavitiesBelongToTheSmallestShellAroundThem) {
    const TriangleMesh mesh = cubesInCubes();
    const auto parts = solidParts(mesh.points, mesh.triangles);
    ASSERT_EQ(parts.size(), 3u);
    const auto volume = [&](const std::vector<Triangle>& part) {
        PolygonSoup soup;
        soup.points = mesh.points;
        for (const Triangle& t : part) {
            soup.corners.insert(soup.corners.end(), t.begin(), t.end());
            soup.endFace();
        }
        return sixVolumes(soup) / 6;
    };
    EXPECT_DOUBLE_EQ(volume(parts[0]), 20 * 20 * 20 - 8 - 6 * 6 * 6);
    EXPECT_DOUBLE_EQ(volume(parts[1]), 4 * 4 * 4 - 8);
    EXPECT_DOUBLE_EQ(volume(parts[2]), 8);
    // Every triangle once, in its order.
    std::size_t count = 0;
    for (const auto& part : parts) count += part.size();
    EXPECT_EQ(count, mesh.triangles.size());
    EXPECT_EQ(parts[0].front(), mesh.triangles.front());
    TriangleMesh alone;
    addCube(alone, 1, {0, 0, 0}, /*inwards=*/true);
    EXPECT_EQ(solidParts(alone.points, alone.triangles).size(), 1u);
    EXPECT_TRUE(solidParts({}, {}).empty());
}

std::string written(const TriangleMesh& mesh, const auto& write, double metresPerUnit = 0.001) {
    MeshView view;
    view.points = mesh.points;
    view.triangles = mesh.triangles;
    view.metresPerUnit = metresPerUnit;
    Sink sink;
    write(sink, view);
    return sink.take();
}

std::string writtenThreeMf(const TriangleMesh& mesh, double metresPerUnit = 0.001) {
    return written(
        mesh, [](Sink& sink, const MeshView& view) { writeThreeMf(sink, view, "file", "a<b"); },
        metresPerUnit);
}

// The model of a 3MF as libzip has it.
std::string modelOf(const std::string& archive) {
    zip_source_t* const source = zip_source_buffer_create(archive.data(), archive.size(), 0, nullptr);
    zip_t* const zip = zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, nullptr);
    EXPECT_TRUE(zip);
    EXPECT_EQ(zip_get_num_entries(zip, 0), 3);
    zip_stat_t about;
    EXPECT_EQ(zip_stat(zip, "3D/3dmodel.model", 0, &about), 0);
    std::string text(about.size, ' ');
    zip_file_t* const file = zip_fopen(zip, "3D/3dmodel.model", 0);
    EXPECT_EQ(zip_fread(file, text.data(), text.size()), static_cast<zip_int64_t>(text.size()));
    zip_fclose(file);
    zip_discard(zip);
    return text;
}

TEST(ThreeMf, HasAnObjectForEachPartWithItsNameAndColour) {
    const std::string model = modelOf(writtenThreeMf(cubesInCubes()));
    for (const char* words :
         {"<model unit=\"millimeter\"", "<base name=\"a&lt;b 1\" displaycolor=\"#E69F00\"/>",
          "<base name=\"a&lt;b 2\" displaycolor=\"#56B4E9\"/>",
          "<object id=\"2\" type=\"model\" name=\"a&lt;b 1\" pid=\"1\" pindex=\"0\">",
          "<object id=\"4\" type=\"model\" name=\"a&lt;b 3\" pid=\"1\" pindex=\"2\">",
          "<item objectid=\"4\"/>"})
        EXPECT_THAT(model, HasSubstr(words));
    EXPECT_THAT(model, testing::Not(HasSubstr("<object id=\"5\"")));
    TriangleMesh one;
    addCube(one, 1, {0, 0, 0});
    EXPECT_THAT(modelOf(writtenThreeMf(one)), HasSubstr("name=\"a&lt;b\" pid"));
}

// Shells of one object stay one object, and an object's own points are numbered from 0.
TEST(ThreeMf, ObjectsHaveTheNamesColoursAndMeshesThatTheyAreGiven) {
    ModelObject two{"liver & \"gall\"", {0xDD, 0x08, 0xFF}, {}}, far{"far", {1, 2, 3}, {}};
    addCube(two.mesh, 1, {0, 0, 0});
    addCube(two.mesh, 1, {5, 0, 0});
    addCube(far.mesh, 1e-3, {1e4, 0, 0});  // needs float64
    const auto path =
        std::filesystem::temp_directory_path() / ("isowave_objects_" + std::to_string(::getpid()) + ".3mf");
    writeThreeMfObjects(path, {two, far}, {Space::ras, 0.01});
    const std::string archive = [&] {
        std::ifstream file(path, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    }();
    const std::string model = modelOf(archive);
    for (const char* words :
         {"<model unit=\"centimeter\"", "SPACE=RAS", "<base name=\"far\" displaycolor=\"#010203\"/>",
          "<base name=\"liver &amp; &quot;gall&quot;\" displaycolor=\"#DD08FF\"/>",
          "<object id=\"2\" type=\"model\" name=\"liver &amp; &quot;gall&quot;\" pid=\"1\" pindex=\"0\">",
          "<object id=\"3\" type=\"model\" name=\"far\" pid=\"1\" pindex=\"1\">", "<item objectid=\"3\"/>"})
        EXPECT_THAT(model, HasSubstr(words));
    EXPECT_THAT(model, testing::Not(HasSubstr("<object id=\"4\"")));
    const PolygonSoup soup = readThreeMf(archive, "file");
    ASSERT_EQ(soup.faceCount(), two.mesh.triangles.size() + far.mesh.triangles.size());
    const std::size_t first = 3 * two.mesh.triangles.size();
    for (std::size_t k = 0; k < 3 * far.mesh.triangles.size(); ++k) {
        const Point& p = far.mesh.points[far.mesh.triangles[k / 3][k % 3]];
        const Point& found = soup.points[soup.corners[first + k]];  // in mm, half a turn about z
        EXPECT_NEAR(found[0], -10 * p[0], 1e-10);
        EXPECT_NEAR(found[1], -10 * p[1], 1e-10);
        EXPECT_NEAR(found[2], 10 * p[2], 1e-10);
    }
    std::filesystem::remove(path);
}

TEST(ThreeMf, ReadsBackInEveryUnit) {
    const TriangleMesh mesh = cubesInCubes();
    const double cubes = 8000 - 8 - 216 + 64 - 8 + 8;
    for (const auto& [metres, unit] : {std::pair{0.001, "\"millimeter\""},
                                       {0.01, "\"centimeter\""},
                                       {1.0, "\"meter\""},
                                       {0.0254, "\"inch\""},
                                       {0.3048, "\"foot\""},
                                       {1e-6, "\"micron\""},
                                       {1e-10, "\"millimeter\""}}) {
        const std::string bytes = writtenThreeMf(mesh, metres);
        EXPECT_THAT(modelOf(bytes), HasSubstr(std::string("<model unit=") + unit));
        const PolygonSoup soup = readThreeMf(bytes, "file");
        EXPECT_EQ(soup.faceCount(), mesh.triangles.size());
        EXPECT_EQ(soup.points.size(), mesh.points.size());
        const double mm = 1000 * metres;
        EXPECT_NEAR(sixVolumes(soup) / 6 / (mm * mm * mm) / cubes, 1, 1e-6) << unit;
    }
    EXPECT_EQ(writtenThreeMf(mesh), writtenThreeMf(mesh));
}

TEST(ThreeMf, KeepsEveryDigitThatFloat32HasNot) {
    TriangleMesh far;
    addCube(far, 0.5, {1e6 + 0.3, 0, 0});
    const PolygonSoup soup = readThreeMf(writtenThreeMf(far), "file");
    ASSERT_EQ(soup.faceCount(), far.triangles.size());
    for (std::size_t c = 0; c < soup.corners.size(); ++c)
        EXPECT_EQ(soup.points[soup.corners[c]], far.points[far.triangles[c / 3][c % 3]]);
}

TEST(Vtp, ReadsBackAsItWasWritten) {
    const TriangleMesh mesh = cubesInCubes();
    const auto write = [](Sink& sink, const MeshView& view) { writeVtp(sink, view); };
    const PolygonSoup soup = readVtp(written(mesh, write), "file");
    EXPECT_TRUE(soup.float32);
    EXPECT_EQ(soup.points, mesh.points);
    EXPECT_EQ(soup.corners, std::vector<std::uint32_t>(&mesh.triangles[0][0],
                                                       &mesh.triangles[0][0] + 3 * mesh.triangles.size()));
    EXPECT_EQ(soup.droppedNote(), "");
    TriangleMesh far;
    addCube(far, 0.5, {1e6 + 0.3, 0, 0});
    const PolygonSoup wide = readVtp(written(far, write), "file");
    EXPECT_FALSE(wide.float32);
    EXPECT_EQ(wide.points, far.points);
}

}  // namespace
}  // namespace isowave
