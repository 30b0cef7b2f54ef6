// InputReport and FitSummary as text: what a pyramid's file says about the solid that it was made of, and what reports
// show. The one place that knows the keys.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "isowave/solid.h"
#include "lod/solid_state.h"

namespace isowave::lod {

// Key and value, a JSON text, in the order of reports: {"path", "\"part.stl\""}, {"kind", "\"mesh\""}, ...
using Fields = std::vector<std::pair<std::string, std::string>>;
Fields fieldsOf(const InputReport& input);
// input: of a pyramid it knows what its file says of the fit, word for word.
Fields fieldsOf(const std::optional<FitSummary>& fit, const InputReport& input);

// For wavelets::Pyramid::source: "input.path" -> "\"part.stl\"", "fit.method" -> "\"distance\"", ...
std::map<std::string, std::string> sourceOf(const InputReport& input, const std::optional<FitSummary>& fit);

// A text as such a value: part.stl -> "\"part.stl\"". Bytes that are no UTF-8 are replaced.
std::string valueOf(const std::string& text);

// The way back. What is missing, or of another type than it should be, stays empty. Null where the source does not speak of
// an input.
std::shared_ptr<const InputReport> inputOfSource(const std::map<std::string, std::string>& source);
std::optional<FitSummary> fitOfSource(const std::map<std::string, std::string>& source);

// The border of an image that was opened with an open one.
std::optional<Border> borderOf(const InputReport& input);

// "mask", "labels", "grey image", "mesh", "level set", "pyramid"
const char* nameOf(InputReport::Kind kind);
inline constexpr std::array<const char*, 3> kFitMethods{"binary", "distance", "mask"};
// What lengths are in, of a pyramid those that it was made of: "mm", "angstrom", ...; empty where nobody has said it.
std::string unitOf(const InputReport& input);
// "lps", "ras", "unspecified"
const char* nameOf(Space space);

}  // namespace isowave::lod
