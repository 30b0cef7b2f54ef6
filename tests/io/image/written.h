// NIfTI and NRRD files written byte by byte, for tests of what their headers say.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "isowave/mesh.h"

namespace isowave::test {

template <class T>
std::string bytes(const std::vector<T>& values, bool bigEndian = false) {
    std::string result;
    for (const T value : values) {
        auto one = std::bit_cast<std::array<char, sizeof(T)>>(value);
        if (bigEndian) std::reverse(one.begin(), one.end());
        result.append(one.data(), sizeof(T));
    }
    return result;
}

// nifti1.h, nifti2.h.
struct NiftiFile {
    std::vector<std::int64_t> size{2, 2, 2};
    int type = 4;  // int16
    std::array<double, 4> pixdim{1, 1, 1, 1};
    int qformCode = 0, sformCode = 0;
    std::array<double, 6> quaternion{};  // b, c, d, offsets
    std::array<double, 12> srow{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    double slope = 0, intercept = 0;
    int unit = 2;  // mm
    bool second = false, pair = false, bigEndian = false;
    std::string voxels = std::string(16, '\0');

    std::string header() const {
        std::string out(second ? 544 : 352, '\0');
        put<std::int32_t>(out, 0, second ? 540 : 348);
        out.replace(second ? 4 : 344, 4, std::string(pair ? "ni" : "n+") + (second ? '2' : '1') + '\0');
        if (second)
            fill<std::int64_t, double, std::int32_t>(out, {16, 12, 104, 168, 176, 344, 348, 352, 400});
        else
            fill<std::int16_t, float, std::int16_t>(out, {40, 70, 76, 108, 112, 252, 254, 256, 280});
        if (second)
            put<std::int32_t>(out, 500, unit);
        else
            put<std::uint8_t>(out, 123, unit);
        return out;
    }
    std::string file() const { return header() + voxels; }

  private:
    struct Places {
        std::size_t dim, type, pixdim, offset, slope, qform, sform, quaternion, srow;
    };
    template <class T, class V>
    void put(std::string& out, std::size_t at, V value) const {
        out.replace(at, sizeof(T), bytes<T>({static_cast<T>(value)}, bigEndian));
    }
    template <class Size, class Real, class Code>
    void fill(std::string& out, const Places& p) const {
        put<Size>(out, p.dim, size.size());
        for (std::size_t a = 0; a < size.size(); ++a) put<Size>(out, p.dim + (a + 1) * sizeof(Size), size[a]);
        put<std::int16_t>(out, p.type, type);
        for (std::size_t i = 0; i < 4; ++i) put<Real>(out, p.pixdim + i * sizeof(Real), pixdim[i]);
        if (second)
            put<std::int64_t>(out, p.offset, pair ? 0 : 544);
        else
            put<float>(out, p.offset, pair ? 0 : 352);
        put<Real>(out, p.slope, slope);
        put<Real>(out, p.slope + sizeof(Real), intercept);
        put<Code>(out, p.qform, qformCode);
        put<Code>(out, p.sform, sformCode);
        for (std::size_t i = 0; i < 6; ++i) put<Real>(out, p.quaternion + i * sizeof(Real), quaternion[i]);
        for (std::size_t i = 0; i < 12; ++i) put<Real>(out, p.srow + i * sizeof(Real), srow[i]);
    }
};

inline std::string vectorText(const Vec3& v) {
    return fmt::format("({:.17g},{:.17g},{:.17g})", v.x, v.y, v.z);
}

// lines: without the one that begins with "NRRD" and without the last one, which is empty.
inline std::string nrrdFile(const std::string& lines, const std::string& voxels) {
    return "NRRD0005\n" + lines + "\n" + voxels;
}

// type: "<i2"; shape: "2, 3, 4". NumPy pads its header with blanks to a multiple of 64.
inline std::string npyFile(const std::string& type, bool fortran, const std::string& shape,
                           const std::string& elements) {
    std::string header = fmt::format("{{'descr': '{}', 'fortran_order': {}, 'shape': ({}), }}", type,
                                     fortran ? "True" : "False", shape);
    header.resize(118 - 1, ' ');
    return std::string("\x93NUMPY\1\0\x76\0", 10) + header + "\n" + elements;
}

// MRC2014; words are numbered from 1 as its description has them.
struct MrcFile {
    std::array<std::int32_t, 3> size{2, 3, 4}, start{}, samples{2, 3, 4}, axes{1, 2, 3};
    std::array<float, 3> cell{2, 3, 4}, angles{90, 90, 90}, origin{};
    std::int32_t mode = 1, group = 1, extended = 0;
    bool bigEndian = false;
    std::string voxels = std::string(48, '\0');

    std::string file() const {
        std::string out(1024, '\0');
        put(out, 1, size), put(out, 4, std::array{mode}), put(out, 5, start), put(out, 8, samples);
        put(out, 11, cell), put(out, 14, angles), put(out, 17, axes),
            put(out, 23, std::array{group, extended});
        put(out, 50, origin);
        out.replace(208, 8, bigEndian ? std::string("MAP \x11\x11\0\0", 8) : std::string("MAP DD\0\0", 8));
        return out + std::string(static_cast<std::size_t>(extended), 'x') + voxels;
    }

  private:
    template <class T, std::size_t N>
    void put(std::string& out, std::size_t word, const std::array<T, N>& values) const {
        out.replace(4 * (word - 1), 4 * N, bytes(std::vector<T>(values.begin(), values.end()), bigEndian));
    }
};

}  // namespace isowave::test
