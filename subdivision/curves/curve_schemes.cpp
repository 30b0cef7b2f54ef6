#include "subdivision/curves/curve_schemes.h"

#include <algorithm>
#include <cassert>
#include <charconv>

#include "isowave/error.h"
#include "subdivision/filters/masks.h"

namespace isowave::subdivision {

namespace {

using Family = CurveScheme::Family;
using Fit = CurveScheme::Fit;

Node at(int i) { return {i, 0}; }

int fewestOpen(const CurveScheme& scheme) {
    return scheme.family == Family::DynLevinGregory ? 2 : scheme.degree + 1;
}

int openFineSize(const CurveScheme& scheme, int n) {
    return scheme.family == Family::DynLevinGregory ? 2 * n - 1 : 2 * n - scheme.degree;
}

// ---- P of an open curve ----

// Knots 0 .. n-degree in steps of 1/`steps`, the first and the last repeated degree + 1 times.
std::vector<Rational> clampedKnots(int degree, int intervals, int steps) {
    std::vector<Rational> knots(static_cast<std::size_t>(degree), Rational(0));
    for (int k = 0; k <= intervals * steps; ++k) knots.emplace_back(Rational(k, steps));
    knots.insert(knots.end(), static_cast<std::size_t>(degree), Rational(intervals));
    return knots;
}

// The fine control point i is the blossom of the coarse spline at the fine knots i+1 .. i+degree (the Oslo
// algorithm): de Boor's recursion with another argument u in each round,
//   c_j <- ((t[j+d+1-r] - u) c_{j-1} + (u - t[j]) c_j) / (t[j+d+1-r] - t[j]),     r = 1 .. d.
Diagram knotInsertionRow(int degree, int n, int i) {
    const auto coarse = clampedKnots(degree, n - degree, 1), fine = clampedKnots(degree, n - degree, 2);
    const auto knot = [&](int k) -> const Rational& { return coarse[static_cast<std::size_t>(k)]; };
    const auto fineKnot = [&](int k) -> const Rational& { return fine[static_cast<std::size_t>(k)]; };
    // Any interval under the fine basis function will do: take the first that is not empty.
    int l = i;
    while (fineKnot(l) == fineKnot(l + 1)) ++l;
    int k = degree;
    while (knot(k + 1) <= fineKnot(l)) ++k;

    std::vector<Diagram> c;
    for (int j = k - degree; j <= k; ++j) c.push_back(Diagram::delta(at(j)));
    for (int r = 1; r <= degree; ++r) {
        const Rational& u = fineKnot(i + r);
        for (int j = k; j >= k - degree + r; --j) {
            const Rational& low = knot(j);
            const Rational& high = knot(j + degree + 1 - r);
            const auto place = static_cast<std::size_t>(j - (k - degree));
            Diagram mixed = c[place].scaled((u - low) / (high - low));
            mixed.add(c[place - 1], (high - u) / (high - low));
            c[place] = mixed;
        }
    }
    return c.back();
}

FiniteSubdivision openSubdivision(const CurveScheme& scheme, int n) {
    FiniteSubdivision p;
    for (int i = 0; i < openFineSize(scheme, n); ++i) {
        p.addRow(at(i), scheme.family == Family::DynLevinGregory ? fourPointRow(n, i)
                                                                 : knotInsertionRow(scheme.degree, n, i));
    }
    return p;
}

// ---- A, B, Q of an open curve ----

// Twice the position around which row j of A is centred, counted from the nearer end: the vertex node (cubic:
// f0, f2, f3, f5, f7 ..; dlg: f0, f2, f4 ..) or, for Chaikin, the middle of the pair that the point becomes.
int twiceVertex(const CurveScheme& scheme, int n, int j) {
    const int last = 2 * (openFineSize(scheme, n) - 1);
    if (2 * j > n - 1) return last - twiceVertex(scheme, n, n - 1 - j);
    if (scheme.family == Family::DynLevinGregory) return 4 * j;
    if (j == 0) return 0;
    if (scheme.degree == 2) return 4 * j - 1;
    return j == 1 ? 4 : 4 * j - 2;
}

// The fine points i with |2i - twiceCentre| <= reach, where the reach shrinks to stay on the curve.
std::vector<Node> centredWindow(int fine, int twiceCentre, int reach) {
    reach = std::min({reach, twiceCentre, 2 * (fine - 1) - twiceCentre});
    std::vector<Node> window;
    for (int i = 0; i < fine; ++i) {
        if (std::abs(2 * i - twiceCentre) <= reach) window.push_back(at(i));
    }
    return window;
}

// O(3). Moving a kept point by delta changes its own detail by -delta and that of the edge node k beside it
// by -p_k delta. Least squares over the three gives delta = sum of p_k d_k / (1 + sum of p_k^2).
Diagram refinedRow(const Diagram& column, Node vertex,
                   const std::vector<std::pair<Node, Diagram>>& residuals) {
    Rational below = 1;
    for (const auto& [edge, b] : residuals) below += column[edge] * column[edge];
    Diagram row = Diagram::delta(vertex);
    for (const auto& [edge, b] : residuals) row.add(b, column[edge] / below);
    return row;
}

// The residual at an edge node of an interpolating subdivision: f_e - (P f_v)_e.
Diagram residualRow(const FiniteSubdivision& p, int edge) {
    Diagram b = Diagram::delta(at(edge));
    for (const auto& [coarse, weight] : p.row(at(edge))) b.add(at(2 * coarse.x), -weight);
    return b;
}

Diagram openA(const CurveScheme& scheme, const FiniteSubdivision& p, int n, int j) {
    const int fine = openFineSize(scheme, n), centre = twiceVertex(scheme, n, j);
    if (j == 0 || j == n - 1) return Diagram::delta(at(j == 0 ? 0 : fine - 1));
    if (scheme.fit == Fit::Refined) {
        return refinedRow(
            p.column(at(j)), at(2 * j),
            {{at(2 * j - 1), residualRow(p, 2 * j - 1)}, {at(2 * j + 1), residualRow(p, 2 * j + 1)}});
    }
    // A four-point window needs no narrowing: the kept point alone solves AP = I, so every clipped one is
    // feasible.
    if (scheme.family == Family::DynLevinGregory) {
        std::vector<Node> window;
        for (int i = std::max(0, 2 * j - scheme.width / 2); i <= std::min(fine - 1, 2 * j + scheme.width / 2);
             ++i) {
            window.push_back(at(i));
        }
        return *leastNormRow(p, at(j), window);
    }
    // Beside an end a narrow window may hold too little; it grows by a point on either side until it does
    // not.
    for (int reach = scheme.width - 1;; reach += 2) {
        const auto window = centredWindow(fine, centre, reach);
        if (auto row = leastNormRow(p, at(j), window)) return *row;
        if (reach > 2 * fine) break;
    }
    // Only on the shortest curves: the centred window is already the widest, so let it reach to both ends.
    std::vector<Node> all;
    for (int i = 0; i < fine; ++i) all.push_back(at(i));
    const auto row = leastNormRow(p, at(j), all);
    assert(row);
    return *row;
}

// Twice the middle of row k of B, and the number of its taps: degree + 2, the (degree + 1)-th difference
// inside.
std::ptrdiff_t twiceDetail(const CurveScheme& scheme, std::ptrdiff_t k) {
    if (scheme.family == Family::DynLevinGregory) return 4 * k + 2;
    return scheme.degree == 2 ? 4 * k + 3 : 4 * k + 4;
}

Diagram openB(const CurveScheme& scheme, const FiniteSubdivision& p, int n, int k) {
    if (scheme.family == Family::DynLevinGregory) return residualRow(p, 2 * k + 1);
    const int fine = openFineSize(scheme, n);
    const auto row =
        annihilator(p, centredWindow(fine, static_cast<int>(twiceDetail(scheme, k)), scheme.degree + 1));
    assert(row);
    return *row;
}

Diagram openQ(const std::vector<Diagram>& b, std::size_t k, int fine, int twiceCentre) {
    for (int reach = 0; reach <= 2 * fine; ++reach) {
        std::vector<Node> window;
        for (int i = 0; i < fine; ++i) {
            if (std::abs(2 * i - twiceCentre) <= reach) window.push_back(at(i));
        }
        if (window.empty()) continue;
        if (auto q = dualColumn(b, k, window)) return *q;
    }
    assert(false && "the rows of B are dependent");
    return {};
}

// ---- doubles ----

FilterRow toRow(const Diagram& diagram, std::ptrdiff_t origin) {
    FilterRow row;
    if (diagram.empty()) return row;
    const Extent box = extent(diagram);
    row.first = box.low.x - origin;
    for (int x = box.low.x; x <= box.high.x; ++x) row.weights.push_back(toDouble(diagram[at(x)]));
    return row;
}

std::vector<Diagram> rowsFromColumns(const std::vector<Diagram>& columns, int fine) {
    std::vector<Diagram> rows(static_cast<std::size_t>(fine));
    for (std::size_t c = 0; c < columns.size(); ++c) {
        for (const auto& [node, value] : columns[c]) {
            rows[static_cast<std::size_t>(node.x)].add(at(static_cast<int>(c)), value);
        }
    }
    return rows;
}

FilterBank allHead(const std::vector<Diagram>& rows) {
    FilterBank bank;
    for (const auto& row : rows) bank.head.push_back(toRow(row, 0));
    return bank;
}

// Finds what repeats: from the middle outwards, as long as row k + period is row k moved by `step`.
// Nothing when fewer than three periods do, or when a row of the head reads past the middle of the input.
std::optional<FilterBank> repeating(const std::vector<Diagram>& rows, int inputs, int period, int step) {
    const int count = static_cast<int>(rows.size());
    const auto row = [&](int k) -> const Diagram& { return rows[static_cast<std::size_t>(k)]; };
    const auto repeats = [&](int k) { return row(k).shifted(at(step)) == row(k + period); };
    int begin = count / 2, end = count / 2;  // rows [begin, end + period) repeat
    while (begin > 0 && repeats(begin - 1)) --begin;
    while (end + period < count && repeats(end)) ++end;
    if (end - begin < 3 * period) return std::nullopt;
    // Head and tail do not depend on the number of rows between them: a longer curve has the same ones.
    FilterBank bank;
    bank.step = step;
    for (int k = 0; k < begin; ++k) bank.head.push_back(toRow(row(k), 0));
    for (int k = begin; k < begin + period; ++k) bank.inner.push_back(toRow(row(k), 0));
    for (int k = end + period; k < count; ++k) bank.tail.push_back(toRow(row(k), inputs));
    return bank;
}

std::optional<CurveFilters::Maps> repeatingMaps(const OpenSystem& open, int n) {
    const int fine = static_cast<int>(open.p.rows().size());
    const auto a = repeating(open.system.a, fine, 1, 2), b = repeating(open.system.b, fine, 1, 2);
    const auto p = repeating(rowsFromColumns(open.system.p, fine), n, 2, 1);
    const auto q = repeating(rowsFromColumns(open.system.q, fine), fine - n, 2, 1);
    if (!a || !b || !p || !q) return std::nullopt;
    return CurveFilters::Maps{*a, *b, *p, *q};
}

CurveFilters::Maps mapsOfSize(const OpenSystem& open) {
    const int fine = static_cast<int>(open.p.rows().size());
    return {allHead(open.system.a), allHead(open.system.b), allHead(rowsFromColumns(open.system.p, fine)),
            allHead(rowsFromColumns(open.system.q, fine))};
}

// Row i of P (or Q) inside: weight column[i - 2t] from the coarse t, for i = 0 and 1.
std::vector<FilterRow> parityRows(const Diagram& column) {
    std::vector<FilterRow> rows;
    for (const int parity : {0, 1}) {
        Diagram row;
        for (const auto& [node, value] : column) {
            if ((node.x & 1) == parity) row.add(at((parity - node.x) / 2), value);
        }
        rows.push_back(toRow(row, 0));
    }
    return rows;
}

CurveFilters::Maps closedMaps(const Filters& f) {
    CurveFilters::Maps maps;
    maps.a.inner = {toRow(f.a, 0)};
    maps.b.inner = {toRow(f.b[0], 0)};
    maps.a.step = maps.b.step = 2;
    maps.p.inner = parityRows(f.mask.p);
    maps.q.inner = parityRows(f.q[0]);
    return maps;
}

}  // namespace

const std::vector<std::string>& curveSchemeNames() {
    static const std::vector<std::string> names = {"chaikin-4", "chaikin-8", "cubic-3",     "cubic-7",
                                                   "cubic-11",  "dlg-trial", "dlg-refined", "dlg-optimal"};
    return names;
}

CurveScheme curveScheme(std::string_view name) {
    const auto unknown = [&](const std::string& why) {
        std::string known;
        for (const auto& each : curveSchemeNames()) known += (known.empty() ? "" : ", ") + each;
        return InputError(
            "scheme '" + std::string(name) + "'",
            why + "; the known ones are " + known + " (chaikin-W and cubic-W for other widths W)");
    };
    CurveScheme scheme;
    scheme.name = name;
    if (name == "dlg" || name == "dlg-refined" || name == "dlg-trial" || name == "dlg-optimal") {
        scheme.family = Family::DynLevinGregory;
        scheme.mask = namedMask("dlg");
        scheme.fit = name == "dlg" || name == "dlg-refined" ? Fit::Refined : Fit::LeastNorm;
        scheme.width = name == "dlg-trial" ? 1 : 9;
        if (name == "dlg") scheme.name = "dlg-refined";
        return scheme;
    }
    const std::size_t dash = name.find('-');
    const std::string_view base = name.substr(0, dash);
    if (base != "chaikin" && base != "cubic") throw unknown("is not known");
    scheme.mask = namedMask(base);
    scheme.degree = base == "chaikin" ? 2 : 3;
    scheme.width = base == "chaikin" ? 4 : 7;
    if (dash != std::string_view::npos) {
        const std::string_view digits = name.substr(dash + 1);
        const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), scheme.width);
        if (read.ec != std::errc() || read.ptr != digits.data() + digits.size())
            throw unknown("has no width");
        if (scheme.width > 41) throw unknown("is wider than 41 taps");
        // Says what is wrong with a width that does not exist.
        construct(scheme.mask, scheme.width);
    } else {
        scheme.name += "-" + std::to_string(scheme.width);
    }
    return scheme;
}

