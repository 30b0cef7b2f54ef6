// A GLB's colours by another range: those of a ladder's files are one, which is known when the last of them is measured.
#pragma once

#include <filesystem>

namespace isowave {

// Writes a file of writeMesh() anew, with the bytes that it would have had with this MeshWriteOptions::distanceRange. Whole in
// memory once. range: world units, 0 where no point has moved. Throws OperationError; InputError where it cannot be read.
// REQUIRES: written with distances, or without triangles.
void recolourGlb(const std::filesystem::path& path, double range);

}  // namespace isowave
