// How a fit's repair went, for the reports of lod and curves.
#pragma once

#include "tools/report.h"

namespace isowave::tools {

// report: a FitReport of volume/ or curves2d/.
template <class Report>
void addRepair(Json& json, const Report& report) {
    json["lattice_points"] = report.latticePoints;
    json["disagreeing"] = report.disagreeing;
    json["repair_passes"] = report.repairPasses;
    json["repaired"] = report.repaired;
    json["repair_floor"] = report.repairFloor;
    json["stopped"] = report.repairAgreed ? "agreed" : "pass_limit";
}

}  // namespace isowave::tools
