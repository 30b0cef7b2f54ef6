// Grids to and from .vdb files, so that a short or damaged file is an InputError and a full disk leaves
// nothing.
//
// Three promises beyond openvdb::io::File:
// (1) The bytes are a function of the grids and the metadata alone. OpenVDB puts a random UUID into each
// header;
//     here it is a hash of the rest of the file.
// (2) Every truncation is found, and every change of a byte in a file that writeVdb() wrote.
// (3) The values come back to the bit, inactive ones too.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "volume/field.h"
#include "volume/foreign/foreign_vdb.h"

namespace isowave {

// Reads everything; what another program wrote, in a child process (volume/foreign/foreign_vdb.h). Throws InputError:
// missing, empty, a folder, not a .vdb, truncated, damaged.
VdbContent readVdb(const std::filesystem::path& path);

// The grids of a file, read one by one as they are asked for. A file that writeVdb() wrote has a hash of each
// of its parts, so that promise (2) holds for what is read and nobody looks at the rest; any other file is
// read whole.
class VdbParts {
  public:
    // Reads the metadata and where each grid lies. Throws as readVdb() does.
    explicit VdbParts(const std::filesystem::path& path);
    ~VdbParts();
    VdbParts(const VdbParts&) = delete;
    VdbParts& operator=(const VdbParts&) = delete;

    const openvdb::MetaMap& metadata() const;
    // The grids of these names, by several threads; null where there is none of that name. Throws InputError
    // where one is damaged.
    std::vector<openvdb::GridBase::Ptr> read(const std::vector<std::string>& gridNames);
    // Bytes of the file that were looked at so far.
    std::int64_t bytesRead() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// Temporary name, then rename. Throws OperationError. Active values and masks, neither Blosc nor zip (files
// with either are read); single grids can be read by openvdb::io::File, and vdb_print lists them. By several
// threads; beyond the grids it takes 16 MB at most, whatever their size.
void writeVdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
              const openvdb::MetaMap& metadata = {});
// The same for what is read again soon: nobody waits for the disk. After a power cut readers find the file damaged.
void writeVdbForNow(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
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
