#include "tools/report/json.h"

#include <cmath>

namespace isowave::tools {

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string dumped(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace isowave::tools
