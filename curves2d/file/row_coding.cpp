#include "curves2d/file/row_coding.h"

#include <bit>
#include <cmath>
#include <stdexcept>

#include "base/section_file.h"

namespace isowave::curves2d {
namespace {

constexpr std::int32_t kShortest = 4;  // of a run
constexpr std::int32_t kBetween = 2;   // from the end of a run to where the next one may begin

void require(bool holds) {
    if (!holds) throw std::runtime_error("its control points make no sense; the file is damaged");
}

// ---- values

// Larger floats are larger numbers.
std::uint32_t ordered(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}
float unordered(std::uint32_t order) {
    return std::bit_cast<float>(order & 0x80000000u ? order & 0x7fffffffu : ~order);
}

std::uint32_t folded(std::uint32_t difference) {
    return (difference << 1) ^ (difference & 0x80000000u ? ~std::uint32_t{0} : 0);
}
std::uint32_t unfolded(std::uint32_t value) { return (value >> 1) ^ (~(value & 1) + 1); }

std::uint32_t wordOf(float value, float prediction, Coding coding) {
    return coding == Coding::plain ? std::bit_cast<std::uint32_t>(value)
                                   : folded(ordered(value) - ordered(prediction));
}
float valueOf(std::uint32_t word, float prediction, Coding coding) {
    return coding == Coding::plain ? std::bit_cast<float>(word)
                                   : unordered(ordered(prediction) + unfolded(word));
}

const Row<float>& rowOf(const RowField<float>& field, std::int32_t y) { return *field.find(y); }
Row<float>& rowOf(RowField<float>& field, std::int32_t y) { return field.rows.find(y).value(); }

// Visits every control point with its prediction, rows ascending: code(value, prediction) may set the value, which the
// predictions of those behind it then see.
template <class Field, class Code>
void forEachPredicted(Field& field, const Code& code) {
    std::vector<double> above;
    for (const std::int32_t y : field.rowNumbers()) {
        auto& row = rowOf(field, y);
        RowReader<float> reader(field.find(y - 1), field.K);
        auto value = row.values.begin();
        bool inside = false;
        for (const KnownRun& run : row.runs) {
            above.resize(static_cast<std::size_t>(run.last - run.first + 2));
            reader.read(run.first - 1, above);
            double left = inside ? -field.K : field.K;
            for (std::size_t i = 1; i < above.size(); ++i, ++value) {
                code(*value, static_cast<float>(left + (above[i] - above[i - 1])));
                left = static_cast<double>(*value);
            }
            inside = run.insideAfter;
        }
    }
}

// ---- rows

void encodeRow(const Row<float>& row, std::int32_t firstAbove, ByteWriter& out) {
    out.varint(row.runs.size());
    for (std::size_t r = 0; r < row.runs.size(); ++r) {
        const KnownRun& run = row.runs[r];
        if (r == 0)
            out.signedVarint(std::int64_t{run.first} - firstAbove);
        else
            out.varint(static_cast<std::uint64_t>(run.first - row.runs[r - 1].last - kBetween));
        out.varint(2 * static_cast<std::uint64_t>(run.last - run.first + 1 - kShortest) + run.insideAfter);
    }
}

std::int32_t position(std::int64_t value) {
    require(-1 <= value && value <= kMostPosition);
    return static_cast<std::int32_t>(value);
}
std::int64_t step(ByteReader& reader) {
    const std::uint64_t value = reader.varint();
    require(value <= 2 * static_cast<std::uint64_t>(kMostPosition) + 1);
    return static_cast<std::int64_t>(value);
}

KnownRun decodeRun(ByteReader& reader, std::int64_t first) {
    KnownRun run{position(first), 0, false};
    const std::int64_t length = step(reader);
    run.insideAfter = length & 1;
    run.last = position(std::int64_t{run.first} + length / 2 + kShortest - 1);
    return run;
}

// `points`: those that are left.
Row<float> decodeRow(ByteReader& reader, std::int32_t firstAbove, std::uint64_t& points) {
    Row<float> row;
    const std::uint64_t runs = reader.varint();
    require(1 <= runs && runs <= points / kShortest);
    row.runs.reserve(runs);
    std::uint64_t count = 0;
    for (std::uint64_t r = 0; r < runs; ++r) {
        const std::int64_t offset = r == 0 ? reader.signedVarint() : step(reader);
        require(std::abs(offset) <= std::int64_t{2} * kMostPosition);
        row.runs.push_back(decodeRun(
            reader, r == 0 ? firstAbove + offset : std::int64_t{row.runs.back().last} + kBetween + offset));
        count += static_cast<std::uint64_t>(row.runs.back().last - row.runs.back().first + 1);
        require(count <= points);
    }
    points -= count;
    row.values.resize(count);
    return row;
}

}  // namespace

std::string encodeRows(const RowField<float>& field) {
    ByteWriter out;
    out.varint(field.rows.size());
    std::int32_t before = 0, firstAbove = 0;
    for (const std::int32_t y : field.rowNumbers()) {
        const Row<float>& row = *field.find(y);
        out.signedVarint(std::int64_t{y} - before);
        encodeRow(row, firstAbove, out);
        before = y;
        firstAbove = row.runs.front().first;
    }
    return out.str();
}

RowField<float> decodeRows(std::string_view bytes, std::uint64_t points) {
    ByteReader reader(bytes);
    RowField<float> field;
    const std::uint64_t rows = reader.varint();
    require(rows <= points / kShortest);
    field.rows.reserve(rows);
    std::int32_t before = 0, firstAbove = 0;
    for (std::uint64_t r = 0; r < rows; ++r) {
        const std::int64_t difference = reader.signedVarint();
        require((r == 0 || difference > 0) && std::abs(difference) <= std::int64_t{2} * kMostPosition);
        const std::int32_t y = position(before + difference);
        Row<float> row = decodeRow(reader, firstAbove, points);
        before = y;
        firstAbove = row.runs.front().first;
        field.rows[y] = std::move(row);
    }
    require(points == 0 && reader.atEnd());
    return field;
}

std::string encodeValues(const RowField<float>& field, Coding coding) {
    const auto count = static_cast<std::size_t>(field.controlPointCount());
    std::string planes(4 * count, '\0');
    std::size_t at = 0;
    forEachPredicted(field, [&](float value, float prediction) {
        const std::uint32_t word = wordOf(value, prediction, coding);
        for (std::size_t b = 0; b < 4; ++b) planes[b * count + at] = static_cast<char>(word >> (8 * b));
        ++at;
    });
    return planes;
}

void decodeValues(std::string_view planes, Coding coding, RowField<float>& field) {
    const std::size_t count = planes.size() / 4;
    std::size_t at = 0;
    forEachPredicted(field, [&](float& value, float prediction) {
        std::uint32_t word = 0;
        for (std::size_t b = 0; b < 4; ++b)
            word |= std::uint32_t{static_cast<std::uint8_t>(planes[b * count + at])} << (8 * b);
        ++at;
        value = valueOf(word, prediction, coding);
        require(std::isfinite(value));
    });
}

}  // namespace isowave::curves2d
