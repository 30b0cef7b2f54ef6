#include "tools/report/edit_report.h"

#include <fmt/format.h>

#include "base/number_text.h"
#include "tools/report/json.h"

namespace isowave::tools {
namespace {

Json jsonOf(const EditStory& edit) {
    Json json;
    json["edit"] = edit.text;
    json["tool_volume"] = edit.toolVolume ? finite(*edit.toolVolume) : Json(nullptr);
    json["volume_before"] = edit.volumeBefore;
    json["volume_after"] = edit.volumeAfter;
    json["volume_change"] = edit.volumeAfter - edit.volumeBefore;
    json["parts_before"] = edit.partsBefore;
    json["parts_after"] = edit.partsAfter;
    json["control_points_touched"] = edit.touched;
    json["control_points_new"] = edit.known;
    json["control_points_gone"] = edit.forgotten;
    return json;
}

std::string textOf(const EditStory& edit) {
    const std::string tool =
        edit.toolVolume ? fmt::format(" (the tool: {})", shortNumber(*edit.toolVolume)) : "";
    return fmt::format("{}: volume {} -> {}, {}{}{}; {} touched\n", edit.text, shortNumber(edit.volumeBefore),
                       shortNumber(edit.volumeAfter), edit.volumeAfter < edit.volumeBefore ? "" : "+",
                       shortNumber(edit.volumeAfter - edit.volumeBefore), tool,
                       counted(edit.touched, "control point"));
}

}  // namespace

std::string jsonOf(const EditTale& tale) {
    const EditReport& r = tale.report;
    Json json;
    json["version"] = 1;
    json["input"] = tale.input ? Json(*tale.input) : Json(nullptr);
    json["output"] = tale.output ? Json(*tale.output) : Json(nullptr);
    json["level"] = r.level;
    json["edits"] = Json::array();
    for (const EditStory& edit : r.edits) json["edits"].push_back(jsonOf(edit));
    json["control_points"] = r.controlPoints;
    json["control_points_of_level_touched"] = r.touchedOfLevel;
    json["steps"] = r.steps;
    json["steps_checked"] = r.checkedSteps ? Json(*r.checkedSteps) : Json(nullptr);
    json["steps_closed"] = r.closedSteps ? Json(*r.closedSteps) : Json(nullptr);
    json["remarks"] = tale.remarks;
    json["seconds"] = r.seconds;
    return dumped(json);
}

std::string textOf(const EditTale& tale) {
    std::string text;
    for (const EditStory& edit : tale.report.edits) text += textOf(edit);
    text += fmt::format("{}: {} steps, {} control points; {} of level {} touched\n", *tale.output,
                        tale.report.steps, grouped(tale.report.controlPoints),
                        grouped(tale.report.touchedOfLevel), tale.report.level);
    if (tale.report.checkedSteps)
        text += fmt::format("{} of {} steps with a surface are closed and 2-manifold\n",
                            *tale.report.closedSteps, *tale.report.checkedSteps);
    return text;
}

}  // namespace isowave::tools
