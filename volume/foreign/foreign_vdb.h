// .vdb files of other programs, which nothing vouches for.
//
// OpenVDB believes what a file says: lengths are allocated, and io::bloscFromStream() reads as many bytes as it is told
// into a buffer of another size. One changed byte is a crash or an allocation of 20 GB. So a child process parses the
// file, with limits of memory and time (base/forked_child.h), and writes the grids that it got, uncompressed, into
// memory that both share. This process parses only what OpenVDB wrote there from whole trees.
//
// Cost: for a level set of 6.8 million active voxels (27 MB) `isowave info` takes 0.28 s of processor time instead of 0.17.
#pragma once

#include <optional>
#include <string>

#include "base/file_bytes.h"
#include "volume/vdb.h"

namespace isowave {

struct VdbContent {
    openvdb::GridPtrVec grids;
    openvdb::MetaMap::Ptr metadata;
};

// Reads everything. Values come back to the bit, inactive ones too. Throws InputError: truncated, damaged, in need of more
// than 512 MB and 16 times the file's size, or of more than 20 s and a second for every 10 MB of it.
// REQUIRES: initializeVdb() was called, and the file begins as a .vdb does.
VdbContent readForeignVdb(const std::string& name, const FileBytes& file);

// The value of a file's metadatum of type "string", without OpenVDB: nothing is allocated that the file does not hold.
// Nothing where the file is no .vdb of version 222 (OpenVDB 3, 2013) or later, or has no such metadatum.
std::optional<std::string> vdbStringMetadatum(const FileBytes& file, const std::string& name);

}  // namespace isowave
