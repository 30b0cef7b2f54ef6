#include "curves2d/hold/thin.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace isowave::curves2d {
namespace {

constexpr double kFacingAway = -0.7;  // cosine of the normals of the two sides
constexpr double kThickest = 1.5;     // of H: what is thicker keeps its middle by itself

}  // namespace

std::vector<ThinSample> thinSamples(const Outline& outline) {
    std::vector<ThinSample> samples;
    for (const int axis : {0, 1})
        for (const Outline::Chord& chord : outline.chords(axis)) {
            const OutlinePoint &a = outline.points()[chord.from], &b = outline.points()[chord.to];
            if (dot(a.normal, b.normal) > kFacingAway) continue;
            const Point across = b.normal - a.normal, normal = (1 / length(across)) * across;
            samples.push_back({0.5 * (a.at + b.at), normal,
                               (b.at[axis] - a.at[axis]) * std::abs(normal[axis]),
                               outline.interior().partArea(a.ring)});
        }
    return samples;
}

std::vector<ThinSample> samplesOfLevel(const std::vector<ThinSample>& all, const Outline& outline, double H) {
    std::vector<ThinSample> chosen;
    const double least = std::min(H * H, outline.interior().largestPart());
    std::copy_if(all.begin(), all.end(), std::back_inserter(chosen), [&](const ThinSample& sample) {
        return sample.thickness <= kThickest * H && sample.part >= least;
    });
    return chosen;
}

std::vector<Point> placesOf(const std::vector<ThinSample>& samples) {
    std::vector<Point> places;
    places.reserve(samples.size());
    for (const ThinSample& sample : samples) places.push_back(sample.at);
    return places;
}

}  // namespace isowave::curves2d
