// What the readers of NRRD, MetaImage and NIfTI headers share: numbers and names in text, and whether files hold what
// a header promises.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace isowave::imageio {

std::string trimmed(const std::string& text);

// The whole numbers of a line; throws InputError when there is anything else in it.
std::vector<std::int64_t> wholeNumbers(const std::string& file, const std::string& key,
                                       const std::string& text);

// Numbers as strtod takes them (nan and inf too); anything else ends the list.
std::vector<double> numbers(const std::string& text);

// Whether a file begins as gzip does.
bool isGzip(const std::filesystem::path& path);

// The first bytes of a file, inflated if it is compressed by gzip; fewer where it ends, or is damaged, before.
std::string firstBytes(const std::filesystem::path& path, std::size_t count);

// Throws InputError where the first bytes of a gzip file cannot be inflated, or are gzip again: what reads the header would
// say only that it is none.
void checkGzipStart(const std::filesystem::path& path);

// The first megabyte, inflated if need be: headers are a few kB.
inline constexpr std::size_t kLongestHeader = 1 << 20;
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

// The names of "slice%03d.raw 1 90 2": numbers 1, 3, ... 89 in the place of %03d. Behind the pattern stand the first
// number, the last one and, if it is not 1, the step; what follows means nothing here. count: the last number, counted
// from 1, of a pattern without numbers. Throws InputError for a pattern that is none and for more than a million names.
std::vector<std::string> numberedNames(const std::string& file, const std::string& text,
                                       std::optional<std::int64_t> count);

// Throws InputError unless `data`, which `header` names, is a file.
void requireFile(const std::filesystem::path& header, const std::filesystem::path& data);

}  // namespace isowave::imageio
