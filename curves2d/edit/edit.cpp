#include "curves2d/edit/edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "curves2d/file/row_coding.h"
#include "curves2d/raster.h"
#include "curves2d/three_rows.h"
#include "isowave/error.h"

namespace isowave::curves2d {
namespace {

Region knownRegion(const RowField<float>& field) {
    const std::vector<std::int32_t> numbers = field.rowNumbers();
    Region region = withRows(numbers.front(), numbers.back());
    for (const std::int32_t y : numbers)
        for (const KnownRun& run : field.find(y)->runs)
            region.rows[static_cast<std::size_t>(y - region.firstRow)].push_back({run.first, run.last});
    return region;
}

// The same control points at other places of the lattice.
RowField<float> shifted(const RowField<float>& field, std::int32_t dx, std::int32_t dy, const Frame& frame) {
    RowField<float> out;
    out.K = field.K;
    out.frame = frame;
    for (const auto& [y, row] : field.rows) {
        Row<float>& moved = out.rows[y + dy] = row;
        for (KnownRun& run : moved.runs) run = {run.first + dx, run.last + dx, run.insideAfter};
    }
    return out;
}

// ---- tool ----

constexpr double kMostBeyond = 1 << 22;  // pixels: rows between tool and shape take memory, too

// How far the polygons reach beyond the field's control points, in pixels of level 0.
double reachBeyond(const RowField<float>& field, const std::vector<Polygon>& polygons) {
    const Bounds box = field.bounds();
    double most = 0;
    for (const Polygon& polygon : polygons)
        for (const Ring& ring : polygon.rings)
            for (const Point& world : ring) {
                const Point p = field.frame.toLattice(world);
                for (int axis = 0; axis < 2; ++axis)
                    most = std::max({most, box.first[axis] - p[axis], p[axis] - box.last[axis]});
            }
    return most;
}

// Rows between the first and the last one take memory, be they known or not.
constexpr std::int64_t kMostRows = 1 << 25;

void requireFewRows(const RowField<float>& field, const RowField<float>& tool) {
    const Bounds a = field.bounds(), b = tool.bounds();
    const std::int64_t rows =
        std::int64_t{std::max(a.last[1], b.last[1])} - std::min(a.first[1], b.first[1]) + 1;
    if (rows > kMostRows)
        throw InputError(
            fmt::format("the shape and the polygons reach over {} rows of pixels, and {} are "
                        "taken at most; make curves of larger pixels",
                        rows, kMostRows));
}

RowField<float> toolOnLattice(const Fitted& fitted, const PolygonEdit& edit, const Progress& progress) {
    const double reach = reachBeyond(fitted.field, edit.polygons);
    if (reach > kMostBeyond)
        throw InputError(
            fmt::format("reaches {:.0f} pixels beyond the shape, and {:.0f} are taken at most; make "
                        "it smaller",
                        reach, kMostBeyond));
    const Frame& frame = fitted.field.frame;
    const double scale = std::ldexp(1.0, edit.level);
    Shape shape{{frame.origin, scale * frame.spacing}, {}, {}};
    shape.inside = rasterise(edit.polygons, shape.frame, progress);
    if (shape.inside.empty())
        throw InputError(
            fmt::format("no pixel's middle of level {} lies in a polygon; take a finer level", edit.level));
    shape.boundary = boundary(edit.polygons, shape.frame);
    RowField<float> tool =
        fitDistance<float>(shape, {.halfWidth = fitted.halfWidth, .band = fitted.band}, nullptr, progress);
    for (int level = 0; level < edit.level; ++level) tool = onHalfSpacing(tool);
    const Point shift = frame.toLattice(tool.frame.origin);
    return shifted(tool, static_cast<std::int32_t>(std::lround(shift.x)),
                   static_cast<std::int32_t>(std::lround(shift.y)), frame);
}

// ---- values at lattice points ----

struct Values {
    RowField<double> before, after;  // u and u'
    Region inside;                   // u' < 0
};

constexpr double kSame = 1e-9;  // of K: filtering K gives it but for rounding

class Combination {
  public:
    Combination(const RowField<float>& field, const RowField<float>& tool, const PolygonEdit& edit)
        : field_(field), tool_(tool), cut_(edit.cut), scale_(std::ldexp(1.0, edit.level)) {}

    Values on(const Region& where) const {
        Values values;
        values.before.K = values.after.K = field_.K;
        values.inside = withRows(where.firstRow, where.endRow() - 1);
        for (std::int32_t y = where.firstRow; y < where.endRow(); ++y)
            if (!where.row(y).empty()) row(y, where.row(y), values);
        return values;
    }

