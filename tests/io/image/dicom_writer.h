// DICOM files for tests: a data set, element by element, in explicit or implicit VR, with or without preamble.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace isowave::test {

enum class Vr { explicitLittle, implicitLittle, explicitBig };

// Bytes of elements. Pixels come last: readers stop there.
class DicomOut {
  public:
    explicit DicomOut(Vr vr = Vr::explicitLittle) : vr_(vr) {}

    DicomOut& text(std::uint32_t tag, const char* vr, std::string value) {
        if (value.size() % 2) value += std::strcmp(vr, "UI") == 0 ? '\0' : ' ';
        return element(tag, vr, value);
    }
    DicomOut& us(std::uint32_t tag, int value) { return element(tag, "US", integer(value, 2)); }
    DicomOut& us(std::uint32_t tag, const std::vector<int>& values) {
        std::string all;
        for (const int value : values) all += integer(static_cast<std::uint64_t>(value), 2);
        return element(tag, "US", all);
    }
    DicomOut& at(std::uint32_t tag, std::uint32_t value) {
        return element(tag, "AT", integer(value >> 16, 2) + integer(value & 0xFFFF, 2));
    }
    DicomOut& numbers(std::uint32_t tag, const std::vector<double>& values) {
        std::string all;
        for (const double v : values) all += fmt::format("{}{}", all.empty() ? "" : "\\", v);
        return text(tag, "DS", all);
    }
    DicomOut& sequence(std::uint32_t tag, const std::vector<DicomOut>& items) {
        std::string all;
        for (const DicomOut& item : items)
            all += head(0xFFFEE000) + integer(item.bytes.size(), 4) + item.bytes;
        return element(tag, "SQ", all);
    }
    DicomOut& element(std::uint32_t tag, const std::string& vr, const std::string& value) {
        bytes += head(tag);
        const bool wide = vr == "SQ" || vr == "OW" || vr == "OB" || vr == "OF" || vr == "UN";
        if (vr_ != Vr::implicitLittle) bytes += vr;
        if (vr_ == Vr::implicitLittle)
            bytes += integer(value.size(), 4);
        else
            bytes += wide ? std::string(2, '\0') + integer(value.size(), 4) : integer(value.size(), 2);
        bytes += value;
        return *this;
    }
    // Compressed pixels: an empty table of offsets, then the pieces.
    DicomOut& pieces(const std::vector<std::string>& all) {
        bytes += head(0x7FE00010) + "OB" + std::string(2, '\0') + integer(0xFFFFFFFF, 4);
        bytes += head(0xFFFEE000) + integer(0, 4);
        for (const std::string& piece : all) bytes += head(0xFFFEE000) + integer(piece.size(), 4) + piece;
        bytes += head(0xFFFEE0DD) + integer(0, 4);
        return *this;
    }
    std::string integer(std::uint64_t value, int size) const {
        std::string result;
        for (int i = 0; i < size; ++i)
            result += static_cast<char>(value >> 8 * (vr_ == Vr::explicitBig ? size - 1 - i : i) & 0xFF);
        return result;
    }

    std::string bytes;

  private:
    std::string head(std::uint32_t tag) const { return integer(tag >> 16, 2) + integer(tag & 0xFFFF, 2); }
    Vr vr_;
};

// With preamble and file meta information.
inline std::string dicomFile(const DicomOut& set, const std::string& syntax = "1.2.840.10008.1.2.1") {
    DicomOut meta;
    meta.text(0x00020010, "UI", syntax);
    return std::string(128, '\0') + "DICM" + meta.bytes + set.bytes;
}

// What a file says; "" and empty lists are left out.
struct DicomSays {
    std::string sop = "1.2.840.10008.5.1.4.1.1.2", series = "1.2.3", modality = "CT", instance = "1",
                uid = "1.2.3.4";
    int columns = 4, rows = 5, frames = 0, allocated = 16, stored = 16, isSigned = 1;
    std::vector<double> position, orientation{1, 0, 0, 0, 1, 0}, spacing{0.8, 0.7};
    std::string pixels;
    DicomOut more;  // elements beside these

    DicomSays& at(double x, double y, double z) { return position = {x, y, z}, *this; }
};

inline DicomOut dicomSet(const DicomSays& says, Vr vr = Vr::explicitLittle, bool withPixels = true) {
    DicomOut out(vr);
    const auto text = [&](std::uint32_t tag, const char* kind, const std::string& value) {
        if (!value.empty()) out.text(tag, kind, value);
    };
    const auto numbers = [&](std::uint32_t tag, const std::vector<double>& values) {
        if (!values.empty()) out.numbers(tag, values);
    };
    text(0x00080016, "UI", says.sop);
    text(0x00080018, "UI", says.uid);
    text(0x00080060, "CS", says.modality);
    text(0x0020000D, "UI", "1.2");
    text(0x0020000E, "UI", says.series);
    text(0x00200013, "IS", says.instance);
    numbers(0x00200032, says.position);
    numbers(0x00200037, says.orientation);
    out.us(0x00280002, 1);
    text(0x00280004, "CS", "MONOCHROME2");
    if (says.frames > 0) out.text(0x00280008, "IS", std::to_string(says.frames));
    out.us(0x00280010, says.rows).us(0x00280011, says.columns);
    numbers(0x00280030, says.spacing);
    out.us(0x00280100, says.allocated).us(0x00280101, says.stored).us(0x00280102, says.stored - 1);
    out.us(0x00280103, says.isSigned);
    out.bytes += says.more.bytes;
    if (withPixels) out.element(0x7FE00010, "OW", says.pixels);
    return out;
}

// Pixel (x, y) of slice z: 1000 z + 10 y + x, as 16 bits.
inline std::string slicePixels(int z, int columns = 4, int rows = 5, Vr vr = Vr::explicitLittle) {
    std::string pixels;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
            pixels += DicomOut(vr).integer(static_cast<std::uint64_t>(1000 * z + 10 * y + x), 2);
    return pixels;
}

// PackBits (PS3.5 annex G): the high bytes, then the low ones; each byte b of a run of one as 0, b.
inline std::string runLength(const std::string& pixels) {
    std::string segments[2];
    for (std::size_t i = 0; i < pixels.size(); ++i) segments[1 - i % 2] += std::string(1, '\0') + pixels[i];
    DicomOut header;
    std::string piece =
        header.integer(2, 4) + header.integer(64, 4) + header.integer(64 + segments[0].size(), 4);
    piece.resize(64, '\0');
    return piece + segments[0] + segments[1];
}

}  // namespace isowave::test
