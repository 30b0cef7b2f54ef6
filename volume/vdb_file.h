// Grids to and from .vdb files, so that a short or damaged file is an InputError and a full disk leaves nothing.
#pragma once

#include <filesystem>
#include <string>

#include "volume/field.h"

namespace isowave {

struct VdbContent {
    openvdb::GridPtrVec grids;
    openvdb::MetaMap::Ptr metadata;
};

// Reads everything. Throws InputError: missing, empty, not a .vdb, truncated, damaged.
VdbContent readVdb(const std::filesystem::path& path);

// Temporary name, then rename. Throws OperationError.
void writeVdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
              const openvdb::MetaMap& metadata = {});

// The field as one FloatGrid named "field" (control points; metadata isowave:K), for vdb tools, Houdini, Blender.
void writeField(const std::filesystem::path& path, const BSplineField& field);

}  // namespace isowave
