// hold_curves PICTURE...: levels 1 to 5 of dark silhouettes as a markdown table: parts (holes), area beside level 0 and the
// share of thin samples inside, for the plain levels and for those that hold, with the largest distance to level 0 in
// pixels of the level. Beside them two ways to coarsen a bitmap: the mean of H x H pixels cut at 1/2, and morphological
// closing by a square of H x H, which tears nothing and coarsens nothing but what is hollow. Thin samples of a bitmap: of
// level 0, by curves2d/hold/thin.h.
//
//     cmake --preset release -DISOWAVE_BENCH=ON && cmake --build --preset release --target hold_curves
//     build/release/bin/hold_curves ../shared/data/bitmap/{fern_mo_01,keyring_as_,contour_giraffe,africa_01}.png
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <optional>

#include "curves2d/fit.h"
#include "curves2d/hold/thin.h"
#include "curves2d/ladder.h"
#include "isowave/curves.h"

namespace {
using namespace isowave::curves2d;

constexpr int kLast = 5;

struct Bits {
    int width, height, pixel;  // pixel: in pixels of level 0
    std::vector<char> inside;
    bool at(int x, int y) const {
        return x >= 0 && y >= 0 && x < width && y < height &&
               inside[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
};

template <class F>
Bits bits(int width, int height, int pixel, const F& f) {
    Bits out{width, height, pixel, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) out.inside.push_back(f(x, y));
    return out;
}

Bits meanOf(const Bits& b, int H) {
    return bits((b.width + H - 1) / H, (b.height + H - 1) / H, H, [&](int x, int y) {
        int sum = 0;
        for (int k = 0; k < H * H; ++k) sum += b.at(H * x + k % H, H * y + k / H);
        return 2 * sum > H * H;
    });
}

// Whether any (all) of the H pixels around, on each axis in turn, is inside.
Bits spread(const Bits& b, int H, bool any) {
    Bits out = b;
    for (const bool alongX : {true, false}) {
        const Bits from = out;
        out = bits(b.width, b.height, 1, [&](int x, int y) {
            for (int k = 0; k < H; ++k) {
                const int d = any ? k - H / 2 : H / 2 - k;
                if (from.at(alongX ? x + d : x, alongX ? y : y + d) == any) return any;
            }
            return !any;
        });
    }
    return out;
}

// Of four neighbours.
int partsOf(Bits b) {
    int parts = 0;
    std::vector<std::pair<int, int>> open;
    for (int y = 0; y < b.height; ++y)
        for (int x = 0; x < b.width; ++x) {
            if (!b.at(x, y)) continue;
            ++parts;
            open.push_back({x, y});
            while (!open.empty()) {
                const auto [i, j] = open.back();
                open.pop_back();
                if (!b.at(i, j)) continue;
                b.inside[static_cast<std::size_t>(j) * static_cast<std::size_t>(b.width) +
                         static_cast<std::size_t>(i)] = 0;
                for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
                    open.push_back({i + di, j + dj});
            }
        }
    return parts;
}

std::string cell(const Bits& b, double area, const std::vector<ThinSample>& samples) {
    const auto count = static_cast<double>(std::count(b.inside.begin(), b.inside.end(), char(1)));
    double kept = 0;
    for (const ThinSample& s : samples)
        kept += b.at(static_cast<int>(std::lround(s.at.x)) / b.pixel,
                     static_cast<int>(std::lround(s.at.y)) / b.pixel);
    return fmt::format("{}, {:+.1f}, {:.1f}", partsOf(b), 100 * (count * b.pixel * b.pixel / area - 1),
                       samples.empty() ? 100 : 100 * kept / static_cast<double>(samples.size()));
}

double keptIn(const Curves& curves, double H, const std::vector<ThinSample>& samples) {
    if (samples.empty()) return 100;
    const Interior interior(curves);
    double kept = 0;
    for (const ThinSample& s : samples) kept += interior.inside((1 / H) * s.at);
    return 100 * kept / static_cast<double>(samples.size());
}

bool tabulate(const std::string& path) {
    Input input = readInput(path);
    const Region inside = input.shape->inside;
    const double side = input.extent.high.x + 0.5, height = input.extent.high.y + 0.5;
    const Bits level0 = bits(static_cast<int>(side), static_cast<int>(height), 1,
                             [&](int x, int y) { return inside.contains(x, y); });
    std::vector<ThinSample> all;
    std::vector<std::string> plain;
    std::optional<Outline> outline;
    Point shift;
    double area = 0;
    traceSteps(fit(*input.shape, input.fit), 2 * kLast, Hold::none,
               [&](const StepFacts& f, const RowField<float>& field, const Curves& curves, const Curves&) {
                   if (f.step == 0) {
                       outline.emplace(field, curves);
                       all = thinSamples(*outline);
                       area = f.area;
                       shift = field.frame.origin;
                   }
                   if (f.step % 2 || !f.step) return;
                   const double H = 1 << (f.step / 2);
                   plain.push_back(fmt::format("{} ({}), {:+.1f}, {:.1f}", f.rings, f.holes,
                                               100 * (f.area / area - 1),
                                               keptIn(curves, H, samplesOfLevel(all, *outline, H))));
               });
    bool good = true;
    const std::vector<LevelCurves> held = levelCurves(std::move(input), {.lastStep = 2 * kLast});
    for (std::size_t level = 1; level < held.size(); ++level) {
        const StepFacts& f = held[level].facts;
        const int H = 1 << level;
        const double error = 100 * (f.area / held[0].facts.area - 1), allowed[] = {0, 1, 2, 5};
        const bool meets = f.rings <= held[level - 1].facts.rings && f.hold->kept >= 0.995 &&
                           (level > 3 || std::abs(error) <= allowed[level]);
        good = good && meets;
        std::vector<ThinSample> samples = samplesOfLevel(all, *outline, H);
        for (ThinSample& s : samples) s.at = s.at + shift;  // pixels of the picture
        fmt::print("| {} | {} | {} | {} ({}), {:+.1f}, {:.1f} | {:.2f} | {} | {} | {} | {} |\n",
                   std::filesystem::path(path).stem().string(), level, plain[level - 1], f.rings, f.holes,
                   error, 100 * f.hold->kept, f.maxToLevel0 / H, f.points,
                   cell(meanOf(level0, H), held[0].facts.area, samples),
                   cell(spread(spread(level0, H, true), H, false), held[0].facts.area, samples),
                   meets ? "yes" : "no");
    }
    return good;
}

}  // namespace

int main(int argc, char** argv) {
    fmt::print(
        "Parts (holes), area beside level 0 in %, thin samples inside in %.\n\n"
        "| picture | level | plain | holds | largest distance, H | points | mean | closing | goals |\n"
        "|---|---|---|---|---|---|---|---|---|\n");
    bool good = argc > 1;
    for (int i = 1; i < argc; ++i) good = tabulate(argv[i]) && good;
    return good ? 0 : 1;
}
