// Polygon meshes: what is wrong with them, who is next to whom, and their files.
#include "subdivision/meshes/mesh_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "isowave/error.h"
#include "tests/subdivision/mesh_zoo.h"
#include "tests/temp_folder.h"

namespace isowave::subdivision {
namespace {

using namespace mesh_zoo;
using isowave::test::TempFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr MeshFormat kFormats[] = {MeshFormat::obj, MeshFormat::off, MeshFormat::ply};

PolygonMesh with(PolygonMesh mesh, const std::function<void(PolygonMesh&)>& change) {
    change(mesh);
    return mesh;
}

TEST(PolygonMesh, OfTheZooHasNoDefects) {
    for (const auto& [name, mesh] : all()) EXPECT_THAT(defects(mesh), IsEmpty()) << name;
}

TEST(PolygonMesh, HasALineForEveryDefect) {
    const struct {
        PolygonMesh mesh;
        const char* says;
    } cases[] = {
        {PolygonMesh{}, "holds no face"},
        {with(cube(), [](auto& m) { m.corners[5] = 8; }), "face 1, which names vertex 8 of 8"},
        {with(cube(), [](auto& m) { m.points[3].y = NAN; }), "the first is vertex 3"},
        {with(cube(), [](auto& m) { m.corners[1] = m.corners[0]; }), "1 face is degenerate"},
        {with(cube(),
              [](auto& m) {
                  m.addFace({0, 1});
              }),
         "the first is face 6, with vertices 0 1"},
        {with(cube(),
              [](auto& m) {
                  m.addFace({0, 1, 2, 3, 4, 5, 6, 7, 0});
              }),
         "with vertices 0 1 2 3 4 5 6 7 .. (9 in all); remove it"},
        {with(cube(),
              [](auto& m) {
                  m.addFace({0, 1, 6});
              }),
         "more than two faces (not a 2-manifold); the first is between vertices 0 and 1, with 3"},
        {with(cube(), [](auto& m) { std::swap(m.corners[0], m.corners[2]); }),
         "mixed orientation: the two faces of 4 edges"},
        {with(together(cube(), cube(), {2, 2, 2}),
              [](auto& m) {
                  for (Index& v : m.corners)
                      if (v == 8) v = 6;
                  for (Index& v : m.corners)
                      if (v > 8) --v;
                  m.points.erase(m.points.begin() + 8);
              }),
         "the first is vertex 6, whose 6 faces form more than one fan"},
        {with(cube(),
              [](auto& m) {
                  m.points.push_back({9, 9, 9});
              }),
         "1 vertex is in no face; the first is vertex 8"},
        {with(cube(),
              [](auto& m) {
                  m.creases.push_back({0, 6, 1});
              }),
         "the first is between vertices 0 and 6"},
        {with(cube(), [](auto& m) { m.pinned.push_back(8); }), "the first is 8 of 8"},
    };
    for (const auto& each : cases) {
        const auto lines = defects(each.mesh);
        ASSERT_FALSE(lines.empty()) << each.says;
        EXPECT_THAT(lines.front(), HasSubstr(each.says));
        EXPECT_THAT(lines.front(), testing::Not(HasSubstr("\n")));
        EXPECT_THROW(requireManifold(each.mesh, "m.obj"), InputError);
    }
}

TEST(Adjacency, KnowsWhoIsNextToWhom) {
    for (const auto& [name, mesh] : all()) {
        const Adjacency a(mesh);
        std::vector<std::size_t> faces(mesh.vertexCount(), 0);
        for (const Index v : mesh.corners) ++faces[v];
        std::set<std::pair<Index, Index>> edges;
        for (Index c = 0; c < a.corners(); ++c) {
            edges.insert(std::minmax(a.vertex(c), a.target(c)));
            EXPECT_EQ(a.next(a.prev(c)), c);
            if (a.twin(c) == kNone) continue;
            EXPECT_EQ(a.twin(a.twin(c)), c);
            EXPECT_EQ(a.vertex(a.twin(c)), a.target(c)) << name;
            EXPECT_EQ(a.edge(a.twin(c)), a.edge(c));
        }
        EXPECT_EQ(a.edges(), edges.size()) << name;
        for (Index v = 0; v < a.vertices(); ++v) {
            EXPECT_EQ(a.faceValence(v), faces[v]) << name;
            a.around(v, [&](Index c) { EXPECT_EQ(a.vertex(c), v); });
        }
        for (Index e = 1; e < a.edges(); ++e) EXPECT_LT(a.edgeCorner(e - 1), a.edgeCorner(e));
    }
}

TEST(Adjacency, MatchesMeshesInAnotherOrder) {
    for (const auto& [name, mesh] : all()) {
        const PolygonMesh other = shuffled(mesh, 3);
        // Seeds: every corner with its twin in the other mesh, found by the points.
        const Adjacency a(mesh), b(other);
        std::vector<CornerPair> seeds;
        for (Index c = 0; c < a.corners(); ++c)
            for (Index d = 0; d < b.corners(); ++d)
                if (mesh.points[a.vertex(c)] == other.points[b.vertex(d)] &&
                    mesh.points[a.target(c)] == other.points[b.target(d)])
                    seeds.push_back({c, d});
        ASSERT_EQ(seeds.size(), a.corners()) << name;
        const auto of = correspondingCorners(a, b, seeds);
        ASSERT_EQ(of.size(), a.corners()) << name;
        for (const auto& seed : seeds) EXPECT_EQ(of[seed.a], seed.b) << name;
        // A wrong seed is found out, unless the mesh looks the same from there.
        seeds[0].b = b.next(seeds[0].b);
        EXPECT_THAT(correspondingCorners(a, b, seeds), IsEmpty()) << name;
    }
}

TEST(PolygonMesh, FindsFoldedEdges) {
    const Adjacency adjacency(cube());
    EXPECT_EQ(creasesByAngle(cube(), adjacency, 89).size(), 12u);
    EXPECT_EQ(creasesByAngle(cube(), adjacency, 91).size(), 0u);
}

// ---- files ----

TEST(MeshFiles, KeepEveryDigitAndEveryMark) {
    for (const auto& shape : all()) {
        PolygonMesh mesh = shape.mesh;
        Random random(17);
        for (Vec3& p : mesh.points) p = {random() * 1e-7, random() * 1e9, random() / 3};
        mesh.creases.push_back({mesh.corners[0], mesh.corners[1], 0.1});
        mesh.pinned.push_back(mesh.corners[2]);
        for (const auto format : kFormats) {
            const PolygonMesh back = parsePolygonMesh(polygonMeshBytes(mesh, format), format, shape.name);
            EXPECT_EQ(back.points, mesh.points) << shape.name;
            EXPECT_EQ(back.corners, mesh.corners) << shape.name;
            EXPECT_EQ(back.faceBegin, mesh.faceBegin) << shape.name;
            EXPECT_EQ(back.creases, mesh.creases) << shape.name;
            EXPECT_EQ(back.pinned, mesh.pinned) << shape.name;
        }
    }
}

TEST(MeshFiles, ReadWhatOthersWrite) {
    const auto obj = parsePolygonMesh(
        "# x\no thing\nv +0 0 0 1\r\nv 1e0 0 0\nvt 0 0\nv 1 1 0\nvn 0 0 1\nusemtl m\n"
        "f 1/1/1 2//1 -1 # end\nt interpolateboundary 1/0/0 2\nt crease 2/1/0 0 1 6.0\n",
        MeshFormat::obj, "a.obj");
    EXPECT_THAT(obj.corners, ElementsAre(0, 1, 2));
    EXPECT_EQ(obj.creases.size(), 1u);
    for (const char* text : {"OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n",
                             "OFF 3 1 0\n# c\n\n0 0 0\n1 0 0\n1 1 0 9 9 9\n3 0 1 2 255 0 0\n",
                             "COFF\n3 1 3\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n1 1 0 1 1 1 1\n3 0 1 2"})
        EXPECT_THAT(parsePolygonMesh(text, MeshFormat::off, "a.off").corners, ElementsAre(0, 1, 2));
    const std::string ascii =
        "ply\nformat ascii 1.0\ncomment t crease 2/1/0 1 2 3\nelement vertex 3\nproperty float y\nproperty "
        "float x\nproperty uchar red\n"
        "property float z\nelement extra 1\nproperty list uchar int w\nelement face 1\nproperty uchar flag\n"
        "property list uchar int vertex_index\nend_header\n0 0 7 0\n0 1 7 0\n1 1 7 0\n2 5 6\n1 3 0 1 2\n";
    const auto ply = parsePolygonMesh(ascii, MeshFormat::ply, "a.ply");
    EXPECT_THAT(ply.corners, ElementsAre(0, 1, 2));
    EXPECT_EQ(ply.points[1], (Vec3{1, 0, 0}));
    EXPECT_EQ(ply.creases.size(), 1u);
    std::string big =
        "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty short x\nproperty short y\nproperty "
        "short z\n"
        "element face 1\nproperty list uchar short vertex_indices\nend_header\n";
    for (const int c : {0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 3, 0, 0, 0, 1, 0, 2})
        big += char(c);
    EXPECT_EQ(parsePolygonMesh(big, MeshFormat::ply, "b.ply").points[1], (Vec3{256, 0, 0}));
}

std::string complaint(const std::string& bytes, MeshFormat format) {
    try {
        const PolygonMesh mesh = parsePolygonMesh(bytes, format, "m");
        requireManifold(mesh, "m");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

// The words of io/mesh: tests/io/mesh has more of them.
TEST(MeshFiles, SayWhichLineIsWrong) {
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    EXPECT_EQ(complaint("v 0 0 0\nv 1 0 x\n", MeshFormat::obj), "m: line 2: 'x' is not a number");
    EXPECT_THAT(complaint("v 0 0\n", MeshFormat::obj), HasSubstr("line 1: a point needs three coordinates"));
    EXPECT_THAT(complaint("v 0 0 0\nf 1 0 2\n", MeshFormat::obj),
                HasSubstr("line 2: a face refers to point 0"));
    EXPECT_THAT(complaint("v 0 0 0\nf 1 -2 1\n", MeshFormat::obj),
                HasSubstr("a face refers to point -2, but only 1 points come before"));
    EXPECT_THAT(complaint(triangle + "t crease 1 2 3\n", MeshFormat::obj),
                HasSubstr("line 5: 't crease 1' does not count its values as 2/1/0"));
    EXPECT_THAT(complaint(triangle + "t corner 1/1/0 1\n", MeshFormat::obj),
                HasSubstr("line 5: ends where a sharpness was expected"));
    EXPECT_THAT(complaint("hello\n", MeshFormat::off), HasSubstr("line 1: an OFF file starts with 'OFF'"));
    EXPECT_THAT(complaint("OFF BINARY\n", MeshFormat::off), HasSubstr("binary OFF is not read"));
    EXPECT_THAT(complaint("OFF\n3 1 0\n0 0 0\n", MeshFormat::off),
                HasSubstr("promises 3 points but the file ends after 1"));
    EXPECT_THAT(complaint("OFF\n1 1 0\n0 0 0\n3 0 0 -1\n", MeshFormat::off),
                HasSubstr("line 4: a face refers to point '-1'"));
    EXPECT_THAT(complaint("solid x\n", MeshFormat::ply), HasSubstr("no PLY"));
    EXPECT_THAT(complaint("ply\nformat text 1\nend_header\n", MeshFormat::ply),
                HasSubstr("unknown format 'text'"));
    EXPECT_THAT(complaint("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n",
                          MeshFormat::ply),
                HasSubstr("lack x, y or z"));
}

// Every truncation is refused, or (a text that ends between two lines, or within its last number) still a mesh.
TEST(MeshFiles, SurviveEveryTruncation) {
    for (const auto format : kFormats) {
        const std::string bytes = polygonMeshBytes(tetrahedron(), format);
        std::size_t refused = 0;
        for (std::size_t size = 0; size < bytes.size(); ++size) {
            const std::string part = bytes.substr(0, size);
            if (!complaint(std::string(part.data(), part.size()), format).empty()) ++refused;
        }
        EXPECT_GE(refused + 12, bytes.size());
        if (format == MeshFormat::ply) {
            EXPECT_EQ(refused, bytes.size());
        }
    }
}

TEST(MeshFiles, AppearWholeOrNotAtAll) {
    const TempFolder folder;
    writePolygonMesh(folder.path() / "a.PLY", cube());
    EXPECT_EQ(readPolygonMesh(folder.path() / "a.PLY").points, cube().points);
    EXPECT_THROW(writePolygonMesh(folder.path() / "none" / "a.obj", cube()), OperationError);
    EXPECT_THROW(writePolygonMesh(folder.path() / "a.stl", cube()), InputError);
    EXPECT_THROW(readPolygonMesh(folder.path() / "no.obj"), InputError);
}

}  // namespace
}  // namespace isowave::subdivision
