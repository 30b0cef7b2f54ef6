// Meshes of solids as files, written to memory and read again.
#pragma once

#include "isowave/mesh.h"
#include "tests/fuzz/bytes.h"

namespace isowave::fuzz {

// How the files of a ladder are written.
struct Writing {
    explicit Writing(Bytes& bytes);

    Space space = Space::unspecified;
    double metresPerUnit = 0.001;
    float farthest = 0;  // of the made-up distances to level 0; 0: there are none
};

// VTP, 3MF and GLB are read again as the triangles that they were, at the places that they were to float32, or exactly where the
// writer takes float64; VTP and 3MF name the space. Triangles of 3MF come part by part. REQUIRES: a closed mesh with normals.
void requireWritten(const TriangleMesh& mesh, const Writing& how);

}  // namespace isowave::fuzz