CurveScheme ownScheme(const Mask& mask, int width) {
    CurveScheme scheme;
    scheme.name = mask.name + "-" + std::to_string(width);
    scheme.family = Family::OwnMask;
    scheme.mask = mask;
    scheme.width = width;
    return scheme;
}

CurveScheme maskScheme(std::string_view taps, int width) {
    const Mask mask = customMask(Lattice::Line, parseRationals(taps));
    const int taken = width ? width : smallestWidth(mask, 41).value_or(1);
    construct(mask, taken);  // says what is wrong
    return ownScheme(mask, taken);
}

Filters interiorFilters(const CurveScheme& scheme) {
    if (scheme.fit != Fit::Refined) return construct(scheme.mask, scheme.width);
    const Filters trial = construct(scheme.mask, 1);
    const Diagram right = trial.b[0], left = right.shifted(at(-2));
    return constructWith(scheme.mask, refinedRow(scheme.mask.p, at(0), {{at(-1), left}, {at(1), right}}));
}

OpenSystem openSystem(const CurveScheme& scheme, int n) {
    if (scheme.family == Family::OwnMask) {
        throw InputError(
            "scheme '" + scheme.name + "'",
            "is for closed curves: a mask does not say what happens at an end; take a named scheme");
    }
    if (n < fewestOpen(scheme)) {
        throw InputError("scheme '" + scheme.name + "'",
                         std::to_string(n) + " coarse points are too few for an open " + "curve; it needs " +
                             std::to_string(fewestOpen(scheme)));
    }
    const int fine = openFineSize(scheme, n);
    OpenSystem open{openSubdivision(scheme, n), {}, {}};
    std::vector<std::pair<Node, Diagram>> a;
    for (int j = 0; j < n; ++j) {
        a.emplace_back(at(j), openA(scheme, open.p, n, j));
        open.system.a.push_back(a.back().second);
        open.system.p.push_back(open.p.column(at(j)));
    }
    for (int k = 0; k < fine - n; ++k) {
        open.system.b.push_back(openB(scheme, open.p, n, k));
        open.detailNode.push_back(static_cast<int>(twiceDetail(scheme, k) / 2));
    }
    for (std::size_t k = 0; k < open.system.b.size(); ++k) {
        const int centre = static_cast<int>(twiceDetail(scheme, static_cast<std::ptrdiff_t>(k)));
        open.system.q.push_back(lifted(open.p, a, openQ(open.system.b, k, fine, centre)));
    }
    if (scheme.family == Family::BSpline) {
        for (std::size_t k = 0; k < open.system.b.size(); ++k) {
            const Rational scale = open.system.q[k].largest();
            open.system.q[k] = open.system.q[k].scaled(1 / scale);
            open.system.b[k] = open.system.b[k].scaled(scale);
        }
    }
    const Proof proof = prove(open.system, static_cast<std::size_t>(fine));
    if (!proof)
        throw InputError("scheme '" + scheme.name + "'",
                         "has no filters for " + std::to_string(n) + " coarse points: " + proof.failure);
    return open;
}

