// A path and the options -> which kind of input it is, and whether the options suit it.
#pragma once

#include <filesystem>

#include "isowave/solid.h"

namespace isowave::lod {

enum class InputKind { image, mesh, vdb, pyramid };

// By extension, by image.raw (headerless image) and, for .vdb, by what the file says that it is. Throws
// InputError for a missing file or a name that tells nothing.
InputKind kindOf(const std::filesystem::path& path, const SolidOptions& options);
// The same, and the options suit it. Throws UsageError for one that this kind of input does not have.
InputKind checkedKindOf(const std::filesystem::path& path, const SolidOptions& options);

}  // namespace isowave::lod
