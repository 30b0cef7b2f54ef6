// Points, vectors, lines through points, the mesh type of isowave (an indexed triangle mesh in world coordinates) and its
// files.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "isowave/progress.h"
#include "isowave/version.h"

namespace isowave {

// A vector in space, for code that calculates with it; meshes store Points.
struct Vec3 {
    double x = 0, y = 0, z = 0;

    double& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
    double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
    Vec3& operator+=(const Vec3& v) { return x += v.x, y += v.y, z += v.z, *this; }
    Vec3& operator-=(const Vec3& v) { return x -= v.x, y -= v.y, z -= v.z, *this; }
    Vec3& operator*=(double s) { return x *= s, y *= s, z *= s, *this; }
    friend Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
    friend Vec3 operator-(Vec3 a, const Vec3& b) { return a -= b; }
    friend Vec3 operator*(double s, Vec3 a) { return a *= s; }
    friend Vec3 operator*(Vec3 a, double s) { return a *= s; }
    friend Vec3 operator/(const Vec3& a, double s) { return {a.x / s, a.y / s, a.z / s}; }
    friend bool operator==(const Vec3&, const Vec3&) = default;
};
inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }

using Point = std::array<double, 3>;
using Triangle = std::array<std::uint32_t, 3>;

struct TriangleMesh {
    std::vector<Point> points;                  // world units (millimetres for images)
    std::vector<Triangle> triangles;            // counter-clockwise seen from outside
    std::vector<std::array<float, 3>> normals;  // one unit vector a point, pointing outside; or empty
};

// A line through points, as files of lines hold it and as the subdivision of curves works on it.
struct Polyline {
    int dimension = 2;                // 2 or 3
    bool closed = false;              // the last point is joined to the first, and is not its copy
    std::vector<double> coordinates;  // x y [z] of point 0, of point 1, ..

    std::size_t size() const { return coordinates.size() / static_cast<std::size_t>(dimension); }
};

// ---- reading ----

// What a mesh file says besides its polygons.
struct MeshFileInfo {
    std::string
        format;  // "binary STL", "ASCII STL", "OBJ", "ASCII PLY", "binary PLY", "OFF", "GLB", "VTP", "3MF"
    std::string space;  // the word after SPACE= in a comment, as 3D Slicer writes it: LPS, RAS; or empty
    std::int64_t polygons = 0;  // as listed, before they are cut into triangles
};

// Steps of the coordinates' number format that a mesh must be across to be read.
inline constexpr int kFewestSteps = 1024;

// STL (binary, text), OBJ, PLY (binary of either byte order, text), OFF (text), GLB (in mm, z up), VTP, 3MF (in mm); each also
// compressed by gzip, its format then told by the name without .gz. Concave polygons too become triangles without overlaps. Throws InputError: missing, truncated, malformed (with line), no triangles, a coordinate
// that is not finite (which point), coordinates beyond 1e15 or so far from the origin that fewer than
// kFewestSteps representable steps are left across the part. No repair beyond that: points as listed (STL corners merged
// by exact position). info: optional second result.
ISOWAVE_EXPORT TriangleMesh readMesh(const std::filesystem::path& path, MeshFileInfo* info = nullptr,
                                     const Progress& progress = {});

// Merges points with equal coordinates, as a reader of STL must. Points come in the order of their first appearance, with the
// normal of the first; triangles keep their number and order.
ISOWAVE_EXPORT TriangleMesh mergeEqualPoints(const TriangleMesh& mesh);

// Whether a path has a mesh file's extension: .stl .obj .ply .off .glb .vtp .3mf, in any case, and .gz behind it.
ISOWAVE_EXPORT bool isMeshPath(const std::filesystem::path& path);

// ---- writing ----

enum class MeshFormat { stl, ply, obj, off, glb, vtp, threeMf };

// By extension, case-insensitive. Throws InputError naming the formats for another one.
ISOWAVE_EXPORT MeshFormat meshFormatOf(const std::filesystem::path& path);
ISOWAVE_EXPORT MeshFormat meshFormatFromName(const std::string& name);
ISOWAVE_EXPORT const char* extensionOf(MeshFormat format);  // with the dot: ".stl"

// Which way a mesh's axes run where that has a meaning. In memory everything is LPS (x to the patient's left, y to the
// back, z to the head), as ITK and DICOM have it.
enum class Space {
    unspecified,  // a CAD mesh: coordinates as they are, nothing is said in files
    lps,          // SPACE=LPS in a comment of the file
    ras           // x and y negated in files (half a turn about z: orientation stays); SPACE=RAS
};

struct MeshWriteOptions {
    Space space = Space::unspecified;  // what to write; points of the mesh itself are LPS
    // glTF is metres, Y up: points are scaled by this and turned (x, z, -y). 3MF names the unit.
    double metresPerUnit = 0.001;
    // One a point, or none: how far it is from the surface of level 0, world units. PLY has the property distance_to_level0, VTP
    // the array of that name as its active scalars, GLB the attribute _DISTANCE_TO_LEVEL0 and colours in COLOR_0; the others go
    // without.
    std::vector<float> distanceToLevel0 = {};
    double distanceRange = 0;  // of the last colour of GLB, world units; 0: of the largest of these distances
};

// Written under a temporary name, then renamed: a failure leaves nothing behind. Throws OperationError.
//
// Numbers. OBJ and OFF print the shortest decimals that read back exactly. PLY, VTP and 3MF are float32, or float64 where
// float32 would move a point by more than 1e-4 of the mean edge or make two points one. STL and GLB have only
// float32. STL has no indices either: its readers merge corners by position, and two points that have become
// one would tear the manifold. So points stay apart:
//   points of different index are written with different coordinates (STL, GLB): of those that round to the
//   same float32 triple the first gets it, the others a free one near by, at most 2 float32 steps (at the
//   size of the mesh's largest coordinate) away on each axis. Where none is free, OperationError names the
//   format and recommends PLY. STL is also refused where the mesh is fewer than kFewestSteps float32 steps
//   across: a part 40 mm across 1 km from the origin, which readMesh would refuse.
//
// Normals. PLY nx ny nz, OBJ vn, GLB NORMAL, VTP's active normals; STL has its facets' normals. OFF goes without: many readers
// refuse the NOFF header, and 3MF has none. The comment SPACE=LPS or SPACE=RAS stands in STL's 80-byte header, as a comment in
// PLY, OBJ and OFF, in asset.extras.SPACE of GLB, as a comment in VTP, in the description of 3MF. REQUIRES: normals empty or one a point; indices below
// points.size().
ISOWAVE_EXPORT void writeMesh(const std::filesystem::path& path, const TriangleMesh& mesh, MeshFormat format,
                              const MeshWriteOptions& options = {});

}  // namespace isowave
