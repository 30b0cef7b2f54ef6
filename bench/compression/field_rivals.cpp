#include "field_rivals.h"

#include <lzma.h>
#include <openvdb/io/Stream.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <stdexcept>

namespace isowave::bench {
namespace {

template <class Word>
std::string planesOf(const std::vector<Word>& words) {
    std::string bytes(words.size() * sizeof(Word), '\0');
    for (std::size_t i = 0; i < words.size(); ++i)
        for (std::size_t b = 0; b < sizeof(Word); ++b)
            bytes[b * words.size() + i] = static_cast<char>(words[i] >> (8 * b));
    return bytes;
}
template <class Word>
std::vector<Word> wordsOf(std::string_view planes) {
    std::vector<Word> words(planes.size() / sizeof(Word));
    for (std::size_t i = 0; i < words.size(); ++i)
        for (std::size_t b = 0; b < sizeof(Word); ++b)
            words[i] = static_cast<Word>(
                words[i] |
                static_cast<Word>(Word{static_cast<std::uint8_t>(planes[b * words.size() + i])} << (8 * b)));
    return words;
}

// Indices of steps that are symmetric about 0.
std::vector<std::int32_t> indicesOf(const FieldPoints& points, double step) {
    std::vector<std::int32_t> q(points.c.size());
    const double scale = 1 / (step * points.K);
    std::transform(points.c.begin(), points.c.end(), q.begin(),
                   [&](float c) { return static_cast<std::int32_t>(std::lround(c * scale)); });
    return q;
}
Values valuesOf(const std::vector<std::int32_t>& q, double step, double K) {
    Values values(q.size());
    std::transform(q.begin(), q.end(), values.begin(),
                   [&](std::int32_t i) { return static_cast<float>(i * step * K); });
    return values;
}

// One byte an index where that is enough, else two planes of bytes: what xz makes smaller than words.
constexpr std::int32_t kHalfByte = 127, kHalfWord = 32767;
bool fitsByte(const std::vector<std::int32_t>& q) {
    return std::all_of(q.begin(), q.end(), [](std::int32_t i) { return std::abs(i) <= kHalfByte; });
}
std::string encodeIndices(const std::vector<std::int32_t>& q) {
    const bool one = fitsByte(q);
    std::vector<std::uint16_t> words(q.size());
    for (std::size_t i = 0; i < q.size(); ++i) {
        if (std::abs(q[i]) > kHalfWord) throw std::runtime_error("a step too small for 16 bits");
        words[i] = static_cast<std::uint16_t>(q[i] + (one ? kHalfByte : kHalfWord));
    }
    std::string planes = planesOf(words);
    if (one) planes.resize(q.size());
    return (one ? '1' : '2') + xz(planes);
}
std::vector<std::int32_t> decodeIndices(std::string_view bytes, std::size_t count) {
    const bool one = bytes.front() == '1';
    std::string planes = unxz(bytes.substr(1), count * (one ? 1 : 2));
    planes.resize(2 * count, '\0');
    std::vector<std::int32_t> q;
    for (const std::uint16_t word : wordsOf<std::uint16_t>(planes))
        q.push_back(word - (one ? kHalfByte : kHalfWord));
    return q;
}

double stepOfEightBits(const FieldPoints& points) {
    float most = 0;
    for (const float c : points.c) most = std::max(most, std::abs(c));
    return most / points.K / kHalfByte;
}

Values valuesOf(const openvdb::FloatGrid& grid, const FieldPoints& points) {
    Values values(points.c.size());
    const compress::Lattice& lattice = points.lattice;
    auto accessor = grid.getConstAccessor();
    for (int x = 0; x < lattice.size[0]; ++x)
        for (int y = 0; y < lattice.size[1]; ++y)
            for (std::size_t i = lattice.rowStart[lattice.rowOf(x, y)];
                 i < lattice.rowStart[lattice.rowOf(x, y) + 1]; ++i)
                values[i] = accessor.getValue(points.origin.offsetBy(x, y, lattice.z[i]));
    return values;
}

std::string vdbBytes(const openvdb::FloatGrid& grid, bool half) {
    const openvdb::FloatGrid::Ptr copy = grid.deepCopy();
    copy->setSaveFloatAsHalf(half);
    std::ostringstream out;
    openvdb::io::Stream stream(out);
    stream.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
    stream.write(openvdb::GridPtrVec{copy});
    return out.str();
}

}  // namespace

std::string xz(std::string_view bytes) {
    std::string out(lzma_stream_buffer_bound(bytes.size()), '\0');
    std::size_t size = 0;
    if (lzma_easy_buffer_encode(9 | LZMA_PRESET_EXTREME, LZMA_CHECK_CRC32, nullptr,
                                reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(),
                                reinterpret_cast<std::uint8_t*>(out.data()), &size, out.size()) != LZMA_OK)
        throw std::runtime_error("xz failed");
    out.resize(size);
    return out;
}

std::string unxz(std::string_view bytes, std::size_t size) {
    std::string out(size, '\0');
    std::uint64_t memory = UINT64_MAX;
    std::size_t from = 0, to = 0;
    if (lzma_stream_buffer_decode(&memory, 0, nullptr, reinterpret_cast<const std::uint8_t*>(bytes.data()),
                                  &from, bytes.size(), reinterpret_cast<std::uint8_t*>(out.data()), &to,
                                  size) != LZMA_OK ||
        to != size)
        throw std::runtime_error("xz failed");
    return out;
}

FieldRival uniformAndXz(const FieldPoints& points) {
    FieldRival rival{.name = "uniform + xz"};
    rival.encode = [&points](double step) { return encodeIndices(indicesOf(points, step)); };
    rival.decode = [&points](std::string_view bytes, double step) {
        return valuesOf(decodeIndices(bytes, points.c.size()), step, points.K);
    };
    rival.trial = [&points](double step) { return valuesOf(indicesOf(points, step), step, points.K); };
    return rival;
}

FieldRival eightBitsAndXz(const FieldPoints& points) {
    FieldRival rival = uniformAndXz(points);
    rival.name = "8 bits + xz";
    const double step = stepOfEightBits(points);
    rival.encode = [encode = rival.encode, step](double) { return encode(step); };
    rival.decode = [decode = rival.decode, step](std::string_view bytes, double) {
        return decode(bytes, step);
    };
    return rival;
}

FieldRival planesAndXz(const FieldPoints& points) {
    FieldRival rival{.name = "byte planes + xz"};
    rival.encode = [&points](double) {
        std::vector<std::uint32_t> words(points.c.size());
        std::memcpy(words.data(), points.c.data(), 4 * words.size());
        return xz(planesOf(words));
    };
    rival.decode = [&points](std::string_view bytes, double) {
        const std::vector<std::uint32_t> words = wordsOf<std::uint32_t>(unxz(bytes, 4 * points.c.size()));
        Values values(words.size());
        std::memcpy(values.data(), words.data(), 4 * words.size());
        return values;
    };
    return rival;
}

FieldRival vdbAndBlosc(const FieldPoints& points, const BSplineField& field, bool half) {
    FieldRival rival{.name = half ? "half floats + Blosc" : "float32 + Blosc", .mask = false};
    rival.encode = [&field, half](double) { return vdbBytes(*field.controlPoints, half); };
    rival.decode = [&points](std::string_view bytes, double) {
        std::istringstream in{std::string(bytes)};
        const auto grids = openvdb::io::Stream(in).getGrids();
        return valuesOf(*openvdb::gridConstPtrCast<openvdb::FloatGrid>(grids->front()), points);
    };
    return rival;
}

}  // namespace isowave::bench
