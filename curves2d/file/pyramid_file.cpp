#include "curves2d/file/pyramid_file.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>

#include "base/atomic_file.h"
#include "base/section_file.h"
#include "base/text.h"
#include "curves2d/file/row_coding.h"
#include "curves2d/fit.h"
#include "isowave/error.h"

namespace isowave::curves2d {
namespace {

constexpr SectionFormat kFormat{"ISOWAVEC", kPyramidFormatVersion, "pyramid of curves",
                                "isowave curves INPUT --pyramid FILE.iwc -o FOLDER", "write it again"};
constexpr std::uint32_t kHead = 1, kRows = 2, kPredicted = 3, kPlain = 4;
// Of K: far beyond what a fit makes, far below what overflows.
constexpr double kLargestValue = 1e6;
// In pixels, of the distance fit, which an edit repeats: so far from its boundary there is nothing that could be told apart.
constexpr double kWidest = 1 << 22;

void require(bool holds) {
    if (!holds) throw std::runtime_error("its head makes no sense; the file is damaged");
}

// ---- writing

void write(ByteWriter& out, Point p) {
    out.f64(p.x);
    out.f64(p.y);
}

void write(ByteWriter& out, const FitReport& report) {
    out.u64(static_cast<std::uint64_t>(report.latticePoints));
    out.u64(static_cast<std::uint64_t>(report.disagreeing));
    out.u32(static_cast<std::uint32_t>(report.repairPasses));
    out.u32(report.repairAgreed);
    out.f64(report.repairFloor);
    out.u64(static_cast<std::uint64_t>(report.repaired));
}

std::string headOf(const Input& input, const RowField<float>& field, std::size_t rowBytes) {
    ByteWriter out;
    out.f64(field.K);
    write(out, field.frame.origin);
    write(out, field.frame.spacing);
    out.u64(rowBytes);
    out.u64(static_cast<std::uint64_t>(field.controlPointCount()));
    write(out, input.extent.low);
    write(out, input.extent.high);
    out.u32(input.yUp);
    out.text(input.kind);
    out.f64(input.pixel);
    out.u32(input.fitted->method == Fit::distance);
    out.f64(input.fitted->halfWidth);
    out.f64(input.fitted->band);
    write(out, input.fitted->report);
    return out.str();
}

// ---- reading

double finite(ByteReader& reader) {
    const double value = reader.f64();
    require(std::isfinite(value));
    return value;
}
double positive(ByteReader& reader) {
    const double value = finite(reader);
    require(value > 0);
    return value;
}
bool flag(ByteReader& reader) {
    const std::uint32_t value = reader.u32();
    require(value <= 1);
    return value == 1;
}
std::int64_t count(ByteReader& reader) {
    const std::uint64_t value = reader.u64();
    require(value <= INT64_MAX);
    return static_cast<std::int64_t>(value);
}
Point point(ByteReader& reader) {
    const double x = finite(reader), y = finite(reader);
    return {x, y};
}
// One line of ASCII.
std::string line(ByteReader& reader) {
    const std::string_view text = reader.text();
    require(std::all_of(text.begin(), text.end(), [](char c) { return ' ' <= c && c <= '~'; }));
    return std::string(text);
}

FitReport reportOf(ByteReader& reader) {
    FitReport report;
    report.latticePoints = count(reader);
    report.disagreeing = count(reader);
    const std::uint32_t passes = reader.u32();
    require(passes <= INT32_MAX);
    report.repairPasses = static_cast<int>(passes);
    report.repairAgreed = flag(reader);
    report.repairFloor = finite(reader);
    report.repaired = count(reader);
    return report;
}

struct Head {
    double K = 1;
    Frame frame;
    std::uint64_t rowBytes = 0, points = 0;
    Input input;
    Fitted fitted;
};

Head headOf(std::string_view bytes) {
    ByteReader reader(bytes);
    Head head;
    head.K = positive(reader);
    head.frame.origin = point(reader);
    head.frame.spacing = {positive(reader), 0};
    head.frame.spacing.y = positive(reader);
    head.rowBytes = reader.u64();
    head.points = reader.u64();
    require(0 < head.points && head.points <= UINT64_MAX / 4);
    head.input.extent = {point(reader), {}};
    head.input.extent.high = point(reader);
    require(!head.input.extent.empty());
    head.input.yUp = flag(reader);
    head.input.kind = line(reader);
    head.input.pixel = positive(reader);
    head.fitted.method = flag(reader) ? Fit::distance : Fit::binary;
    head.fitted.halfWidth = positive(reader);
    head.fitted.band = positive(reader);
    require(head.fitted.band <= head.fitted.halfWidth && head.fitted.halfWidth <= kWidest);
    head.fitted.report = reportOf(reader);
    require(reader.atEnd());
    return head;
}

// What a fit promises (row_field.h): gaps have one sign however rows run, and along either axis runs are 4 or longer.
void requireField(const RowField<float>& field) {
    const RowField<float> columns = transposed(field), back = transposed(columns);
    bool holds = true;
    for (const auto& [number, column] : columns.rows)
        for (const KnownRun& run : column.runs) holds = holds && run.last - run.first >= 3;
    for (const auto& [number, row] : field.rows) {
        holds = holds && row == *back.find(number);
        for (const float value : row.values)
            holds = holds && std::abs(static_cast<double>(value)) <= kLargestValue * field.K;
    }
    if (!holds) throw std::runtime_error("its control points do not fit together; the file is damaged");
}

Input inputOf(std::string_view bytes) {
    const std::vector<Section> sections = sectionsOf(kFormat, bytes);
    if (sections.size() != 3 || sections[0].kind != kHead || sections[1].kind != kRows ||
        (sections[2].kind != kPredicted && sections[2].kind != kPlain))
        throw std::runtime_error("does not have a head, rows and values; it is truncated or damaged");
    Head head = headOf(sections[0].content);
    const std::string values = inflated(sections[2].content, 4 * head.points);
    RowField<float> field = decodeRows(inflated(sections[1].content, head.rowBytes), head.points);
    field.K = head.K;
    field.frame = head.frame;
    decodeValues(values, sections[2].kind == kPlain ? Coding::plain : Coding::predicted, field);
    requireField(field);
    head.fitted.field = std::move(field);
    head.input.fit = head.fitted.method;
    head.input.fitted = std::make_shared<Fitted>(std::move(head.fitted));
    return std::move(head.input);
}

}  // namespace

bool isPyramidPath(const std::filesystem::path& path) { return toLower(path.extension().string()) == ".iwc"; }

Input readPyramid(std::string_view bytes, const std::string& name) {
    try {
        return inputOf(bytes);
    } catch (const std::runtime_error& error) {
        throw InputError(name, error.what());
    }
}

namespace {

Section valuesOf(const RowField<float>& field) {
    Section predicted{kPredicted, deflated(encodeValues(field, Coding::predicted))},
        plain{kPlain, deflated(encodeValues(field, Coding::plain))};
    return plain.content.size() < predicted.content.size() ? plain : predicted;
}

}  // namespace

std::string pyramidBytes(const Input& input) {
    assert(input.fitted);
    const RowField<float>& held = input.fitted->field;
    const RowField<float> turned = held.axis == 0 ? RowField<float>{} : transposed(held);
    const RowField<float>& field = held.axis == 0 ? held : turned;
    const std::string rows = encodeRows(field);
    return fileOf(kFormat,
                  {{kHead, headOf(input, field, rows.size())}, {kRows, deflated(rows)}, valuesOf(field)});
}

void savePyramid(const std::filesystem::path& path, const Input& input) {
    const std::string bytes = pyramidBytes(input);
    AtomicFile file(path);
    try {
        file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    } catch (const std::ios_base::failure&) {
        throw OperationError(path.string(), "writing failed; is the disk full? Nothing was left behind");
    }
    file.commit();
}

}  // namespace isowave::curves2d
