// What a mesh file says, whatever its format: points, polygons by index, and remarks. Values only, and no promise that the
// polygons make up a surface: readMesh and subdivision::readPolygonMesh check what they need and turn it into their meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "isowave/mesh.h"

namespace isowave {

// A line `t ...` of OBJ, or a comment `t ...` of OFF and PLY, as OpenSubdiv's regression shapes mark creases and corners.
struct MeshTag {
    std::string text;      // what follows the `t`: "crease 2/1/0 3 4 10"
    std::size_t line = 0;  // counted from 1
};

// What a file may hold besides, and isowave does not keep.
enum class Dropped {
    colours,
    textureCoordinates,
    normals,
    materials,
    groups,
    lines,
    animations,
    morphTargets,
    other
};

struct PolygonSoup {
    std::vector<Point> points;
    std::vector<std::uint32_t> corners;          // the point of each corner, polygon after polygon
    std::vector<std::uint32_t> faceBegin = {0};  // polygon f owns the corners [faceBegin[f], faceBegin[f+1])
    std::vector<MeshTag> tags;
    std::string format, space;  // as MeshFileInfo has them
    bool float32 = false;       // the coordinates are, or could be, stored in float32
    int digits = 0;             // of a text: the most significant digits of a coordinate
    unsigned dropped = 0;       // bit i: Dropped i is in the file

    std::size_t faceCount() const { return faceBegin.size() - 1; }
    std::size_t faceSize(std::size_t f) const { return faceBegin[f + 1] - faceBegin[f]; }
    void drop(Dropped what) { dropped |= 1u << static_cast<unsigned>(what); }
    // "colours, materials and groups are not kept"; empty where all is.
    std::string droppedNote() const;
    // The corners appended since the last call are a polygon.
    void endFace() { faceBegin.push_back(static_cast<std::uint32_t>(corners.size())); }
};

}  // namespace isowave