System closedSystem(const CurveScheme& scheme, int n) {
    const Filters f = interiorFilters(scheme);
    const auto around = [n](const Diagram& diagram, int t) {
        Diagram result;
        for (const auto& [node, value] : diagram) {
            const int fine = 2 * n;
            result.add(at(((node.x + 2 * t) % fine + fine) % fine), value);
        }
        return result;
    };
    System system;
    for (int t = 0; t < n; ++t) {
        system.a.push_back(around(f.a, t));
        system.b.push_back(around(f.b[0], t));
        system.p.push_back(around(f.mask.p, t));
        system.q.push_back(around(f.q[0], t));
    }
    return system;
}

CurveFilters::CurveFilters(const CurveScheme& scheme, bool closed) : scheme_(scheme), closed_(closed) {
    if (closed) {
        long_ = closedMaps(interiorFilters(scheme));
        return;
    }
    // Sizes of their own until the two ends do not meet: then head, middle and tail serve every longer curve.
    // (A product of two rows reads no further than both are wide, so what holds at this size holds at all
    // above.)
    for (int n = fewestOpen(scheme);; ++n) {
        const OpenSystem open = openSystem(scheme, n);
        if (auto maps = repeatingMaps(open, n)) {
            long_ = *maps;
            return;
        }
        short_.push_back(mapsOfSize(open));
    }
}