  private:
    // Where the tool is far, u stays to the bit: the spline of a fit may lie a little beyond ±K.
    double combined(double u, double t) const {
        const double K = field_.K, tool = scale_ * t * K / tool_.K;
        if (tool >= K) return u;
        const double full = cut_ ? K : -K;
        if (tool <= -K) return std::abs(u - full) < kSame * K ? u : full;
        return cut_ ? std::max(u, -tool) : std::min(u, tool);
    }

    void row(std::int32_t y, const Spans& spans, Values& values) const {
        ThreeRows<float> c(field_, y), d(tool_, y);
        RowReader<float> gapOfField(field_.find(y), field_.K), gapOfTool(tool_.find(y), tool_.K);
        Row<double>&before = values.before.rows[y], &after = values.after.rows[y];
        Spans& inside = values.inside.rows[static_cast<std::size_t>(y - values.inside.firstRow)];
        std::vector<double> u, t;
        for (std::size_t i = 0; i < spans.size(); ++i) {
            const auto [first, last] = spans[i];
            c.read(first, last);
            d.read(first, last);
            threeTaps(c, 4.0 / 6, 1.0 / 6, u);
            threeTaps(d, 4.0 / 6, 1.0 / 6, t);
            for (std::size_t k = 0; k < u.size(); ++k) {
                before.values.push_back(u[k]);
                after.values.push_back(combined(u[k], t[k]));
                const std::int32_t x = first + static_cast<std::int32_t>(k);
                if (after.values.back() < 0) inside.push_back({x, x});
            }
            double gap[2];
            gapOfField.read(last + 1, std::span(&gap[0], 1));
            gapOfTool.read(last + 1, std::span(&gap[1], 1));
            const bool insideAfter = combined(gap[0], gap[1]) < 0;
            if (insideAfter && i + 1 < spans.size()) inside.push_back({last + 1, spans[i + 1].first - 1});
            before.runs.push_back({first, last, gap[0] < 0});
            after.runs.push_back({first, last, insideAfter});
        }
        normalise(inside);
    }

