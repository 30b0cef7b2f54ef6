// VTK's XML files (.vti, .vtp): their header and their data arrays.
//     https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html
//
// An array's numbers stand in the file as text, in base64, or behind an underscore in the element AppendedData, there as they
// are or in base64; any of the binary ones may be compressed in blocks by zlib.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/value_type.h"
#include "io/vtk/xml.h"

namespace isowave::vtk {

struct File {
    XmlDocument xml;
    bool bigEndian = false, longLengths = false;  // header_type: UInt64, not UInt32
    bool compressed = false;                      // by zlib
    bool base64Behind = false;                    // AppendedData
    std::size_t appended = 0;  // byte of the file behind the underscore; 0: nothing is appended
    const XmlElement& dataset() const { return *xml.root.child(kind); }
    std::string kind;  // "ImageData"
};

// bytes: the file, or its beginning as far as the element AppendedData; nothing where they end before. kind: what is expected.
// Throws InputError: no XML, no VTKFile, another kind, a compressor other than zlib.
std::optional<File> parse(std::string_view bytes, const std::string& name, const std::string& kind);

// One DataArray as its element describes it.
struct Array {
    std::string name;
    ValueType type = ValueType::uint8;
    std::int64_t components = 1;
    const XmlElement* element = nullptr;
};
// Throws InputError for text, bits and other types that are no numbers.
Array describe(const XmlElement& element, const std::string& name);

// Where the numbers lie in the file as they are, if they do: appended, neither in base64 nor compressed. The first of the two
// is where the length stands. bytes: the file.
std::optional<std::int64_t> plainStart(const File& file, const Array& array);

// The bytes of all the array's numbers, in this machine's order. bytes: the whole file. count: how many numbers it must hold.
// Throws InputError: another number, text that is no number of the type, base64 or zlib that is damaged, an end too early.
std::string decode(const File& file, const Array& array, std::string_view bytes, std::int64_t count,
                   const std::string& name);

}  // namespace isowave::vtk
