#include "compress/coder/predictor.h"

#include <cmath>

namespace isowave::compress {
namespace {

constexpr std::size_t kN = kBefore.size();
constexpr double kLargest = 3.9;  // a weight, so that it fits 16 bits

struct Cell {
    std::int32_t value;
    bool known;
};

// A symmetric system, summed up, solved by Cholesky's decomposition.
class NormalEquations {
  public:
    void add(const Neighbours& a, double value, double weight) {
        ++count_;
        for (std::size_t i = 0; i < kN; ++i) {
            const double wi = weight * a[i];
            for (std::size_t j = 0; j <= i; ++j) matrix_[i][j] += wi * a[j];
            right_[i] += wi * value;
        }
        scale_ += weight * value * value;
    }
    bool worthSolving() const { return count_ > 300; }
    // Neighbours on a plane are nearly dependent: without a ridge weights grow without use.
    std::array<double, kN> solve() {
        const double ridge = 1e-6 * scale_ + 1e-9;
        for (std::size_t i = 0; i < kN; ++i) matrix_[i][i] += ridge;
        decompose();
        std::array<double, kN> x = right_;
        for (std::size_t i = 0; i < kN; ++i) {
            for (std::size_t j = 0; j < i; ++j) x[i] -= matrix_[i][j] * x[j];
            x[i] /= matrix_[i][i];
        }
        for (std::size_t i = kN; i-- > 0;) {
            for (std::size_t j = i + 1; j < kN; ++j) x[i] -= matrix_[j][i] * x[j];
            x[i] /= matrix_[i][i];
        }
        return x;
    }

  private:
    void decompose() {
        for (std::size_t i = 0; i < kN; ++i)
            for (std::size_t j = 0; j <= i; ++j) {
                double sum = matrix_[i][j];
                for (std::size_t k = 0; k < j; ++k) sum -= matrix_[i][k] * matrix_[j][k];
                matrix_[i][j] = i == j ? std::sqrt(std::max(sum, 1e-300)) : sum / matrix_[j][j];
            }
    }
    std::array<std::array<double, kN>, kN> matrix_{};
    std::array<double, kN> right_{};
    double scale_ = 0;
    std::int64_t count_ = 0;
};

std::array<std::int16_t, kN> rounded(const std::array<double, kN>& weights) {
    std::array<std::int16_t, kN> result;
    for (std::size_t i = 0; i < kN; ++i)
        result[i] = static_cast<std::int16_t>(
            std::lround(std::clamp(weights[i], -kLargest, kLargest) * (1 << Weights::kBits)));
    return result;
}

// Extrapolation of a linear function from what touches: for kinds that hardly occur.
std::array<std::int16_t, kN> plain(int kind) {
    std::array<std::int16_t, kN> weights{};
    weights[kind & 4 ? 15 : kind & 2 ? 12 : 5] = 1 << Weights::kBits;
    return weights;
}

}  // namespace

Weights fitWeights(const Lattice& lattice, const std::vector<std::int32_t>& values, std::int32_t outside,
                   const std::vector<float>& importance) {
    std::vector<NormalEquations> equations(kKinds);
    Window<Cell> window(lattice.size, {outside, false});
    walk(lattice, 0, lattice.size[0], window, [&](std::size_t i) {
        const int kind = window.at(kX).known + 2 * window.at(kY).known + 4 * window.at(kZ).known;
        Neighbours neighbours;
        for (std::size_t k = 0; k < kN; ++k) neighbours[k] = window.at(kBefore[k]).value;
        const double weight = static_cast<double>(importance[i]) * importance[i];
        equations[static_cast<std::size_t>(kind)].add(neighbours, values[i], weight);
        window.here() = {values[i], true};
        return Cell{values[i] < 0 ? -outside : outside, false};
    });
    Weights weights;
    for (int kind = 0; kind < kKinds; ++kind) {
        NormalEquations& e = equations[static_cast<std::size_t>(kind)];
        weights.of[static_cast<std::size_t>(kind)] = e.worthSolving() ? rounded(e.solve()) : plain(kind);
    }
    return weights;
}

}  // namespace isowave::compress
