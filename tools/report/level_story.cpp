#include "tools/report/level_story.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/number_text.h"

namespace isowave::tools {
namespace {

// "36 -> 27 handles, 13 -> 5 parts", or "27 handles" where that is what it was; cavities where there are any.
std::string changeText(const SolidCounts& before, const SolidCounts& now) {
    const auto part = [](std::int64_t from, std::int64_t to, const char* one, const char* many) {
        return (from == to ? std::string() : grouped(from) + " -> ") + counted(to, one, many);
    };
    std::string text = part(before.handles, now.handles, "handle", "handles") + ", " +
                       part(before.parts, now.parts, "part", "parts");
    if (before.cavities > 0 || now.cavities > 0)
        text += ", " + part(before.cavities, now.cavities, "cavity", "cavities");
    return text;
}

// "holes closed up to radius 1.9 mm, open from 2.1 mm, 3 torn open"
std::string fateText(const FeatureFate& fate, std::string_view what, std::string_view gone,
                     std::string_view there, const std::string& unit) {
    std::vector<std::string> phrases;
    if (const auto r = fate.largestVanished; r && std::isfinite(*r))
        phrases.push_back(fmt::format("{} up to radius {:.3g}{}", gone, *r, unit));
    if (const auto r = fate.smallestSurviving; r && std::isfinite(*r))
        phrases.push_back(fmt::format("{} from radius {:.3g}{}", there, *r, unit));
    if (fate.torn > 0) phrases.push_back(fmt::format("{} torn open", grouped(fate.torn)));
    return phrases.empty() ? std::string() : fmt::format("{} {}", what, fmt::join(phrases, ", "));
}

// "76 of 76 new handles are the mesh's sampling, --refine 2 has 25", or nothing where there are no new ones.
std::string samplingText(const LevelReport& level, std::int64_t SolidCounts::*kind, const char* one,
                         const char* many) {
    const std::int64_t now = countsOf(level.topology).*kind, added = level.change.*kind,
                       finer = level.sampling->counts.*kind;
    if (added <= 0) return {};
    return fmt::format("{} of {} the mesh's sampling, --refine {} has {}",
                       grouped(std::clamp<std::int64_t>(now - finer, 0, added)),
                       counted(added, fmt::format("new {} is", one), fmt::format("new {} are", many)),
                       level.sampling->refine, grouped(finer));
}

// Phrases of a line, in turn.
class Story {
  public:
    explicit Story(std::string start) : text_(std::move(start)) {}
    void add(const std::string& phrase) {
        if (!phrase.empty()) text_ += "; " + phrase;
    }
    void append(const std::string& more) { text_ += more; }
    std::string text() && { return std::move(text_); }

  private:
    std::string text_;
};

void tellCounts(Story& story, const LevelReport& level) {
    if (!level.topology.closed() || !level.topology.manifold()) return;
    const SolidCounts now = countsOf(level.topology), &change = level.change;
    story.append(": " + changeText({now.parts - change.parts, now.handles - change.handles,
                                    now.cavities - change.cavities},
                                   now));
}

void tellSampling(Story& story, const LevelReport& level) {
    if (!level.sampling) return;
    story.add(samplingText(level, &SolidCounts::handles, "handle", "handles"));
    story.add(samplingText(level, &SolidCounts::parts, "part", "parts"));
    story.add(samplingText(level, &SolidCounts::cavities, "cavity", "cavities"));
}

void tellFeatures(Story& story, const LevelReport& level, const std::string& unit) {
    if (!level.features) return;
    story.add(fateText(level.features->handles, "holes", "closed", "open", unit));
    story.add(fateText(level.features->parts, "parts", "gone", "kept", unit));
    story.add(fateText(level.features->cavities, "cavities", "filled", "kept", unit));
}

void tellSpecks(Story& story, const LevelReport& level) {
    if (level.specksRemoved == 0 && level.bubblesRemoved == 0) return;
    story.add(fmt::format("{} and {} removed", counted(level.specksRemoved, "speck"),
                          counted(level.bubblesRemoved, "bubble")));
}

void tellEdits(Story& story, const LevelReport& level) {
    for (const bool fill : {false, true}) {
        std::int64_t count = 0;
        double volume = 0;
        for (const LevelEdit& edit : level.edits)
            if (edit.fill == fill) {
                ++count;
                volume += edit.volume;
            }
        if (count > 0)
            story.add(
                fmt::format("{} of {} made", counted(count, fill ? "fill" : "cut"), shortNumber(volume)));
    }
    if (level.limitsMissed) story.add("limits missed: " + *level.limitsMissed);
}

void tellIso(Story& story, const LevelReport& level, const std::string& unit) {
    if (level.isoShift == 0 || !level.isoDistance || !std::isfinite(*level.isoDistance)) return;
    story.add(fmt::format("iso {:+.3f} K moves the surface by {:+.3g}{}", level.isoShift, *level.isoDistance,
                          unit));
    if (const double unmoved = level.volumeAtIso0.value_or(0); unmoved > 0)
        story.append(
            fmt::format(" and the volume by {:+.3g} %", 100 * (level.topology.volume / unmoved - 1)));
}

// "9,120 of 12,000 triangles in the regions (rms 0.01 mm to level 0, 0.9 mm elsewhere)"
void tellRegions(Story& story, const LevelReport& level, const std::string& unit) {
    if (!level.regions) return;
    const RegionSummary& r = *level.regions;
    story.add(fmt::format("{} of {} in the regions, {} where they fade out", grouped(r.trianglesInside),
                          counted(level.topology.triangles, "triangle"), grouped(r.trianglesFading)));
    if (r.rmsInside && r.rmsOutside)
        story.append(fmt::format("; rms to level 0 {:.3g}{} in them, {:.3g}{} elsewhere", *r.rmsInside, unit,
                                 *r.rmsOutside, unit));
}

void tellThin(Story& story, const LevelReport& level) {
    if (!level.thinKept || !(level.thinKeptAtIso0.value_or(1) < 1)) return;
    story.add(fmt::format("{:.3g} % of what is thin is kept", 100 * *level.thinKept));
    if (level.thinKept != level.thinKeptAtIso0)
        story.append(fmt::format(" ({:.3g} % at iso 0)", 100 * *level.thinKeptAtIso0));
}

}  // namespace

std::string voxelText(const std::array<double, 3>& spacing) {
    const std::string x = fmt::format("{:.4g}", spacing[0]);
    const std::string y = fmt::format("{:.4g}", spacing[1]);
    const std::string z = fmt::format("{:.4g}", spacing[2]);
    return x == y && y == z ? x : x + "x" + y + "x" + z;
}

std::string storyText(const LevelReport& level, const std::string& unit) {
    Story story(level.level ? fmt::format("level {}", *level.level) : fmt::format("step {}", level.step));
    story.append(fmt::format(" ({}{})", voxelText(level.spacing), unit));
    tellCounts(story, level);
    tellSampling(story, level);
    tellFeatures(story, level, unit);
    tellSpecks(story, level);
    tellEdits(story, level);
    tellIso(story, level, unit);
    tellThin(story, level);
    tellRegions(story, level, unit);
    return std::move(story).text();
}

}  // namespace isowave::tools