    const RowField<float>&field_, &tool_;
    bool cut_;
    double scale_;
};

bool anyChange(const Values& values) {
    for (const auto& [y, row] : values.after.rows)
        if (row.values != values.before.find(y)->values) return true;
    return false;
}

// ---- what is known ----

// Nodes whose 16 control points lie in the region.
Region nodesOf(const Region& known) {
    Region nodes = withRows(known.firstRow, known.endRow() - 1);
    for (std::int32_t y = nodes.firstRow; y < nodes.endRow(); ++y) {
        Spans common = known.row(y);
        for (const std::int32_t other : {y - 1, y + 1, y + 2})
            common = intersection(common, known.row(other));
        Spans& out = nodes.rows[static_cast<std::size_t>(y - nodes.firstRow)];
        for (const Span& span : common)
            if (span.last - span.first >= 3) out.push_back({span.first + 1, span.last - 2});
    }
    return nodes;
}

// Of `nodes` those with a corner at which |u'| < limit and, with `untouched`, those at whose corners u' = u.
Region kept(const Region& nodes, const Values& values, double limit, bool untouched) {
    Region out = withRows(nodes.firstRow, nodes.endRow() - 1);
    std::vector<double> u[2], v[2];
    for (std::int32_t y = nodes.firstRow; y < nodes.endRow(); ++y) {
        const double K = values.after.K;
        RowReader<double> before[2] = {{values.before.find(y), K}, {values.before.find(y + 1), K}},
                          after[2] = {{values.after.find(y), K}, {values.after.find(y + 1), K}};
        for (const Span& span : nodes.row(y)) {
            const auto size = static_cast<std::size_t>(span.last - span.first + 2);
            for (std::size_t r = 0; r < 2; ++r) {
                u[r].resize(size);
                v[r].resize(size);
                before[r].read(span.first, u[r]);
                after[r].read(span.first, v[r]);
            }
            for (std::size_t i = 0; i + 1 < size; ++i) {
                bool near = false, same = true;
                for (const std::size_t r : {0, 1})
                    for (const std::size_t k : {i, i + 1}) {
                        near = near || std::abs(v[r][k]) < limit;
                        same = same && v[r][k] == u[r][k];
                    }
                const std::int32_t x = span.first + static_cast<std::int32_t>(i);
                if (near || (untouched && same))
                    out.rows[static_cast<std::size_t>(y - out.firstRow)].push_back({x, x});
            }
        }
    }
    for (Spans& row : out.rows) normalise(row);
    return out;
}

// ---- control points ----

bool sameAround(const ThreeRows<double>& u, const ThreeRows<double>& v, std::size_t i) {
    const auto same = [&](const std::vector<double>& a, const std::vector<double>& b) {
        return a[i - 1] == b[i - 1] && a[i] == b[i] && a[i + 1] == b[i + 1];
    };
    return same(u.below, v.below) && same(u.here, v.here) && same(u.above, v.above);
}

Row<float> controlPoints(const RowField<float>& field, const Values& values, std::int32_t y,
                         const Spans& spans) {
    ThreeRows<double> u(values.before, y), v(values.after, y);
    RowReader<float> old(field.find(y), field.K);
    Spans oldKnown;
    if (const Row<float>* row = field.find(y))
        for (const KnownRun& run : row->runs) oldKnown.push_back({run.first, run.last});
    SpanCursor isOld(oldKnown), inside(values.inside.row(y));
    Row<float> made;
    std::vector<double> c, fitted;
    for (const auto& [first, last] : spans) {
        c.resize(static_cast<std::size_t>(last - first + 1));
        old.read(first, c);
        u.read(first, last);
        v.read(first, last);
        std::vector<bool> stays(c.size());
        for (std::size_t i = 0; i < c.size(); ++i)
            stays[i] = isOld.contains(first + static_cast<std::int32_t>(i)) && sameAround(u, v, i + 1);
        threeTaps(v, 8.0 / 6, -1.0 / 6, fitted);
        for (std::size_t i = 0; i < c.size(); ++i)
            made.values.push_back(static_cast<float>(stays[i] ? c[i] : fitted[i]));
        made.runs.push_back({first, last, inside.contains(last + 1)});
    }
    return made;
}

RowField<float> fieldOf(const RowField<float>& old, const Values& values, const Region& known) {
    RowField<float> field;
    field.K = old.K;
    field.frame = old.frame;
    for (std::int32_t y = known.firstRow; y < known.endRow(); ++y)
        if (!known.row(y).empty()) field.rows[y] = controlPoints(old, values, y, known.row(y));
    return field;
}

// ---- origin ----

// 0, or what brings control points from `low` to -1 or above, of a lattice whose domain ends at `high`.
std::int64_t shiftFor(std::int64_t low, std::int64_t high) {
    if (low >= -1) return 0;
    std::int64_t unit = 1;
    while (unit < high - low + 1) unit *= 2;
    return unit;
}

RowField<float> atOrigin(RowField<float> field) {
    const Bounds box = field.bounds();
    std::int32_t shift[2];
    for (int axis = 0; axis < 2; ++axis) {
        const std::int64_t unit = shiftFor(box.first[axis], box.last[axis]);
        if (box.last[axis] + unit > kMostPosition)
            throw InputError(
                fmt::format("the shape would reach to pixel {}, and {} is the last one of the "
                            "lattice; make curves of larger pixels",
                            box.last[axis] + unit, kMostPosition));
        shift[axis] = static_cast<std::int32_t>(unit);
    }
    if (shift[0] == 0 && shift[1] == 0) return field;
    Frame frame = field.frame;
    frame.origin = frame.toWorld({-static_cast<double>(shift[0]), -static_cast<double>(shift[1])});
    return shifted(field, shift[0], shift[1], frame);
}

}  // namespace

std::optional<Fitted> editedFit(const Fitted& fitted, const PolygonEdit& edit, const Progress& progress) {
    const RowField<float>& field = fitted.field;
    const RowField<float> tool = toolOnLattice(fitted, edit, progress);
    requireFewRows(field, tool);
    const Region knownOfField = knownRegion(field), knownOfTool = knownRegion(tool);
    const Values values = Combination(field, tool, edit).on(dilated(unite(knownOfField, knownOfTool), 1, 1));
    if (values.inside.empty()) throw InputError("takes away all that there is; nothing would be left");
    if (!anyChange(values)) return std::nullopt;
    const double limit = fitted.method == Fit::binary ? 0 : field.K * fitted.band / fitted.halfWidth;
    const Region nodes =
        unite(stabbedNodes(values.inside), unite(kept(nodesOf(knownOfField), values, limit, true),
                                                 kept(nodesOf(knownOfTool), values, limit, false)));
    Fitted result = fitted;
    result.field = fieldOf(field, values, knownAround(nodes));
    repairSigns(result.field, values.inside, fitted.method, fitted.halfWidth, result.report, progress);
    result.field = atOrigin(std::move(result.field));
    return result;
}

}  // namespace isowave::curves2d
