// What `isowave reverse` and `isowave rebuild` say: sizes, details and errors, as text and as JSON (docs/interfaces.md).
// Nothing here prints or writes.
#pragma once

#include <string>
#include <vector>

#include "subdivision/meshes/hierarchy_edit.h"

namespace isowave::subdivision {

struct DecompositionReport {
    struct Level {
        std::size_t vertices = 0, faces = 0;
        // Of the details that lead from this level to the next finer one; 0 at the finest.
        double detailRms = 0, detailLargest = 0;
        // Subdivided from here to the finest level without any details, against the mesh itself.
        PointError withoutDetails;
    };
    std::string scheme, variant;
    std::size_t creases = 0, pinned = 0;  // of the base
    double diagonal = 0;                  // of the mesh
    double roundTrip = 0;                 // largest distance after reconstruction
    std::vector<Level> levels;            // the base first
};
// `mesh` is what `hierarchy` was made from.
DecompositionReport reportDecomposition(const Hierarchy& hierarchy, const PolygonMesh& mesh,
                                        const Progress& progress = {});
std::string text(const DecompositionReport& report);
std::string json(const DecompositionReport& report);

struct RebuildReport {
    int levels = 0;
    std::size_t vertices = 0, faces = 0;
    std::size_t details = 0, kept = 0;  // of those levels; not 0
    double diagonal = 0;
    PointError error;  // what leaving details out has cost
    struct Share {
        double share;  // of the details, the longest
        std::size_t kept;
        PointError error;
    };
    std::vector<Share> shares;  // when a table was asked for
};
// The errors of the base with the longest 0, 1, 2, 5, 10, 20, 50 % of the details. `whole`: with all of them, in the
// order of reconstruct().
std::vector<RebuildReport::Share> errorByShare(const Hierarchy& hierarchy, const PolygonMesh& whole,
                                               const Progress& progress = {});
std::string text(const RebuildReport& report);
std::string json(const RebuildReport& report);

}  // namespace isowave::subdivision
