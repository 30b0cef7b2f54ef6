#include "subdivision/meshes/least_norm_rows.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace isowave::subdivision {

namespace {

// Two ways to the row, both by columns of P that are taken one after the other, the one farthest from the span of those
// taken first. A column within t of that span counts as dependent, and its equation is then wrong by up to t |x|.
// Cholesky of P'P is quick, but knows t^2 only, to (rounding) x (nodes), 1e-14: t cannot be less than 1e-6. That does
// for most windows. Butterfly's own singular values come down to 1e-7 where many valences differ (real parts have
// such windows), and with t = 1e-6 equations were wrong by 1e-9 to 4e-7.
constexpr double kDependentSquare = 1e-12;
// Gram-Schmidt on P knows t to 1e-16 x nodes (up to a few hundred): ten times that.
constexpr double kDependent = 1e-12;
// A0's row is in the window wherever it is used, so |x| <= its norm, below 10: solved equations are off by less than this,
// and those without a solution by a number of size 1.
constexpr double kSolved = 1e-11;

double square(double x) { return x * x; }

double dot(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

void addMultiple(std::vector<double>& a, double factor, const std::vector<double>& b) {
    for (std::size_t k = 0; k < a.size(); ++k) a[k] += factor * b[k];
}

void scale(std::vector<double>& a, double factor) {
    for (double& x : a) x *= factor;
}

}  // namespace

const std::vector<double>& LeastNormRows::weights(const std::vector<Index>& window) {
    restrictTo(window);
    const auto [entry, isNew] = solutions_.try_emplace(key_);
    if (isNew) {
        factorise();
        entry->second = shortest();
        if (!isSolved(entry->second)) entry->second = shortestByDirections();
        if (!isSolved(entry->second)) entry->second.clear();
    }
    return entry->second;
}

// Writes P on the window into p_, its coarse vertices numbered as they come, and into key_.
void LeastNormRows::restrictTo(const std::vector<Index>& window) {
    key_.clear();
    p_.clear();
    touched_.clear();
    Taps taps;
    for (const Index node : window) {
        rowOfP_(node, taps);
        key_.push_back(static_cast<double>(taps.size()));
        for (auto& [coarse, weight] : taps) {
            addOnce(touched_, coarse);
            coarse = static_cast<Index>(placeIn(touched_, coarse));
            key_.push_back(coarse);
            key_.push_back(weight);
        }
        p_.push_back(taps);
    }
}

// Cholesky of P'P, the largest remaining diagonal first, until what remains is dependent: direction k holds the
// products of all columns with the part of the k-th chosen one that is new.
void LeastNormRows::factorise() {
    const std::size_t m = touched_.size();
    std::vector<double> gram(m * m, 0.0), rest(m);
    for (const Taps& taps : p_) {
        for (const auto& [a, u] : taps) {
            for (const auto& [b, w] : taps) gram[a * m + b] += u * w;
        }
    }
    for (std::size_t c = 0; c < m; ++c) rest[c] = gram[c * m + c];
    const double least = kDependentSquare * *std::max_element(rest.begin(), rest.end());
    chosen_.clear();
    directions_.clear();
    while (chosen_.size() < m) {
        const auto c = static_cast<std::size_t>(std::max_element(rest.begin(), rest.end()) - rest.begin());
        if (rest[c] <= least) break;
        std::vector<double> direction(gram.begin() + c * m, gram.begin() + (c + 1) * m);
        for (const auto& before : directions_) {
            const double along = before[c];
            for (std::size_t k = 0; k < m; ++k) direction[k] -= along * before[k];
        }
        const double scale = 1 / std::sqrt(direction[c]);
        for (std::size_t k = 0; k < m; ++k) {
            direction[k] *= scale;
            rest[k] -= direction[k] * direction[k];
        }
        rest[c] = -1;  // chosen
        chosen_.push_back(c);
        directions_.push_back(std::move(direction));
    }
}

// y with P'P y = r on the chosen columns, 0 on the others.
std::vector<double> LeastNormRows::solve(const std::vector<double>& r) const {
    const std::size_t n = chosen_.size();
    std::vector<double> z(n), y(touched_.size(), 0.0);
    for (std::size_t k = 0; k < n; ++k) {
        z[k] = r[chosen_[k]];
        for (std::size_t j = 0; j < k; ++j) z[k] -= directions_[j][chosen_[k]] * z[j];
        z[k] /= directions_[k][chosen_[k]];
    }
    for (std::size_t k = n; k-- > 0;) {
        z[k] /= directions_[k][chosen_[k]];
        for (std::size_t j = 0; j < k; ++j) z[j] -= directions_[j][chosen_[k]] * z[k];
        y[chosen_[k]] = z[k];
    }
    return y;
}

// Corrected once by what is left of the equations, whose condition P'P squares.
std::vector<double> LeastNormRows::shortest() const {
    std::vector<double> x(p_.size(), 0.0);
    for (int pass = 0; pass < 2; ++pass) {
        const auto y = solve(leftOf(x));
        for (std::size_t k = 0; k < p_.size(); ++k) {
            for (const auto& [coarse, weight] : p_[k]) x[k] += weight * y[coarse];
        }
    }
    return x;
}

// The same on P instead of P'P. A direction q is what is new in a column, of length 1. It is orthogonal to the columns
// taken before, so a step along q leaves their equations as they are; x takes the one that solves the column's own.
// q is made orthogonal to the others twice, for rounding (twice is enough: Parlett, "The symmetric eigenvalue
// problem", 6.9).
std::vector<double> LeastNormRows::shortestByDirections() const {
    const std::size_t nodes = p_.size(), m = touched_.size();
    std::vector<std::vector<double>> column(m, std::vector<double>(nodes, 0.0)), directions;
    for (std::size_t k = 0; k < nodes; ++k) {
        for (const auto& [coarse, weight] : p_[k]) column[coarse][k] += weight;
    }
    auto rest = column;
    std::vector<double> x(nodes, 0.0);
    double least = 0;
    while (directions.size() < m) {
        const auto far = std::max_element(rest.begin(), rest.end(),
                                          [](const auto& a, const auto& b) { return dot(a, a) < dot(b, b); });
        const auto c = static_cast<std::size_t>(far - rest.begin());
        if (directions.empty()) least = square(kDependent) * dot(*far, *far);
        if (dot(*far, *far) <= least) break;
        auto q = *far;
        for (const auto& before : directions) addMultiple(q, -dot(before, q), before);
        scale(q, 1 / std::sqrt(dot(q, q)));
        for (auto& other : rest) addMultiple(other, -dot(q, other), q);
        std::fill(far->begin(), far->end(), 0.0);  // taken
        addMultiple(x, ((c == 0 ? 1 : 0) - dot(column[c], x)) / dot(column[c], q), q);
        directions.push_back(std::move(q));
    }
    return x;
}

// (1 at v, 0 else) - P'x
std::vector<double> LeastNormRows::leftOf(const std::vector<double>& x) const {
    std::vector<double> left(touched_.size(), 0.0);
    left[0] = 1;
    for (std::size_t k = 0; k < p_.size(); ++k) {
        for (const auto& [coarse, weight] : p_[k]) left[coarse] -= weight * x[k];
    }
    return left;
}

// Not where v's column depends on the others: there is no row.
bool LeastNormRows::isSolved(const std::vector<double>& x) const {
    const auto left = leftOf(x);
    return std::all_of(left.begin(), left.end(), [](double l) { return std::abs(l) < kSolved; });
}

}  // namespace isowave::subdivision
