// The elements of a DICOM file (PS3.5 section 7, PS3.10), read by ourselves: with and without preamble and file
// meta information, implicit and explicit VR, either byte order, deflated.
//
// Values are kept for the elements of tags.h alone, at every level of nesting; all others are stepped over. Pixels stay
// in the file: only their place is noted. GDCM, whose assertions end the program over a damaged file, has no part in
// this.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/image/dicom/bytes.h"
#include "io/image/dicom/tags.h"

namespace isowave::imageio {

class DicomSet {
  public:
    bool has(const DicomTag& tag) const { return elements_.contains(tag.number); }
    // Without padding; "" where the element is absent or empty.
    std::string text(const DicomTag& tag) const;
    // Numbers of a text VR (DS, IS) or a binary one. Empty where the element is absent or empty. Throws InputError,
    // which names file and tag, for text that is no number and for binary values that break off.
    std::vector<double> numbers(const DicomTag& tag) const;
    // The first number.
    std::optional<double> number(const DicomTag& tag) const;
    double number(const DicomTag& tag, double otherwise) const;
    // The items of a sequence; empty where it is absent.
    const std::vector<DicomSet>& items(const DicomTag& tag) const;
    // The first item, or nullptr.
    const DicomSet* item(const DicomTag& tag) const;

  private:
    friend class DicomWalk;
    struct Element {
        std::string value;
        std::vector<DicomSet> items;
    };
    std::map<std::uint32_t, Element> elements_;
    bool bigEndian_ = false;
    std::shared_ptr<const std::string> file_;  // for messages
};

// Where a value lies in DicomBytes.
struct DicomRange {
    std::int64_t start = 0, length = 0;
};

struct DicomFile {
    std::filesystem::path path;
    DicomSet set;
    std::string syntax;  // TransferSyntaxUID; "" where the file does not say
    bool bigEndian = false;
    // The pixels: their element (0: none), where they lie, and the pieces of compressed ones without the table of
    // offsets, which is `offsets`.
    std::uint32_t pixelTag = 0;
    std::string pixelVr;
    DicomRange pixels;
    bool encapsulated = false;
    std::vector<DicomRange> fragments;
    std::vector<std::int64_t> offsets;
    // What is wrong with its data set, when that broke off before the pixels.
    std::string problem;
};

// Whether a file begins as a DICOM file does: "DICM" behind a preamble, or elements of group 0002 or 0008.
bool looksLikeDicom(const std::filesystem::path& path);

// REQUIRES: looksLikeDicom(path). Throws InputError when the file cannot be read; damage is in `problem`.
DicomFile readDicomFile(const std::filesystem::path& path);

// The bytes that DicomRange speaks of.
DicomBytes openDicomBytes(const std::filesystem::path& path);

}  // namespace isowave::imageio
