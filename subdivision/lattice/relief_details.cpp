#include "subdivision/lattice/relief_details.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/read_file.h"
#include "base/section_file.h"
#include "isowave/error.h"
#include "subdivision/lattice/relief.h"
#include "subdivision/lattice/surface_limit.h"

namespace isowave::subdivision {
namespace {

constexpr SectionFormat kFormat{kReliefDetailsMagic, 1, "file of details of heights",
                                "isowave relief INPUT --details FILE -o FOLDER", "write it again"};
constexpr std::uint32_t kHead = 1, kCoarse = 2, kDetails = 3;
constexpr std::uint32_t kMostLevels = 20, kMostChannels = 4;  // as many as the command takes
constexpr std::uint64_t kMostSide = std::uint64_t{1} << 28;
constexpr double kSameRelief = 1e-6;  // of the range

void require(bool holds) {
    if (!holds) throw std::runtime_error("its head makes no sense; the file is damaged");
}

// ---- the file

struct Head {
    std::string scheme;
    std::uint32_t levels, channels;
    std::uint64_t rows, columns;
    ReliefLayout layout = ReliefLayout::Rows;
};
constexpr std::uint32_t kQuincunx = 1;  // as the head has it; Rows says nothing

Head headOf(std::string_view bytes) {
    ByteReader reader(bytes);
    Head head;
    head.scheme = reader.text();
    head.levels = reader.u32();
    head.channels = reader.u32();
    head.rows = reader.u64();
    head.columns = reader.u64();
    if (!reader.atEnd()) {
        require(reader.u32() == kQuincunx);
        head.layout = ReliefLayout::Quincunx;
    }
    require(head.levels <= kMostLevels && 1 <= head.channels && head.channels <= kMostChannels &&
            reader.atEnd());
    require(1 <= head.rows && head.rows <= kMostSide && 1 <= head.columns && head.columns <= kMostSide);
    const std::uint64_t unit = std::uint64_t{1} << head.levels;
    const bool large = head.layout == ReliefLayout::Rows
                           ? unit < head.rows && unit < head.columns
                           : quincunxSide(head.rows, head.columns, static_cast<int>(head.levels)) > 0;
    require(large);
    return head;
}

// Steps along a side of the coarsest patch.
int coarseSide(std::uint64_t count, std::uint32_t levels) {
    const std::uint64_t unit = std::uint64_t{1} << levels;
    return static_cast<int>((count - 1 + unit - 1) / unit);
}

// The coarsest patch, told by its sides: it takes memory of its own, and what the file says must hold first.
struct CoarsePatch {
    explicit CoarsePatch(const Head& head) : layout(head.layout) {
        if (layout == ReliefLayout::Quincunx) {
            const std::size_t side = quincunxSide(head.rows, head.columns, static_cast<int>(head.levels));
            a = b = side >> head.levels;
        } else {
            a = static_cast<std::uint64_t>(coarseSide(head.columns, head.levels));
            b = static_cast<std::uint64_t>(coarseSide(head.rows, head.levels));
        }
    }
    std::uint64_t nodesAt(std::uint32_t subdivisions) const {
        const std::uint64_t x = a << subdivisions, y = b << subdivisions;
        return layout == ReliefLayout::Quincunx ? 3 * x * (x + 1) + 1 : (x + 1) * (y + 1);
    }
    Patch made() const {
        return layout == ReliefLayout::Quincunx
                   ? Patch::hexagon(static_cast<int>(a))
                   : Patch::parallelogram(static_cast<int>(a), static_cast<int>(b));
    }

