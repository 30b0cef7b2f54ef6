// The skeleton of a DICOM file, before GDCM sees it: elements of tag, VR, length and value (DICOM PS3.5
// section 7).
//
// GDCM as Debian builds it has its assertions on. They end the program over a file meta information that is
// damaged and over a data set that breaks off, so both are looked for here: every value must end within the
// file, and delimiters stand only where something is to be delimited. What else is odd is left to GDCM, which
// knows the habits of many scanners.
#include "io/image/dicom_check.h"

#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <set>

#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kUndefined = 0xFFFFFFFF;
constexpr std::uint32_t kPixelData = 0x7FE00010, kItem = 0xFFFEE000, kItemEnd = 0xFFFEE00D,
                        kSequenceEnd = 0xFFFEE0DD;

bool hasLongLength(const std::string& vr) {  // 2 reserved bytes and 4 of length, instead of 2 of length
    static const std::set<std::string> vrs = {"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                              "SV", "UC", "UN", "UR", "UT", "UV"};
    return vrs.contains(vr);
}

bool isKnown(const std::string& vr) {
    static const std::set<std::string> vrs = {"AE", "AS", "AT", "CS", "DA", "DS", "DT",
                                              "FD", "FL", "IS", "LO", "LT", "PN", "SH",
                                              "SL", "SS", "ST", "TM", "UI", "UL", "US"};
    return vrs.contains(vr) || hasLongLength(vr);
}

struct Encoding {
    bool explicitVr = true, bigEndian = false;
};

struct Element {
    std::uint32_t tag = 0;
    std::string vr;
    std::int64_t value = 0, length = 0;  // where the value begins; its length or kUndefined
    bool known = true;                   // false: no VR that DICOM knows, so the length is anybody's guess
    bool delimiter() const { return tag == kItemEnd || tag == kSequenceEnd; }
};

// Thrown inside the walk when the file is odd in a way that GDCM may understand.
struct LeaveToGdcm {};

class Walk {
  public:
    explicit Walk(const fs::path& path)
        : path_(path),
          file_(path, std::ios::binary),
          length_(static_cast<std::int64_t>(fs::file_size(path))) {}

    void run() {
        char magic[132] = {};
        file_.read(magic, sizeof magic);
        if (!file_ || std::memcmp(magic + 128, "DICM", 4) != 0) return;  // no preamble: GDCM guesses
        try {
            dataSet(metaInformation());
        } catch (const LeaveToGdcm&) {
        }
    }

  private:
    [[noreturn]] void refuse(const std::string& what, std::int64_t at) const {
        throw InputError(path_.string(),
                         fmt::format("{} at byte {} of {}; it is truncated or damaged", what, at, length_));
    }

    std::uint32_t number(const unsigned char* bytes, int count, bool bigEndian) const {
        std::uint32_t value = 0;
        for (int i = 0; i < count; ++i) value = value << 8 | bytes[bigEndian ? i : count - 1 - i];
        return value;
    }

    Element elementAt(std::int64_t at, const Encoding& encoding) {
        unsigned char head[12] = {};
        file_.clear();
        file_.seekg(at);
        file_.read(reinterpret_cast<char*>(head), 12);
        const auto got = file_.gcount();
        if (got < 8) refuse("its data set breaks off", at);
        Element element;
        element.tag = number(head, 2, encoding.bigEndian) << 16 | number(head + 2, 2, encoding.bigEndian);
        const bool framed = element.tag >> 16 == 0xFFFE;  // items and delimiters have no VR
        if (!encoding.explicitVr || framed) {
            element.length = number(head + 4, 4, encoding.bigEndian);
            element.value = at + 8;
            return element;
        }
        element.vr.assign(reinterpret_cast<const char*>(head) + 4, 2);
        element.known = isKnown(element.vr);
        if (hasLongLength(element.vr)) {
            if (got < 12) refuse("its data set breaks off", at);
            element.length = number(head + 8, 4, encoding.bigEndian);
            element.value = at + 12;
        } else {
            element.length = number(head + 6, 2, encoding.bigEndian);
            element.value = at + 8;
        }
        return element;
    }

    // Group 0002: explicit, little-endian, nothing nested. Returns where the data set begins; sets its
    // encoding.
    std::int64_t metaInformation() {
        std::string syntax;
        std::int64_t at = 132;
        for (;;) {
            const Element element = elementAt(at, {});
            if (element.tag >> 16 != 2) break;
            if (!element.known || element.vr == "SQ" || element.length > length_ - element.value)
                refuse("its file meta information is wrong", at);
            if (element.tag == 0x00020010) syntax = textAt(element);
            at = element.value + element.length;
        }
        if (syntax == "1.2.840.10008.1.2.1.99" || syntax.empty()) throw LeaveToGdcm{};  // deflated
        encoding_.explicitVr = syntax != "1.2.840.10008.1.2";
        encoding_.bigEndian = syntax == "1.2.840.10008.1.2.2";
        return at;
    }

    std::string textAt(const Element& element) {
        std::string text(static_cast<std::size_t>(element.length), '\0');
        file_.clear();
        file_.seekg(element.value);
        file_.read(text.data(), static_cast<std::streamsize>(text.size()));
        while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
        return text;
    }

    // To the pixels, which are the last thing that is needed.
    void dataSet(std::int64_t at) {
        while (at < length_) {
            const Element element = elementAt(at, encoding_);
            if (element.delimiter() || element.tag == kItem) refuse("a delimiter delimits nothing", at);
            at = afterValue(element, encoding_, length_, at, 0);
            if (element.tag == kPixelData) return;
        }
    }

    // Where the element that began at `at` ends. invariant: no farther than `end`, which the file holds.
    std::int64_t afterValue(const Element& element, const Encoding& encoding, std::int64_t end,
                            std::int64_t at, int depth) {
        if (!element.known) throw LeaveToGdcm{};
        if (element.length != kUndefined) {
            if (element.length > end - element.value)
                refuse(fmt::format("the value of ({:04x},{:04x}), {} bytes, does not end", element.tag >> 16,
                                   element.tag & 0xFFFF, element.length),
                       at);
            return element.value + element.length;
        }
        if (element.tag == kPixelData) return afterFragments(element.value);
        // Of unknown length and VR: a sequence, whose inside is implicit (PS3.5 section 6.2.2).
        return afterItems(element.value, element.vr == "UN" ? Encoding{false, false} : encoding, end,
                          depth + 1);
    }

    // Items up to the end mark of a sequence of undefined length.
    std::int64_t afterItems(std::int64_t at, const Encoding& encoding, std::int64_t end, int depth) {
        constexpr int kDeepest = 64;
        if (depth > kDeepest) refuse("sequences are nested too deep", at);
        for (;;) {
            const Element item = elementAt(at, encoding);
            if (item.tag == kSequenceEnd) return item.value;
            if (item.tag != kItem) throw LeaveToGdcm{};
            if (item.length != kUndefined) {
                at = afterValue(item, encoding, end, at, depth);
                continue;
            }
            for (at = item.value;;) {
                const Element element = elementAt(at, encoding);
                if (element.tag == kItemEnd) {
                    at = element.value;
                    break;
                }
                at = afterValue(element, encoding, end, at, depth);
            }
        }
    }

    // The pieces of a compressed image: items of known length, then the end mark.
    std::int64_t afterFragments(std::int64_t at) {
        for (;;) {
            const Element item = elementAt(at, encoding_);
            if (item.tag == kSequenceEnd) return item.value;
            if (item.tag != kItem || item.length == kUndefined) refuse("its compressed pixels are wrong", at);
            at = afterValue(item, encoding_, length_, at, 0);
        }
    }

    fs::path path_;
    std::ifstream file_;
    std::int64_t length_;
    Encoding encoding_;
};

}  // namespace

void checkDicom(const fs::path& path) { Walk(path).run(); }

}  // namespace isowave::imageio
