// The texts that CMake puts into the library (embed.cmake).
#pragma once

#include <string_view>

namespace isowave::view::embedded {

extern const std::string_view three;    // three.min.js; empty where it was not there when the build was configured
extern const std::string_view page;     // page/page.html
extern const std::string_view style;    // page/style.css
extern const std::string_view scripts;  // the modules of page/, in the order of view/CMakeLists.txt

}  // namespace isowave::view::embedded
