// What ITK's readers hide, read from the headers themselves before ITK reads the file, and what the checks of
// NRRD, MetaImage and NIfTI share.
//
// NrrdIO, MetaIO, libtiff and the NIfTI library fill what is missing with zeros, take absolute values,
// allocate whatever a header asks for, abort, or print to the terminal. Each check reads its header just far
// enough to know how many bytes of voxels it promises and whether the file holds them. What it does not
// understand is left to ITK.
//
// checkNrrd(), checkMetaImage(), checkNifti() throw InputError for sizes whose product overflows, voxels that
// the file does not hold, a data file that is missing, axes without length or that hold infinities.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/image/plain.h"
#include "io/image/source.h"

namespace isowave::imageio {

struct HeaderFacts {
    std::vector<std::int64_t>
        size;  // of every axis that the file states, the range axis of a vector image too
    std::optional<ValueType> storedType;
    std::optional<bool> integral;
    double slope = 1, intercept = 0;                  // values = slope * stored + intercept
    bool onePiece = true;                             // cannot be read a few slices at a time
    std::optional<PlainData> plain;                   // where one file holds the voxels as they are
    std::optional<std::array<double, 3>> badSpacing;  // as written, when an entry is <= 0 or not finite
};

std::string trimmed(const std::string& text);

// The whole numbers of a line; throws InputError when there is anything else in it.
std::vector<std::int64_t> wholeNumbers(const std::string& file, const std::string& key,
                                       const std::string& text);

// Numbers as strtod takes them (nan and inf too); anything else ends the list.
std::vector<double> numbers(const std::string& text);

// The first megabyte: headers are a few kB.
std::string headerFileText(const std::filesystem::path& path);

std::string sizesText(const std::vector<std::int64_t>& size);

// The first three spacings, when one of them is not a positive number. nanIsUnknown: nan means that the file
// does not say.
std::optional<std::array<double, 3>> badAmong(const std::vector<double>& spacing, bool nanIsUnknown);

// Throws InputError unless the file holds `needed` bytes from byte `start` on. promise: "'sizes' says 4 x 3 x
// 2".
void checkPlain(const std::filesystem::path& path, std::int64_t start, std::int64_t needed,
                const std::string& promise);

// The same for a zlib or gzip stream that begins there; its end and checksum must be there too.
void checkDeflated(const std::filesystem::path& path, std::int64_t start, std::int64_t needed,
                   const std::string& promise);

// Throws InputError unless `data`, which `header` names, is a file.
void requireFile(const std::filesystem::path& header, const std::filesystem::path& data);

}  // namespace isowave::imageio