    ReliefLayout layout;
    std::uint64_t a, b;
};

ReliefParts partsOf(std::string_view bytes) {
    const std::vector<Section> sections = sectionsOf(kFormat, bytes);
    const auto content = [&](std::size_t at, std::uint32_t kind) -> const std::string& {
        if (at >= sections.size() || sections[at].kind != kind)
            throw std::runtime_error("ends before its last level; it is truncated or damaged");
        return sections[at].content;
    };
    const Head head = headOf(content(0, kHead));
    require(sections.size() == 2 + head.levels);
    const CoarsePatch patch(head);
    std::vector<double> coarse = inflatedDoubles(content(1, kCoarse), patch.nodesAt(0) * head.channels);
    ReliefParts parts{head.rows,
                      head.columns,
                      {surfaceScheme(head.scheme).name,
                       {patch.made(), static_cast<int>(head.channels), std::move(coarse)},
                       {}},
                      head.layout};
    for (std::uint32_t step = 0; step < head.levels; ++step)
        parts.levels.details.push_back(inflatedDoubles(
            content(2 + step, kDetails), (patch.nodesAt(step + 1) - patch.nodesAt(step)) * head.channels));
    std::reverse(parts.levels.details.begin(), parts.levels.details.end());
    return parts;
}

// ---- details

double squareOf(const double* detail, std::size_t channels) {
    double sum = 0;
    for (std::size_t c = 0; c < channels; ++c) sum += detail[c] * detail[c];
    return sum;
}

// Every detail of all levels with the square of its size, the coarsest level first.
std::vector<std::pair<double, double*>> allDetails(SurfaceLevels& levels) {
    const auto channels = static_cast<std::size_t>(levels.coarse.channels);
    std::vector<std::pair<double, double*>> all;
    for (std::size_t k = levels.details.size(); k-- > 0;)
        for (std::size_t i = 0; i < levels.details[k].size(); i += channels)
            all.emplace_back(squareOf(&levels.details[k][i], channels), &levels.details[k][i]);
    return all;
}

std::size_t nonzeroCount(SurfaceLevels& levels) {
    const auto all = allDetails(levels);
    return static_cast<std::size_t>(
        std::count_if(all.begin(), all.end(), [](const auto& detail) { return detail.first != 0; }));
}

// Of equal sizes the coarser stays, then the earlier.
void drop(SurfaceLevels& levels, const ReliefRebuildOptions& options) {
    const auto channels = static_cast<std::size_t>(levels.coarse.channels);
    auto all = allDetails(levels);
    const auto clear = [&](double* detail) { std::fill_n(detail, channels, 0.0); };
    if (options.threshold)
        for (const auto& [square, detail] : all)
            if (square < *options.threshold * *options.threshold) clear(detail);
    if (!options.keep) return;
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    for (std::size_t k = *options.keep; k < all.size(); ++k) clear(all[k].second);
}

// ---- heights

Grid picture(const ReliefParts& parts, const SurfaceField& field, int level) {
    if (parts.layout == ReliefLayout::Quincunx) return reliefPicture(field, parts.layout);
    const Grid size{parts.rows, parts.columns, 1, {}};
    return withoutPadding(reliefPicture(field, ReliefLayout::Rows), size, level);
}

// The heights that the relief has of its own: without padding, and without what quincunx fills in.
Grid ownHeights(const ReliefParts& parts, const SurfaceField& field, int level) {
    if (parts.layout == ReliefLayout::Rows) return picture(parts, field, level);
    return {1, field.patch.size(), static_cast<std::size_t>(field.channels), field.values};
}

void requireSize(const Grid& coarse, const Grid& grid) {
    if (grid.rows == coarse.rows && grid.columns == coarse.columns && grid.channels == coarse.channels)
        return;
    throw InputError(fmt::format(
        "has {} x {} samples of {} channels; the coarse heights of the details have {} x {} of {}", grid.rows,
        grid.columns, grid.channels, coarse.rows, coarse.columns, coarse.channels));
}

// The nodes' samples alone count; those between are means, and around the hexagon there are none.
void moveHexagon(SurfaceField& field, const Grid& after) {
    const auto channels = static_cast<std::size_t>(field.channels);
    for (const Node node : field.patch.nodes()) {
        const std::size_t sample = quincunxSample(field.patch, node);
        for (std::size_t c = 0; c < channels; ++c) {
            const double height = after.values[sample * channels + c];
            if (!std::isfinite(height))
                throw InputError(fmt::format(
                    "row {}, column {} holds no finite number, but is a sample of the coarse heights",
                    sample / after.columns, sample % after.columns));
            field.values[field.patch.index(node) * channels + c] = height;
        }
    }
}

// c moves by what the edit has changed, beyond the samples by what it has changed at the nearest one.
void moveRows(SurfaceField& field, const Grid& before, const Grid& after) {
    const auto rows = static_cast<std::size_t>(field.patch.lastRow() + 1),
               columns = field.patch.size() / rows, channels = before.channels;
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t column = 0; column < columns; ++column)
            for (std::size_t c = 0; c < channels; ++c) {
                const std::size_t i = std::min(r, before.rows - 1), j = std::min(column, before.columns - 1);
                double& value = field.values[(r * columns + column) * channels + c];
                // The samples themselves, not a sum that rounds.
                if (i == r && j == column)
                    value = after.at(i, j, c);
                else
                    value += after.at(i, j, c) - before.at(i, j, c);
            }
}

// Of those that are numbers.
double rangeOf(const Grid& grid) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const double v : grid.values) {
        if (std::isnan(v)) continue;
        low = std::min(low, v);
        high = std::max(high, v);
    }
    return high - low;
}