std::size_t CurveFilters::fineSize(std::size_t n) const {
    return closed_ ? 2 * n
                   : static_cast<std::size_t>(openFineSize(scheme_, 0) + 2 * static_cast<std::ptrdiff_t>(n));
}

std::size_t CurveFilters::fewestCoarse() const {
    return closed_ ? 1 : static_cast<std::size_t>(fewestOpen(scheme_));
}

std::optional<std::size_t> CurveFilters::coarseSize(std::size_t m) const {
    const std::size_t excess = closed_ ? 0 : static_cast<std::size_t>(-openFineSize(scheme_, 0));
    const std::size_t n = (m + excess + 1) / 2;  // the least n with fineSize(n) >= m
    if (n < fewestCoarse() || n >= m) return std::nullopt;
    return n;
}

int CurveFilters::mostLevels(std::size_t m) const {
    int levels = 0;
    while (const auto n = coarseSize(m)) {
        m = *n;
        ++levels;
    }
    return levels;
}

std::size_t CurveFilters::fewestPoints(int levels) const {
    // coarseSize never decreases as m grows, so the least m that leads to at least `needed` coarse points is
    // found going up from there; it is at most 2 needed.
    std::size_t needed = fewestCoarse();
    for (; levels > 0; --levels) {
        std::size_t m = needed + 1;
        while (coarseSize(m).value_or(0) < needed) ++m;
        needed = m;
    }
    return needed;
}

const CurveFilters::Maps& CurveFilters::maps(std::size_t n) const {
    assert(n >= fewestCoarse());
    const std::size_t index = n - fewestCoarse();
    return index < short_.size() ? short_[index] : long_;
}

std::size_t CurveFilters::virtualDetail(std::size_t n) const {
    const std::size_t details = fineSize(n) - n;
    assert(details > 0);
    // Two beside the middle: where halving puts what the virtual point of the level before has moved, this one is not.
    constexpr std::size_t kBesideMiddle = 2;
    return closed_ ? details - 1 : std::min(details / 2 + kBesideMiddle, details - 1);
}

std::size_t CurveFilters::virtualPoint(std::size_t n) const {
    if (closed_) return 2 * n - 1;
    return static_cast<std::size_t>(twiceDetail(scheme_, static_cast<std::ptrdiff_t>(virtualDetail(n))) / 2);
}

}  // namespace isowave::subdivision
