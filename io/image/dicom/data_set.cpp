#include "io/image/dicom/data_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <set>

#include "base/text.h"
#include "io/image/check.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kUndefined = 0xFFFFFFFF;
constexpr std::uint32_t kItem = 0xFFFEE000, kItemEnd = 0xFFFEE00D, kSequenceEnd = 0xFFFEE0DD;
constexpr std::int64_t kLongestValue = 1 << 20;  // of an element that is kept
constexpr int kDeepest = 64;

std::string tagText(std::uint32_t tag) { return fmt::format("({:04x},{:04x})", tag >> 16, tag & 0xFFFF); }

const DicomTag* knownTag(std::uint32_t number) {
    static const std::map<std::uint32_t, const DicomTag*> tags = [] {
        std::map<std::uint32_t, const DicomTag*> result;
        for (const DicomTag* tag : tag::kAll) result[tag->number] = tag;
        return result;
    }();
    const auto found = tags.find(number);
    return found == tags.end() ? nullptr : found->second;
}

bool isSequence(std::uint32_t number) {
    const DicomTag* known = knownTag(number);
    return known && std::strcmp(known->vr, "SQ") == 0;
}

bool hasLongLength(std::string_view vr) {  // 2 reserved bytes and 4 of length, instead of 2 of length
    static const std::set<std::string_view> vrs = {"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                                   "SV", "UC", "UN", "UR", "UT", "UV"};
    return vrs.contains(vr);
}

bool isVr(std::string_view text) {
    return text.size() == 2 && text[0] >= 'A' && text[0] <= 'Z' && text[1] >= 'A' && text[1] <= 'Z';
}

std::uint64_t integerAt(std::string_view bytes, std::size_t at, std::size_t count, bool bigEndian) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i)
        value = value << 8 | static_cast<unsigned char>(bytes[at + (bigEndian ? i : count - 1 - i)]);
    return value;
}

}  // namespace

// ---- values

std::string DicomSet::text(const DicomTag& tag) const {
    const auto found = elements_.find(tag.number);
    if (found == elements_.end()) return "";
    std::string value = found->second.value;
    const auto padding = [](char c) { return c == ' ' || c == '\0'; };
    while (!value.empty() && padding(value.back())) value.pop_back();
    value.erase(0, std::min(value.find_first_not_of(' '), value.size()));
    return value;
}

namespace {

// "1.5\-2\3": empty parts are left out.
std::vector<double> decimals(const std::string& file, const DicomTag& tag, const std::string& text) {
    std::vector<double> result;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\\', at), text.size());
        std::string part = text.substr(at, end - at);
        part.erase(0, std::min(part.find_first_not_of(' '), part.size()));
        part.erase(part.find_last_not_of(std::string_view(" \0", 2)) + 1);
        std::size_t read = 0;
        const std::optional<double> value = takeNumber(part, read);
        if (!part.empty() && (!value || read != part.size()))
            throw InputError(file,
                             fmt::format("{} {} says '{}'; expected numbers", tag.name, tagText(tag.number),
                                         oneLine(text.substr(0, 60)) + (text.size() > 60 ? "..." : "")));
        if (value) result.push_back(*value);
        at = end + 1;
    }
    return result;
}

double binaryNumber(std::string_view bytes, std::size_t at, std::string_view vr, bool bigEndian) {
    if (vr == "FD") {
        const std::uint64_t bits = integerAt(bytes, at, 8, bigEndian);
        double value = 0;
        std::memcpy(&value, &bits, sizeof value);
        return value;
    }
    if (vr == "AT")
        return static_cast<double>(integerAt(bytes, at, 2, bigEndian) << 16 |
                                   integerAt(bytes, at + 2, 2, bigEndian));
    return static_cast<double>(integerAt(bytes, at, vr == "US" ? 2 : 4, bigEndian));
}

}  // namespace