PointError differenceOf(const Grid& a, const Grid& b) {
    PointError error;
    for (std::size_t k = 0; k < a.values.size(); ++k) {
        const double d = std::abs(a.values[k] - b.values[k]);
        error.largest = std::max(error.largest, d);
        error.rms += d * d;
    }
    error.rms = std::sqrt(error.rms / static_cast<double>(a.values.size()));
    return error;
}

}  // namespace

std::string reliefDetailsBytes(const ReliefParts& parts) {
    ByteWriter head;
    head.text(parts.levels.scheme);
    head.u32(static_cast<std::uint32_t>(parts.levels.levels()));
    head.u32(static_cast<std::uint32_t>(parts.levels.coarse.channels));
    head.u64(parts.rows);
    head.u64(parts.columns);
    if (parts.layout == ReliefLayout::Quincunx) head.u32(kQuincunx);
    std::vector<Section> sections{{kHead, head.str()},
                                  {kCoarse, deflatedDoubles(parts.levels.coarse.values)}};
    for (std::size_t k = parts.levels.details.size(); k-- > 0;)
        sections.push_back({kDetails, deflatedDoubles(parts.levels.details[k])});
    return fileOf(kFormat, sections);
}

ReliefParts readReliefDetails(std::string_view bytes, const std::string& name) {
    try {
        return partsOf(bytes);
    } catch (const std::runtime_error& error) {
        throw InputError(name, error.what());
    }
}

std::optional<MovedSample> firstMovedSample(const Grid& coarse, const Grid& grid) {
    requireSize(coarse, grid);
    const double allowed = kSameRelief * rangeOf(coarse);
    for (std::size_t k = 0; k < grid.values.size(); ++k) {
        const double a = grid.values[k], b = coarse.values[k];
        if (std::isnan(a) && std::isnan(b)) continue;
        const double distance = std::isnan(a - b) ? HUGE_VAL : std::abs(a - b);
        const std::size_t sample = k / grid.channels;
        if (distance > allowed) return MovedSample{sample / grid.columns, sample % grid.columns, distance};
    }
    return std::nullopt;
}

ReliefDetails ReliefDetails::load(const std::filesystem::path& path) {
    return read(readFile(path, "details of heights"), path.string());
}

ReliefDetails ReliefDetails::read(std::string_view bytes, const std::string& name) {
    return ReliefDetails(std::make_shared<const ReliefParts>(readReliefDetails(bytes, name)));
}

const std::string& ReliefDetails::scheme() const { return parts_->levels.scheme; }

int ReliefDetails::levels() const { return parts_->levels.levels(); }

Grid ReliefDetails::coarseHeights() const {
    return picture(*parts_, parts_->levels.coarse, parts_->levels.levels());
}

RebuiltRelief ReliefDetails::rebuild(const ReliefRebuildOptions& options) const {
    SurfaceLevels levels = parts_->levels;
    const int depth = options.depth == kAllLevels ? levels.levels() : options.depth;
    if (depth > levels.levels())
        throw InputError(
            fmt::format("holds details for {} levels, but {} were asked for", levels.levels(), depth));
    if (options.edited) {
        requireSize(coarseHeights(), *options.edited);
        if (parts_->layout == ReliefLayout::Quincunx)
            moveHexagon(levels.coarse, *options.edited);
        else
            moveRows(levels.coarse, coarseHeights(), *options.edited);
    }
    const int level = levels.levels() - depth;
    levels.details.erase(levels.details.begin(), levels.details.begin() + level);
    SurfaceFilters filters(surfaceScheme(levels.scheme));
    RebuiltRelief result;
    LevelsRebuildReport& report = result.report;
    report.details = allDetails(levels).size();
    SurfaceField field = reconstruct(levels, filters, 0);
    if (options.threshold || options.keep) {
        const Grid whole = ownHeights(*parts_, field, level);
        drop(levels, options);
        field = reconstruct(levels, filters, 0);
        report.error = differenceOf(ownHeights(*parts_, field, level), whole);
    }
    report.kept = nonzeroCount(levels);
    report.levels = depth;
    report.pieces = 1;
    report.positions = options.positions;
    if (options.positions == Positions::limit) field = SurfaceLimit(filters.scheme()).of(field);
    result.heights = picture(*parts_, field, level);
    const Grid own = ownHeights(*parts_, field, level);
    report.points = own.rows * own.columns;
    report.extent = rangeOf(own);
    return result;
}

}  // namespace isowave::subdivision
