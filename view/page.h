// One self-contained html file that shows levels: opened from a disk or a mail, it asks nobody for anything.
//
//   Page page({.title = "part", .unit = "mm"});
//   page.add({.name = "L0", .step = 0}, level0);      // the reference: distances are to it
//   page.add({.name = "L1", .step = 3}, level1);
//   std::string html = page.html();
//
// The page holds three.js, the program in page/, a table, and of each level the streams of mesh_packing.h or of
// packedRings(), deflated, in base64. Strings that come from outside (names of files) are data in it and never markup.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "view/distances.h"
#include "view/text_bytes.h"

namespace isowave::view {

// A row of the page's table. What is not known stays empty, and its column is left out where no row has it.
struct LevelFacts {
    std::string name;  // "L2", "s5", "T20000", "part.stl"
    std::string file = {};
    std::optional<int> step = {};
    std::optional<double> voxel = {};  // longest side of one, world units
    std::optional<std::int64_t> triangles = {}, vertices = {}, components = {}, parts = {}, handles = {},
                                cavities = {}, faces = {};
    std::optional<bool> closed = {};
    std::optional<double> volume = {}, volumeError = {};  // world units^3; share
    std::optional<std::int64_t> rings = {}, holes = {}, points = {};
    std::optional<double> area = {};
    // To level 0. Where a report has said them, they are taken from it, and otherwise from the samples of distances.h.
    std::optional<double> rms = {}, max = {};
};

struct PageOptions {
    std::string title;
    std::string unit = {};   // "mm"; empty: lengths have none
    bool anatomical = false;  // x, y, z run to the left, to the back and up of a patient (LPS): the cube says L R A P S I
    bool yUp = true;          // of planar curves
    std::vector<std::string> notes = {};  // lines at the foot of the page
};

// Whether this build holds three.js; without it there are no pages.
bool canMakePages();
// Throws OperationError, one line, unless canMakePages().
void requirePages();

class Page {
  public:
    // REQUIRES: canMakePages().
    explicit Page(PageOptions options);
    ~Page();
    Page(const Page&) = delete;
    Page& operator=(const Page&) = delete;

    // The first one is the reference of the others' distances. Meshes or rings, not both.
    // Coordinates are rounded to 1/65535 (rings: 2^-24) of the longest side of the level's box.
    // REQUIRES: a triangle; finite points.
    void add(LevelFacts facts, const TriangleMesh& mesh, const Progress& progress = {});
    // REQUIRES: finite points.
    void add(LevelFacts facts, const Rings& rings);

    std::size_t levelCount() const;
    // The largest distance of a coordinate of the page from what was added, world units.
    double largestRounding() const;
    std::string html() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// Varints: the number of points of each ring, then of x and y in turn the zigzagged difference from the point before in
// steps; `low` and `step` as in PackedMesh.
struct PackedRings {
    Bytes bytes;
    std::int64_t rings = 0, points = 0;
    curves2d::Point low, high;
    double step = 1;
};
PackedRings packedRings(const Rings& rings);

}  // namespace isowave::view
