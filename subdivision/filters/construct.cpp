#include "subdivision/filters/construct.h"

#include <algorithm>
#include <cassert>
#include <set>

#include "isowave/error.h"
#include "subdivision/filters/exact_solve.h"

namespace isowave::subdivision {

namespace {

int floorHalf(int v) { return (v - (v & 1)) / 2; }
int ceilHalf(int v) { return (v + (v & 1)) / 2; }

// Every coarse t at which `moving`, shifted by 2t, can share a node with `fixed`.
std::vector<Node> overlaps(const Diagram& fixed, const Diagram& moving) {
    if (fixed.empty() || moving.empty()) return {};
    const Extent f = extent(fixed), m = extent(moving);
    std::vector<Node> shifts;
    for (int y = ceilHalf(f.low.y - m.high.y); y <= floorHalf(f.high.y - m.low.y); ++y) {
        for (int x = ceilHalf(f.low.x - m.high.x); x <= floorHalf(f.high.x - m.low.x); ++x)
            shifts.push_back({x, y});
    }
    return shifts;
}

std::string write(Node node) { return "(" + std::to_string(node.x) + "," + std::to_string(node.y) + ")"; }

// The product of a row with every column, shifted: `one` at shift 0, else 0.
void check(Proof& proof, const char* product, const Diagram& row, const Diagram& column, bool one) {
    auto shifts = overlaps(row, column);
    if (one && std::find(shifts.begin(), shifts.end(), Node{}) == shifts.end()) shifts.push_back({});
    for (const Node t : shifts) {
        ++proof.products;
        const Rational expected = one && t == Node{} ? 1 : 0;
        const Rational found = inner(row, column.shifted(2 * t));
        if (found != expected && proof.failure.empty()) {
            proof.failure = std::string(product) + " at shift " + write(t) + " is " + toString(found) +
                            ", not " + toString(expected);
        }
    }
}

// The x of least norm on `window` whose inner product with every shift of p that touches the window is 1 at
// shift 0 and 0 else.
std::optional<Diagram> leastNormRow(const Mask& mask, const std::vector<Node>& window) {
    const auto touching =
        overlaps(Diagram::on(window, std::vector<Rational>(window.size(), Rational(1))), mask.p);
    Matrix e;
    std::vector<Rational> r;
    bool hasOne = false;
    for (const Node t : touching) {
        const Diagram column = mask.p.shifted(2 * t);
        std::vector<Rational> row;
        bool touches = false;
        for (const Node n : window) {
            row.push_back(column[n]);
            touches = touches || row.back() != 0;
        }
        if (!touches) continue;
        e.push_back(row);
        r.emplace_back(t == Node{} ? 1 : 0);
        hasOne = hasOne || t == Node{};
    }
    if (!hasOne) return std::nullopt;
    const auto x = leastNorm(e, r);
    if (!x) return std::nullopt;
    return Diagram::on(window, *x);
}

// Polynomials in z, lowest power first, for the common factor of the even and the odd taps.
using Polynomial = std::vector<Rational>;
void trim(Polynomial& f) {
    while (!f.empty() && f.back() == 0) f.pop_back();
}

// Euclid. The result is monic; powers of z, which are only shifts, are divided out first.
Polynomial commonFactor(Polynomial f, Polynomial g) {
    for (Polynomial* each : {&f, &g}) {
        trim(*each);
        const auto first = std::find_if(each->begin(), each->end(), [](const Rational& v) { return v != 0; });
        each->erase(each->begin(), first);
    }
    while (!g.empty()) {
        while (f.size() >= g.size()) {
            const Rational factor = f.back() / g.back();
            const std::size_t at = f.size() - g.size();
            for (std::size_t k = 0; k < g.size(); ++k) f[at + k] -= factor * g[k];
            f.pop_back();  // exactly 0
            trim(f);
        }
        std::swap(f, g);
    }
    const Rational lead = f.empty() ? Rational(1) : f.back();
    for (auto& value : f) value /= lead;
    return f;
}

std::string write(const Polynomial& f) {
    std::string text;
    for (std::size_t k = 0; k < f.size(); ++k) {
        if (f[k] == 0) continue;
        const bool minus = f[k] < 0;
        if (text.empty()) {
            text += minus ? "-" : "";
        } else {
            text += minus ? " - " : " + ";
        }
        const Rational size = abs(f[k]);
        if (k == 0 || size != 1) text += toString(size) + (k == 0 ? "" : " ");
        if (k > 0) text += k == 1 ? "z" : "z^" + std::to_string(k);
    }
    return text;
}

// A P = I has a solution of *some* width if and only if the even and the odd taps have no common factor
// (Bezout). With a common factor g every sequence that g annihilates is mapped to 0, so P is not injective.
std::string sharedFactor(const Diagram& p) {
    const Extent box = extent(p);
    Polynomial even, odd;
    for (int x = 2 * floorHalf(box.low.x); x <= box.high.x + 1; x += 2) {
        even.push_back(p[{x, 0}]);
        odd.push_back(p[{x + 1, 0}]);
    }
    const Polynomial g = commonFactor(even, odd);
    return g.size() > 1 ? write(g) : "";
}

// The rank of P on the torus of n x n coarse nodes, against n^2.
bool isInjectiveOnTorus(const Mask& mask, int n) {
    const auto index = [n](Node fine) {
        const int side = 2 * n;
        return static_cast<std::size_t>(((fine.y % side + side) % side) * side +
                                        ((fine.x % side + side) % side));
    };
    Matrix columns;
    for (int y = 0; y < n; ++y) {
        for (int x = 0; x < n; ++x) {
            auto& column = columns.emplace_back(static_cast<std::size_t>(4 * n * n), Rational(0));
            for (const auto& [node, value] : mask.p.shifted({2 * x, 2 * y})) column[index(node)] += value;
        }
    }
    return rank(columns) == n * n;
}

int parityOfTaps(const Mask& mask) {
    const Extent box = extent(mask.p);
    return (box.high.x - box.low.x + 1) % 2;
}

// B and a first Q0, with B P = 0 and B Q0 = I.
struct LocalPair {
    std::vector<Node> details;
    std::vector<Diagram> b, q;
    bool needsLift = true;  // Q = (I - P A) Q0; false when A Q0 = 0 already
    bool rescale = false;   // the largest value of each Q column becomes +1
};

LocalPair trivialPair(const Mask& mask) {
    LocalPair pair;
    pair.details = detailNodes(mask.lattice);
    for (const Node e : pair.details) {
        // d_e = f_e - (P c)_e with c_t = f_2t; the weight of c_t in (P c)_e is p[e - 2t].
        Diagram b = Diagram::delta(e);
        for (const Node t : overlaps(Diagram::delta(e), mask.p)) b.add(2 * t, -mask.p[e - 2 * t]);
        pair.b.push_back(b);
        pair.q.push_back(Diagram::delta(e));
    }
    return pair;
}

LocalPair flipPair(const Diagram& p, const Diagram& a) {
    const auto flip = [](const Diagram& from) {
        Diagram to;
        for (const auto& [o, value] : from) to.add({1 - o.x, 0}, o.x % 2 == 0 ? value : Rational(-value));
        return to;
    };
    LocalPair pair;
    pair.details = {{1, 0}};
    pair.b = {flip(p)};
    pair.q = {flip(a)};
    pair.needsLift = false;
    pair.rescale = true;
    return pair;
}

Diagram product(const Diagram& alongX, const Diagram& alongY) {
    Diagram result;
    for (const auto& [i, u] : alongX) {
        for (const auto& [j, v] : alongY) result.add({i.x, j.x}, u * v);
    }
    return result;
}

// p(x, y) = u(x) v(y), if it is: rank 1.
std::optional<std::pair<Mask, Mask>> factors(const Mask& mask) {
    const auto& [pivot, value] = *mask.p.begin();
    Mask u{mask.name + " along x", Lattice::Line, {}}, v{mask.name + " along y", Lattice::Line, {}};
    for (const auto& [node, weight] : mask.p) {
        if (node.y == pivot.y) u.p.add({node.x, 0}, weight);
        if (node.x == pivot.x) v.p.add({node.y, 0}, weight / value);
    }
    if (product(u.p, v.p) != mask.p) return std::nullopt;
    // Share the factor so that each keeps constants, when the whole does: a column of P sums to the
    // dilation, 2.
    const Rational sum = u.p.sum();
    if (sum != 0) {
        u.p = u.p.scaled(2 / sum);
        v.p = v.p.scaled(sum / 2);
    }
    return std::pair(u, v);
}

// Details of a product: (edge along x) = q x p, (edge along y) = p x q, (face) = q x q; their duals are
// b x a, a x b, b x b.
std::optional<LocalPair> tensorPair(const Mask& mask, int width) {
    const auto uv = factors(mask);
    if (!uv) return std::nullopt;
    const auto line = [width](const Mask& each) -> std::optional<Filters> {
        const int parity = parityOfTaps(each);
        const auto smallest = smallestWidth(each, 41);
        if (!smallest) return std::nullopt;
        return construct(each, std::max(*smallest, 2 * width + 2 - parity));
    };
    const auto u = line(uv->first), v = line(uv->second);
    if (!u || !v) return std::nullopt;
    LocalPair pair;
    pair.details = detailNodes(Lattice::Quad);
    pair.b = {product(u->b[0], v->a), product(u->a, v->b[0]), product(u->b[0], v->b[0])};
    pair.q = {product(u->q[0], v->mask.p), product(u->mask.p, v->q[0]), product(u->q[0], v->q[0])};
    pair.rescale = true;
    return pair;
}

LocalPair oneTapPair(const Mask& mask, const Diagram& a0) {
    LocalPair pair;
    pair.details = detailNodes(mask.lattice);
    for (const Node e : pair.details) {
        // Row e of I - P A0: delta_e - sum over t of p[e - 2t] (a0 shifted to t).
        Diagram b = Diagram::delta(e);
        for (const Node t : overlaps(Diagram::delta(e), mask.p)) b.add(a0.shifted(2 * t), -mask.p[e - 2 * t]);
        // delta_e - (A0 at t, e)/a0 on the vertex node of every t.
        Diagram q = Diagram::delta(e);
        for (const Node t : overlaps(Diagram::delta(e), a0)) q.add(2 * t, -a0[e - 2 * t] / a0[{}]);
        pair.b.push_back(b);
        pair.q.push_back(q);
    }
    return pair;
}

LocalPair localPair(const Mask& mask, const Diagram& a, int width) {
    if (interpolates(mask)) return trivialPair(mask);
    if (mask.lattice == Lattice::Line) return flipPair(mask.p, a);
    if (mask.lattice == Lattice::Quad) {
        if (const auto tensor = tensorPair(mask, width)) return *tensor;
    }
    for (int w = 1; w <= 2; ++w) {
        if (const auto a0 = oneTapInverse(mask, w)) return oneTapPair(mask, *a0);
    }
    throw InputError(
        mask.name,
        "P has a left inverse, but no local B is known: the mask does not interpolate, is not a "
        "product of two masks on the line, and no left inverse of width 1 or 2 reads one vertex node "
        "only; use a mask of one of these three kinds");
}

// (I - P A) q:  q - sum over t of (a at t . q) (p at t).
Diagram lifted(const Mask& mask, const Diagram& a, const Diagram& q) {
    Diagram result = q;
    for (const Node t : overlaps(q, a)) result.add(mask.p.shifted(2 * t), -inner(a.shifted(2 * t), q));
    return result;
}

Filters complete(const Mask& mask, const Diagram& a, int width) {
    LocalPair pair = localPair(mask, a, width);
    Filters filters{mask, width, a, pair.details, pair.b, {}};
    for (std::size_t k = 0; k < pair.q.size(); ++k) {
        Diagram q = pair.needsLift ? lifted(mask, a, pair.q[k]) : pair.q[k];
        if (pair.rescale) {
            const Rational scale = q.largest();
            q = q.scaled(1 / scale);
            filters.b[k] = filters.b[k].scaled(scale);
        }
        filters.q.push_back(q);
    }
    const Proof proof = prove(filters);
    if (!proof) throw InputError(mask.name, "the construction does not hold: " + proof.failure);
    return filters;
}

[[noreturn]] void refuseWidth(const Mask& mask, int width) {
    if (mask.lattice == Lattice::Line) {
        if (const std::string factor = sharedFactor(mask.p); !factor.empty()) {
            throw InputError(mask.name,
                             "P is not injective: its even and odd taps share the factor " + factor +
                                 ", so P maps every sequence that this annihilates to 0 and no finite A "
                                 "exists at any width; change the mask");
        }
    } else {
        for (int n = 1; n <= 4; ++n) {
            if (isInjectiveOnTorus(mask, n)) continue;
            throw InputError(mask.name, "P is not injective: on the torus of " + std::to_string(n) + " x " +
                                            std::to_string(n) +
                                            " coarse nodes its columns are dependent, so no "
                                            "finite A exists at any width; change the mask");
        }
    }
    const int atMost = mask.lattice == Lattice::Line ? 41 : 4;
    const char* unit = mask.lattice == Lattice::Line ? " taps" : " rings";
    const auto smallest = smallestWidth(mask, atMost);
    throw InputError(mask.name,
                     "no A of width " + std::to_string(width) + " has AP = I; " +
                         (smallest ? "the smallest that exists has " + std::to_string(*smallest) + unit
                                   : "none was found up to " + std::to_string(atMost) + unit));
}

}  // namespace

bool interpolates(const Mask& mask) {
    for (const auto& [node, value] : mask.p) {
        if (isVertexNode(node) && node != Node{}) return false;
    }
    return mask.p[{}] == 1;
}

std::vector<Node> windowOfA(const Mask& mask, int width) {
    if (mask.lattice != Lattice::Line) return spiral(mask.lattice, {}, width);
    const Extent box = extent(mask.p);
    const int twiceFirst = box.low.x + box.high.x - (width - 1);  // twice the window's first tap
    std::vector<Node> nodes;
    for (int k = 0; k < width; ++k) nodes.push_back({floorHalf(twiceFirst) + k, 0});
    return nodes;
}

std::optional<Diagram> leastNormA(const Mask& mask, int width) {
    return leastNormRow(mask, windowOfA(mask, width));
}

std::optional<int> smallestWidth(const Mask& mask, int atMost) {
    const bool line = mask.lattice == Lattice::Line;
    for (int w = line ? 2 - parityOfTaps(mask) : 0; w <= atMost; w += line ? 2 : 1) {
        if (leastNormA(mask, w)) return w;
    }
    return std::nullopt;
}

std::optional<Diagram> oneTapInverse(const Mask& mask, int width) {
    std::vector<Node> window{{0, 0}};
    for (const Node n : windowOfA(mask, width)) {
        if (!isVertexNode(n)) window.push_back(n);
    }
    auto a0 = leastNormRow(mask, window);
    if (a0 && (*a0)[{}] == 0) a0.reset();
    return a0;
}

Proof prove(const Filters& f) {
    Proof proof;
    check(proof, "AP", f.a, f.mask.p, true);
    for (std::size_t i = 0; i < f.b.size(); ++i) check(proof, "BP", f.b[i], f.mask.p, false);
    for (std::size_t i = 0; i < f.q.size(); ++i) check(proof, "AQ", f.a, f.q[i], false);
    for (std::size_t i = 0; i < f.b.size(); ++i) {
        for (std::size_t j = 0; j < f.q.size(); ++j) check(proof, "BQ", f.b[i], f.q[j], i == j);
    }
    const std::size_t kinds = detailNodes(f.mask.lattice).size();
    if (proof.failure.empty() && (f.b.size() != kinds || f.q.size() != kinds)) {
        proof.failure = "the number of details is not that of the nodes between vertex nodes";
    }
    return proof;
}

Filters construct(const Mask& mask, int width) {
    const bool line = mask.lattice == Lattice::Line;
    if (width < (line ? 1 : 0)) {
        throw InputError(mask.name, "width " + std::to_string(width) + " is too small; widths count " +
                                        (line ? "taps and begin at 1" : "rings and begin at 0"));
    }
    if (width > (line ? 201 : 8)) {
        throw InputError(mask.name, "width " + std::to_string(width) + " is too large; the largest is " +
                                        (line ? "201 taps" : "8 rings"));
    }
    if (line && width % 2 != parityOfTaps(mask)) {
        throw InputError(mask.name, "width " + std::to_string(width) + " does not fit: the mask has an " +
                                        (parityOfTaps(mask) ? "odd" : "even") +
                                        " number of taps, and A is centred on it; take " +
                                        std::to_string(width + 1));
    }
    const auto a = leastNormA(mask, width);
    if (!a) refuseWidth(mask, width);
    return complete(mask, *a, width);
}

Filters constructWith(const Mask& mask, const Diagram& a) {
    Proof proof;
    check(proof, "AP", a, mask.p, true);
    if (!proof) throw InputError(mask.name, "the given A is not a left inverse of P: " + proof.failure);
    const Extent box = extent(a);
    const int width = mask.lattice == Lattice::Line ? box.high.x - box.low.x + 1 : a.width(mask.lattice);
    return complete(mask, a, width);
}

}  // namespace isowave::subdivision
