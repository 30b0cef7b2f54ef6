#include "subdivision/meshes/least_norm_rows.h"

#include <algorithm>
#include <cmath>

namespace isowave::subdivision {

namespace {

// Columns of P, cut to a window, are dependent exactly or clearly not; this is a ratio of squared lengths.
constexpr double kDependent = 1e-12;
// What is left of an equation that has a solution is rounding (seen 1e-15), of one that has none of size 1.
constexpr double kSolved = 1e-9;

}  // namespace

const std::vector<double>& LeastNormRows::weights(const std::vector<Index>& window) {
    restrictTo(window);
    const auto [entry, isNew] = solutions_.try_emplace(key_);
    if (isNew) {
        factorise();
        entry->second = shortest();
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
    const double least = kDependent * *std::max_element(rest.begin(), rest.end());
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

// Corrected once by what is left of the equations, whose condition P'P squares. Where something is left after that,
// v's column depends on others: no row.
std::vector<double> LeastNormRows::shortest() const {
    std::vector<double> x(p_.size(), 0.0), r(touched_.size(), 0.0);
    r[0] = 1;
    for (int pass = 0; pass < 2; ++pass) {
        const auto y = solve(r);
        for (std::size_t k = 0; k < p_.size(); ++k) {
            double change = 0;
            for (const auto& [coarse, weight] : p_[k]) change += weight * y[coarse];
            x[k] += change;
            for (const auto& [coarse, weight] : p_[k]) r[coarse] -= weight * change;
        }
    }
    const bool exists = std::all_of(r.begin(), r.end(), [](double left) { return std::abs(left) < kSolved; });
    return exists ? x : std::vector<double>{};
}

}  // namespace isowave::subdivision
