#include "tools/report/json.h"

#include <cmath>
#include <string_view>

namespace isowave::tools {

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string dumped(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string withRemarks(const std::string& report, const std::vector<std::string>& remarks) {
    constexpr std::string_view kEnd = "\n}\n";
    const bool isObject = report.size() > kEnd.size() && report.substr(report.size() - kEnd.size()) == kEnd;
    if (!isObject || report.find("\n  \"remarks\":") != std::string::npos) return report;
    std::string list;
    for (const std::string& remark : remarks) {
        std::string line = dumped(Json(remark));
        line.pop_back();
        list += (list.empty() ? "\n    " : ",\n    ") + line;
    }
    return report.substr(0, report.size() - kEnd.size()) + ",\n  \"remarks\": [" + list +
           (list.empty() ? "]" : "\n  ]") + std::string(kEnd);
}

}  // namespace isowave::tools
