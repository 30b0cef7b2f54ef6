// What users have today to make a mesh of fewer triangles out of one of many.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "isowave/mesh.h"

namespace isowave::bench {

struct Rival {
    std::string name;
    // A closed mesh -> one of about so many triangles.
    std::function<TriangleMesh(const TriangleMesh&, std::int64_t)> decimate;
};

// CGAL's edge collapse after Lindstrom and Turk, and after Garland and Heckbert; meshoptimizer and VTK where they are
// installed.
std::vector<Rival> decimators();

#ifdef ISOWAVE_WITH_VTK
TriangleMesh vtkQuadric(const TriangleMesh& mesh, std::int64_t triangles);  // vtk_decimate.cpp
TriangleMesh vtkPro(const TriangleMesh& mesh, std::int64_t triangles);
#endif

}  // namespace isowave::bench