std::vector<double> DicomSet::numbers(const DicomTag& tag) const {
    const std::string_view vr = tag.vr;
    if (vr == "DS" || vr == "IS") return decimals(*file_, tag, text(tag));
    const auto found = elements_.find(tag.number);
    if (found == elements_.end()) return {};
    const std::string& bytes = found->second.value;
    const std::size_t each = vr == "FD" ? 8 : vr == "US" ? 2 : 4;
    if (bytes.size() % each != 0)
        throw InputError(*file_, fmt::format("{} {} is of {} bytes; expected a multiple of {}; it is damaged",
                                             tag.name, tagText(tag.number), bytes.size(), each));
    std::vector<double> result;
    for (std::size_t at = 0; at < bytes.size(); at += each)
        result.push_back(binaryNumber(bytes, at, vr, bigEndian_));
    return result;
}

std::optional<double> DicomSet::number(const DicomTag& tag) const {
    const std::vector<double> all = numbers(tag);
    return all.empty() ? std::nullopt : std::optional(all[0]);
}

double DicomSet::number(const DicomTag& tag, double otherwise) const {
    return number(tag).value_or(otherwise);
}

const std::vector<DicomSet>& DicomSet::items(const DicomTag& tag) const {
    static const std::vector<DicomSet> none;
    const auto found = elements_.find(tag.number);
    return found == elements_.end() ? none : found->second.items;
}

const DicomSet* DicomSet::item(const DicomTag& tag) const {
    const std::vector<DicomSet>& all = items(tag);
    return all.empty() ? nullptr : &all[0];
}

// ---- the walk over a file

class DicomWalk {
  public:
    explicit DicomWalk(DicomBytes& bytes, DicomFile& file)
        : bytes_(bytes), file_(file), name_(std::make_shared<const std::string>(bytes.path().string())) {}

    void run() {
        const std::int64_t start = metaInformation();
        file_.bigEndian = encoding_.bigEndian;
        prepare(file_.set, encoding_);
        if (metaOnly_) return;
        try {
            dataSet(start);
        } catch (const Damage& damage) {
            file_.problem = damage.what;
        }
    }

    // Whether bytes begin as a data set of group 0002 or 0008 does.
    bool beginsWithElements() {
        try {
            std::uint32_t last = 0;
            std::int64_t at = 0;
            encoding_ = guess(0);
            for (int i = 0; i < 3; ++i) {
                const Element element = elementAt(at, encoding_);
                const std::uint32_t group = element.tag >> 16;
                const bool first = i == 0 && (group == 0x0002 || group == 0x0008);
                if (!first && (i == 0 || element.tag <= last || group > 0x0020)) return false;
                if (element.length == kUndefined) return true;
                if (element.length > bytes_.size() - element.value) return false;
                last = element.tag;
                at = element.value + element.length;
            }
            return true;
        } catch (const Damage&) {
            return false;
        }
    }

    // Where the data set begins. invariant: encoding_ is the one of the data set.
    std::int64_t metaInformation() {
        const bool preamble = bytes_.peek(128, 4) == "DICM";
        std::int64_t at = preamble ? 132 : 0;
        try {
            for (;;) {
                const Element element = elementAt(at, {});
                if (element.tag >> 16 != 2) break;
                if (!isVr(element.vr) || element.length > bytes_.size() - element.value)
                    throw Damage{fmt::format("its file meta information is wrong at byte {}", at)};
                if (element.tag == tag::kTransferSyntax.number) file_.syntax = syntaxIn(element);
                at = element.value + element.length;
            }
            settleEncoding(at);
        } catch (const Damage& damage) {
            file_.problem = damage.what;
            metaOnly_ = true;
        }
        return at;
    }

  private:
    struct Damage {
        std::string what;
    };
    struct Encoding {
        bool explicitVr = true, bigEndian = false;
    };
    struct Element {
        std::uint32_t tag = 0;
        std::string vr;
        std::int64_t value = 0, length = 0;  // where the value begins; its length or kUndefined
    };

    void settleEncoding(std::int64_t at) {
        if (file_.syntax == "1.2.840.10008.1.2.1.99") bytes_.inflateFrom(at);
        encoding_ = guess(at);
        if (file_.syntax == "1.2.840.10008.1.2.2") encoding_.bigEndian = true;
        if (encoding_.bigEndian) encoding_.explicitVr = true;
    }

