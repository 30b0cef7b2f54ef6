// Grids to and from .vdb files, so that a short or damaged file is an InputError and a full disk leaves
// nothing.
//
// Three promises beyond openvdb::io::File:
// (1) The bytes are a function of the grids and the metadata alone. OpenVDB puts a random UUID into each header;
//     here it is a hash of the rest of the file.
// (2) Every truncation is found, and every change of a byte in a file that writeVdb() wrote.
// (3) The values come back to the bit, inactive ones too.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "volume/field.h"

namespace isowave {

struct VdbContent {
    openvdb::GridPtrVec grids;
    openvdb::MetaMap::Ptr metadata;
};

// Reads everything. Throws InputError: missing, empty, a folder, not a .vdb, truncated, damaged.
VdbContent readVdb(const std::filesystem::path& path);

// Temporary name, then rename. Throws OperationError. Blosc-compressed where OpenVDB has Blosc; single grids
// can be read by openvdb::io::File, and vdb_print lists them.
void writeVdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
              const openvdb::MetaMap& metadata = {});

// The field as one FloatGrid named "field" (control points; metadata isowave:K), for vdb tools, Houdini,
// Blender.
void writeField(const std::filesystem::path& path, const BSplineField& field);

// The level set of a .vdb as float: the grid called `gridName`, or the only one that is a level set, which is
// a float or double grid whose class says so or, where the class says nothing, whose values have both signs
// under a positive background. Throws InputError that lists the grids when there is none or more than one.
openvdb::FloatGrid::Ptr readLevelSet(const std::filesystem::path& path,
                                     const std::optional<std::string>& gridName = {});

}  // namespace isowave
