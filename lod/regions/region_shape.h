// FineRegion as it was asked for -> one that can be measured against: its mesh read, mended and closed.
#pragma once

#include <memory>
#include <string>
#include <variant>

#include "base/point_box.h"
#include "isowave/ladder.h"
#include "volume/mesh_nearest.h"

namespace isowave::lod {

// "0,0,0:10,20,30", "jaw.stl", "a mesh": what messages call it.
std::string textOf(const FineRegion& region);
// "1,2,3"
std::string textOf(const Point& point);

// "--fine" or "--adaptive", the first of them that is given; null: neither is.
const char* regionOptionOf(const LevelOptions& options);

// Throws UsageError for a tolerance that is not above 0, a box without extent, numbers that are not finite, levels below 0 or not below the last one asked
// for, and for options that do not go with regions. No file is read.
void checkRegions(const LevelOptions& options);

struct RegionShape {
    struct Closed {
        TriangleMesh mesh;
        bool evenOdd = false;  // MeshRepairReport
        std::shared_ptr<const TriangleHierarchy> nearest;
    };
    std::string name;  // "--fine 0,0,0:10,20,30"
    std::variant<FineRegion::Box, Closed> where;
    int level = 0;
    double within = 0;

    // Widened by `within`.
    PointBox bounds() const;
};

// A mesh, mended, of which it must be known what is in it. what: "region": for messages. Throws InputError for one that is
// open or cannot be read.
RegionShape::Closed closedMesh(const std::filesystem::path& path, const std::string& what,
                               const Progress& progress);
RegionShape::Closed closedMesh(TriangleMesh mesh, const std::string& what, const Progress& progress);

// The box has its lower corner first; the mesh is read, and closed. Throws InputError for a mesh that is open or cannot be read.
RegionShape regionShapeOf(const FineRegion& region, const Progress& progress);

}  // namespace isowave::lod
