#include "subdivision/curves/curve_details.h"

#include <stdexcept>

#include "base/read_file.h"
#include "base/section_file.h"
#include "isowave/error.h"

namespace isowave::subdivision {
namespace {

constexpr SectionFormat kFormat{kCurveDetailsMagic, 1, "file of details of curves",
                                "isowave curve-levels INPUT --details FILE -o FOLDER", "write it again"};
constexpr std::uint32_t kHead = 1, kSizes = 2, kCoarse = 3, kDetails = 4;
constexpr int kMostLevels = 60, kMostWidth = 1000;  // as many as the command takes
constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 40;

void require(bool holds) {
    if (!holds) throw std::runtime_error("its sizes make no sense; the file is damaged");
}

// ---- writing

std::string sizesOf(const CurveSet& set) {
    ByteWriter out;
    out.varint(set.curves.size());
    for (const CurveLevels& curve : set.curves) {
        out.varint(2 * static_cast<std::uint64_t>(curve.coarse.dimension) + curve.coarse.closed);
        out.varint(static_cast<std::uint64_t>(curve.levels()));
        out.varint(curve.coarse.size());
        for (std::size_t k = curve.details.size(); k-- > 0;) out.varint(curve.details[k].points);
    }
    return out.str();
}

// The details that lead from level `level` to the one below, of all curves.
std::vector<double> detailsFrom(const CurveSet& set, int level) {
    std::vector<double> all;
    for (const CurveLevels& curve : set.curves) {
        if (level > curve.levels()) continue;
        const auto& values = curve.details[static_cast<std::size_t>(level - 1)].coordinates;
        all.insert(all.end(), values.begin(), values.end());
    }
    return all;
}

// ---- reading

struct Head {
    CurveSet set;
    std::uint64_t sizeBytes = 0;
};

Head headOf(std::string_view bytes) {
    ByteReader reader(bytes);
    Head head;
    head.set.scheme = reader.text();
    head.set.mask = reader.text();
    head.set.width = reader.i32();
    const std::uint32_t levels = reader.u32();
    head.sizeBytes = reader.u64();
    require(levels <= kMostLevels && 0 <= head.set.width && head.set.width <= kMostWidth && reader.atEnd());
    head.set.levels = static_cast<int>(levels);
    return head;
}

std::size_t sizeOf(ByteReader& reader) {
    const std::uint64_t value = reader.varint();
    require(value <= kMostPoints);
    return value;
}

// A curve without its coordinates; its coarse points go to `coarsePoints`.
CurveLevels emptyCurve(ByteReader& reader, const CurveSet& set, std::size_t& coarsePoints) {
    CurveLevels curve;
    const std::uint64_t form = reader.varint(), levels = reader.varint();
    require((form / 2 == 2 || form / 2 == 3) && levels <= static_cast<std::uint64_t>(set.levels));
    curve.coarse.dimension = static_cast<int>(form / 2);
    curve.coarse.closed = form % 2;
    coarsePoints = sizeOf(reader);
    curve.details.resize(levels);
    std::size_t points = coarsePoints;
    for (std::size_t k = levels; k-- > 0;) {
        curve.details[k].points = sizeOf(reader);
        require(curve.details[k].points >= points);
        points = curve.details[k].points;
    }
    return curve;
}

// What one section gives to one curve.
struct Share {
    std::vector<double>* values;
    std::uint64_t count;
};

void hand(std::string_view bytes, const std::vector<Share>& shares) {
    std::uint64_t count = 0;
    for (const Share& share : shares) count += share.count;
    const std::vector<double> all = inflatedDoubles(bytes, count);
    auto next = all.begin();
    for (const Share& share : shares) {
        share.values->assign(next, next + static_cast<std::ptrdiff_t>(share.count));
        next += static_cast<std::ptrdiff_t>(share.count);
    }
}

std::vector<Share> coarseShares(CurveSet& set, const std::vector<std::size_t>& points) {
    std::vector<Share> shares;
    for (std::size_t i = 0; i < points.size(); ++i) {
        Polyline& coarse = set.curves[i].coarse;
        shares.push_back({&coarse.coordinates, points[i] * static_cast<std::size_t>(coarse.dimension)});
    }
    return shares;
}

// REQUIRES: the coarse curves have their coordinates.
std::vector<Share> detailShares(CurveSet& set, int level) {
    std::vector<Share> shares;
    for (CurveLevels& curve : set.curves) {
        if (level > curve.levels()) continue;
        CurveDetails& details = curve.details[static_cast<std::size_t>(level - 1)];
        const std::size_t below = level == curve.levels()
                                      ? curve.coarse.size()
                                      : curve.details[static_cast<std::size_t>(level)].points;
        shares.push_back({&details.coordinates,
                          (details.points - below) * static_cast<std::size_t>(curve.coarse.dimension)});
    }
    return shares;
}

CurveSet setOf(std::string_view bytes) {
    const std::vector<Section> sections = sectionsOf(kFormat, bytes);
    const auto content = [&](std::size_t at, std::uint32_t kind) -> const std::string& {
        if (at >= sections.size() || sections[at].kind != kind)
            throw std::runtime_error("ends before its last level; it is truncated or damaged");
        return sections[at].content;
    };
    Head head = headOf(content(0, kHead));
    CurveSet& set = head.set;
    const std::string sizes = inflated(content(1, kSizes), head.sizeBytes);
    ByteReader reader(sizes);
    const std::size_t curves = sizeOf(reader);
    require(curves >= 1 && curves <= sizes.size());
    std::vector<std::size_t> points(curves);
    for (std::size_t& coarse : points) set.curves.push_back(emptyCurve(reader, set, coarse));
    require(reader.atEnd() && sections.size() == 3 + static_cast<std::size_t>(set.levels));
    hand(content(2, kCoarse), coarseShares(set, points));
    for (int level = set.levels; level > 0; --level)
        hand(content(3 + static_cast<std::size_t>(set.levels - level), kDetails), detailShares(set, level));
    const std::string scheme = schemeOf(set).name;
    for (CurveLevels& curve : set.curves) curve.scheme = scheme;
    return std::move(set);
}

}  // namespace

CurveScheme schemeOf(const CurveSet& set) {
    return set.mask.empty() ? curveScheme(set.scheme) : maskScheme(set.mask, set.width);
}

std::string curveDetailsBytes(const CurveSet& set) {
    const std::string sizes = sizesOf(set);
    ByteWriter head;
    head.text(set.scheme);
    head.text(set.mask);
    head.i32(set.width);
    head.u32(static_cast<std::uint32_t>(set.levels));
    head.u64(sizes.size());
    std::vector<double> coarse;
    for (const CurveLevels& curve : set.curves)
        coarse.insert(coarse.end(), curve.coarse.coordinates.begin(), curve.coarse.coordinates.end());
    std::vector<Section> sections{
        {kHead, head.str()}, {kSizes, deflated(sizes)}, {kCoarse, deflatedDoubles(coarse)}};
    for (int level = set.levels; level > 0; --level)
        sections.push_back({kDetails, deflatedDoubles(detailsFrom(set, level))});
    return fileOf(kFormat, sections);
}

CurveSet readCurveDetails(std::string_view bytes, const std::string& name) {
    try {
        return setOf(bytes);
    } catch (const std::runtime_error& error) {
        throw InputError(name, error.what());
    }
}

CurveSet loadCurveDetails(const std::filesystem::path& path) {
    return readCurveDetails(readFile(path, "details of curves"), path.string());
}

}  // namespace isowave::subdivision
