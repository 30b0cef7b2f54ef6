// Curves -> files: SVG, GeoJSON, text (the strings of isowave/curves.h) and PNG. Every file appears whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "isowave/curves.h"

namespace isowave::curves2d {

// Each throws OperationError when the file cannot be written.
void writeSvg(const std::filesystem::path& path, const Curves& curves, const View& view);
void writeSvg(const std::filesystem::path& path, const SmoothCurves& curves, const View& view);
void writeGeojson(const std::filesystem::path& path, const Curves& curves, const std::string& name);
void writeText(const std::filesystem::path& path, const Curves& curves);

// Black on white, 16 samples a pixel.
struct GreyPicture {
    std::int32_t width = 0, height = 0;
    std::vector<std::uint8_t> values;  // row by row from the top; 0 black, 255 white
};
// pixels: along the longer side of the extent.
GreyPicture picture(const Curves& curves, const View& view, int pixels = 1024);
// 8-bit grey. Throws OperationError.
void writePng(const std::filesystem::path& path, const Curves& curves, const View& view, int pixels = 1024);

}  // namespace isowave::curves2d
