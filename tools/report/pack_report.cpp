#include "tools/report/pack_report.h"

#include <fmt/format.h>

#include "base/number_text.h"
#include "tools/report/json.h"

namespace isowave::tools {
namespace {

double bitsPerPoint(const PackReport& report) {
    return 8.0 * static_cast<double>(report.bytes) / static_cast<double>(report.controlPoints);
}

Json lengthJson(const std::optional<Length>& length) {
    if (!length) return nullptr;
    return {{"value", length->value}, {"unit", length->unit == Length::Unit::voxels ? "voxel" : "world"}};
}

}  // namespace

std::string jsonOf(const PackStory& story) {
    const PackReport& r = story.report;
    Json json;
    json["version"] = 1;
    json["input"] = story.input;
    json["output"] = story.output;
    json["lossless"] = !r.boundVoxels;
    json["bound"] = lengthJson(story.options.bound);
    json["max_distance"] = lengthJson(story.options.maxDistance);
    json["control_points"] = r.controlPoints;
    json["bytes"] = r.bytes;
    json["bits_per_control_point"] = bitsPerPoint(r);
    json["parts"] = {
        {"head", r.headBytes}, {"nodes", r.nodeBytes}, {"signs", r.signBytes}, {"values", r.valueBytes}};
    json["chunks"] = r.chunks;
    json["seconds"] = r.seconds;
    if (!r.boundVoxels) return dumped(json);
    json["bound_voxels"] = *r.boundVoxels;
    json["voxels_per_k"] = r.voxelsPerK;
    json["step_voxels"] = r.stepVoxels;
    json["change_voxels"] = {{"max", r.largestVoxels}, {"rms", r.rmsVoxels}};
    json["vertex_distance"] = {{"max", r.largestDistance}, {"rms", r.rmsDistance}};
    json["triangles"] = r.triangles;
    return dumped(json);
}

std::string textOf(const PackStory& story) {
    const PackReport& r = story.report;
    const std::string head =
        fmt::format("{}: {} bytes, {:.3f} bits for each of {} control points\n", story.output,
                    grouped(r.bytes), bitsPerPoint(r), grouped(r.controlPoints));
    if (!r.boundVoxels) return head + "lossless: level 0 comes back to the bit\n";
    return head + fmt::format(
                      "the field moves by at most {:.3g} voxels near the surface (rms {:.3g}; bound {:.3g}); "
                      "all signs and the "
                      "{} triangles of level 0 are kept; its vertices move by at most {:.3g} (rms {:.3g})\n",
                      r.largestVoxels, r.rmsVoxels, *r.boundVoxels, grouped(r.triangles), r.largestDistance,
                      r.rmsDistance);
}

}  // namespace isowave::tools