    // By the first element: two capital letters where the VR would be are one, for as a length they would be 16 kB to
    // 1.5 GB; and a group of 0x0800 is 0x0008 in the other byte order.
    Encoding guess(std::int64_t at) {
        const std::string_view head = bytes_.peek(at, 6);
        Encoding encoding;
        if (head.size() < 6) return encoding;
        encoding.explicitVr = isVr(head.substr(4, 2));
        encoding.bigEndian = encoding.explicitVr && integerAt(head, 0, 2, false) == 0x0800;
        return encoding;
    }

    std::string syntaxIn(const Element& element) {
        std::string text(bytes_.peek(element.value, std::min<std::int64_t>(element.length, 64)));
        text.erase(text.find_last_not_of(std::string_view(" \0", 2)) + 1);
        return text;
    }

    [[noreturn]] void damaged(const std::string& what, std::int64_t at) const {
        throw Damage{fmt::format("{} at byte {} of {}; it is truncated or damaged", what, at, bytes_.size())};
    }

    Element elementAt(std::int64_t at, const Encoding& encoding) {
        const std::string_view head = bytes_.peek(at, 12);
        if (head.size() < 8) damaged("its data set breaks off", at);
        Element element;
        element.tag = static_cast<std::uint32_t>(integerAt(head, 0, 2, encoding.bigEndian) << 16 |
                                                 integerAt(head, 2, 2, encoding.bigEndian));
        const bool framed = element.tag >> 16 == 0xFFFE;  // items and delimiters have no VR
        // Some writers put elements with implicit VR among those with explicit VR.
        if (encoding.explicitVr && !framed && isVr(head.substr(4, 2))) element.vr = head.substr(4, 2);
        if (hasLongLength(element.vr)) {
            if (head.size() < 12) damaged("its data set breaks off", at);
            element.length = static_cast<std::int64_t>(integerAt(head, 8, 4, encoding.bigEndian));
            element.value = at + 12;
        } else {
            const std::size_t from = element.vr.empty() ? 4 : 6;
            element.length = static_cast<std::int64_t>(integerAt(head, from, 8 - from, encoding.bigEndian));
            element.value = at + 8;
        }
        return element;
    }

    void prepare(DicomSet& set, const Encoding& encoding) const {
        set.bigEndian_ = encoding.bigEndian;
        set.file_ = name_;
    }

    // To the pixels, which are the last thing that is needed.
    void dataSet(std::int64_t at) {
        while (at < bytes_.size()) {
            const Element element = elementAt(at, encoding_);
            if (element.tag >> 16 == 0xFFFE) damaged("a delimiter delimits nothing", at);
            if (element.tag == 0) damaged("its data set ends in zeros", at);
            if (element.tag == tag::kPixels.number || element.tag == tag::kFloatPixels.number ||
                element.tag == tag::kDoublePixels.number)
                return takePixels(element);
            at = take(element, encoding_, file_.set, bytes_.size(), at, 0);
        }
    }

    // Pixels that break off are found later, where their length is known.
    void takePixels(const Element& element) {
        file_.pixelTag = element.tag;
        file_.pixelVr = element.vr;
        if (element.length != kUndefined) {
            file_.pixels = {element.value, std::min(element.length, bytes_.size() - element.value)};
            return;
        }
        file_.encapsulated = true;
        afterFragments(element.value, &file_.fragments);
        takeOffsets();
    }

    // The pieces of a compressed image: items of known length, then the end mark, which some writers leave out at the
    // end of the file.
    std::int64_t afterFragments(std::int64_t at, std::vector<DicomRange>* fragments = nullptr) {
        while (at < bytes_.size()) {
            const Element item = elementAt(at, encoding_);
            if (item.tag == kSequenceEnd) return item.value;
            if (item.tag != kItem || item.length > bytes_.size() - item.value)
                damaged("its compressed pixels break off", at);
            if (fragments) fragments->push_back({item.value, item.length});
            at = item.value + item.length;
        }
        return at;
    }

    // The first piece is the table of offsets, often empty.
    void takeOffsets() {
        if (file_.fragments.empty()) return;
        const DicomRange table = file_.fragments[0];
        file_.fragments.erase(file_.fragments.begin());
        if (table.length > kLongestValue) return;
        const std::string bytes = bytes_.read(table.start, table.length);
        for (std::size_t i = 0; i + 4 <= bytes.size(); i += 4)
            file_.offsets.push_back(static_cast<std::int64_t>(integerAt(bytes, i, 4, encoding_.bigEndian)));
    }

    // Puts the element that began at `at` into set, if it is one of ours. Returns where it ends: no farther than `end`,
    // which the file holds.
    std::int64_t take(const Element& element, const Encoding& encoding, DicomSet& set, std::int64_t end,
                      std::int64_t at, int depth) {
        const DicomTag* known = knownTag(element.tag);
        DicomSet::Element ignored;
        DicomSet::Element& into = known ? set.elements_[element.tag] : ignored;
        // Of unknown VR: a sequence, whose inside is implicit (PS3.5 section 6.2.2).
        const Encoding inside = element.vr == "UN" ? Encoding{false, false} : encoding;
        if (element.length == kUndefined && element.tag == tag::kPixels.number)
            return afterFragments(element.value);  // a compressed icon
        if (element.length == kUndefined)
            return takeItems(inside, into.items, element.value, end, true, depth + 1);
        if (element.length > end - element.value)
            damaged(
                fmt::format("the value of {}, {} bytes, does not end", tagText(element.tag), element.length),
                at);
        if (isSequence(element.tag))
            takeItems(inside, into.items, element.value, element.value + element.length, false, depth + 1);
        else if (known && element.length <= kLongestValue)
            into.value = bytes_.peek(element.value, element.length);
        return element.value + element.length;
    }

    // Items up to the end mark of a sequence, or to `end`. Returns where the sequence ends.
    std::int64_t takeItems(const Encoding& encoding, std::vector<DicomSet>& items, std::int64_t at,
                           std::int64_t end, bool marked, int depth) {
        if (depth > kDeepest) damaged("sequences are nested too deep", at);
        while (marked || at < end) {
            const Element item = elementAt(at, encoding);
            if (item.tag == kSequenceEnd) return item.value;
            if (item.tag != kItem) damaged("a sequence holds what is no item", at);
            if (item.length != kUndefined && item.length > end - item.value)
                damaged("an item does not end", at);
            items.emplace_back();
            prepare(items.back(), encoding);
            at = takeItem(item, encoding, items.back(), end, depth);
        }
        return at;
    }

    std::int64_t takeItem(const Element& item, const Encoding& encoding, DicomSet& set, std::int64_t end,
                          int depth) {
        const bool marked = item.length == kUndefined;
        const std::int64_t last = marked ? end : item.value + item.length;
        std::int64_t at = item.value;
        while (marked || at < last) {
            const Element element = elementAt(at, encoding);
            if (marked && element.tag == kItemEnd) return element.value;
            if (element.tag >> 16 == 0xFFFE) damaged("a delimiter delimits nothing", at);
            at = take(element, encoding, set, last, at, depth);
        }
        return at;
    }

    DicomBytes& bytes_;
    DicomFile& file_;
    std::shared_ptr<const std::string> name_;
    Encoding encoding_;
    bool metaOnly_ = false;
};

bool looksLikeDicom(const fs::path& path) {
    std::error_code error;
    if (!fs::is_regular_file(path, error) || fs::file_size(path, error) < 8) return false;
    if (!std::ifstream(path, std::ios::binary)) return false;
    DicomBytes bytes(path);
    DicomFile file;
    return bytes.peek(128, 4) == "DICM" || DicomWalk(bytes, file).beginsWithElements();
}

DicomFile readDicomFile(const fs::path& path) {
    DicomBytes bytes(path);
    DicomFile file;
    file.path = path;
    DicomWalk(bytes, file).run();
    return file;
}

DicomBytes openDicomBytes(const fs::path& path) {
    DicomBytes bytes(path);
    DicomFile file;
    DicomWalk(bytes, file).metaInformation();
    return bytes;
}

}  // namespace isowave::imageio
