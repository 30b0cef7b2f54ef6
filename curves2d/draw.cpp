#include "curves2d/draw.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "curves2d/raster.h"
#include "io/picture/png.h"
#include "isowave/error.h"

namespace isowave::curves2d {
namespace {

constexpr const char* kInk = "#1d3557";

// In the picture y points down.
Point onPicture(Point p, const View& view) {
    return view.yUp ? Point{p.x, view.extent.low.y + view.extent.high.y - p.y} : p;
}

void put(std::string& out, Point p, const View& view, char command) {
    const Point q = onPicture(p, view);
    fmt::format_to(std::back_inserter(out), "{}{:.10g} {:.10g}", command, q.x, q.y);
}

std::string pathOf(const Curves& curves, const View& view) {
    std::string out;
    for (std::size_t r = 0; r < curves.rings.size(); ++r) {
        char command = 'M';
        for (const Point& p : curves.world(r)) {
            put(out, p, view, command);
            command = 'L';
        }
        out += "Z\n";
    }
    return out;
}

std::string pathOf(const SmoothCurves& curves, const View& view) {
    std::string out;
    for (const std::vector<Bezier>& ring : curves.rings) {
        if (ring.empty()) continue;
        put(out, ring.front().start, view, 'M');
        for (const Bezier& b : ring) {
            put(out, b.startHandle, view, 'C');
            put(out, b.endHandle, view, ' ');
            put(out, b.end, view, ' ');
        }
        out += "Z\n";
    }
    return out;
}

Point sizeOf(const View& view) { return view.extent.high - view.extent.low; }

std::string viewBox(const View& view) {
    const Point size = sizeOf(view);
    return fmt::format("viewBox=\"{:.10g} {:.10g} {:.10g} {:.10g}\"", view.extent.low.x, view.extent.low.y,
                       size.x, size.y);
}

// Width and height of a picture whose longer side is `longer`.
Point scaled(const View& view, double longer) {
    const Point size = sizeOf(view);
    const double scale = longer / std::max(size.x, size.y);
    return {std::max(1.0, std::round(size.x * scale)), std::max(1.0, std::round(size.y * scale))};
}

void write(const std::filesystem::path& path, const std::string& text) {
    AtomicFile file(path);
    try {
        file.stream().write(text.data(), static_cast<std::streamsize>(text.size()));
    } catch (const std::ios_base::failure&) {
        throw OperationError(path.string(), "could not be written; is the disk full?");
    }
    file.commit();
}

std::string svgOfPath(const std::string& d, const View& view) {
    const Point size = scaled(view, 1024);
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" {}>\n"
        "<path fill=\"{}\" fill-rule=\"evenodd\" d=\"{}\"/>\n</svg>\n",
        size.x, size.y, viewBox(view), kInk, d);
}

void putRing(std::string& out, const Ring& ring) {
    out += "[";
    for (std::size_t i = 0; i <= ring.size(); ++i) {
        const Point& p = ring[i % ring.size()];
        fmt::format_to(std::back_inserter(out), "{}[{:.12g},{:.12g}]", i ? "," : "", p.x, p.y);
    }
    out += "]";
}

// JSON's string, quoted.
std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        if (static_cast<unsigned char>(c) >= 0x20) out += c;
    }
    return out + "\"";
}

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
    return out;
}

// Of each polygon its outer ring, then the holes directly in it.
std::vector<std::vector<std::size_t>> polygonsOf(const Curves& curves) {
    std::vector<std::vector<std::size_t>> polygons;
    std::vector<std::size_t> polygonOf(curves.rings.size());
    for (std::size_t r = 0; r < curves.rings.size(); ++r)
        if (!curves.rings[r].hole) {
            polygonOf[r] = polygons.size();
            polygons.push_back({r});
        }
    for (std::size_t r = 0; r < curves.rings.size(); ++r)
        if (curves.rings[r].hole)
            polygons[polygonOf[static_cast<std::size_t>(curves.rings[r].parent)]].push_back(r);
    return polygons;
}

}  // namespace

std::string svg(const Curves& curves, const View& view) { return svgOfPath(pathOf(curves, view), view); }
std::string svg(const SmoothCurves& curves, const View& view) {
    return svgOfPath(pathOf(curves, view), view);
}
std::string svg(const DrawnCurves& curves, const View& view) {
    return curves.smooth ? svg(*curves.smooth, view) : svg(curves.curves, view);
}

std::string geojson(const Curves& curves, const std::string& name) {
    std::string out = fmt::format(
        "{{\"type\":\"FeatureCollection\",\"features\":[{{\"type\":\"Feature\","
        "\"properties\":{{\"name\":{}}},\"geometry\":"
        "{{\"type\":\"MultiPolygon\",\"coordinates\":[",
        quoted(name));
    const auto polygons = polygonsOf(curves);
    for (std::size_t p = 0; p < polygons.size(); ++p) {
        out += p ? ",\n[" : "\n[";
        for (std::size_t k = 0; k < polygons[p].size(); ++k) {
            if (k) out += ",";
            putRing(out, curves.world(polygons[p][k]));
        }
        out += "]";
    }
    return out + "\n]}}]}\n";
}

std::string gmtText(const Curves& curves) {
    std::string out;
    for (std::size_t r = 0; r < curves.rings.size(); ++r) {
        const CurveRing& ring = curves.rings[r];
        out += ring.hole ? fmt::format("> hole in {}\n", ring.parent) : "> outer\n";
        const Ring points = curves.world(r);
        for (std::size_t i = 0; i <= points.size(); ++i) {
            const Point& p = points[i % points.size()];
            fmt::format_to(std::back_inserter(out), "{:.12g} {:.12g}\n", p.x, p.y);
        }
    }
    return out;
}

void writeSvg(const std::filesystem::path& path, const Curves& curves, const View& view) {
    write(path, svg(curves, view));
}
void writeSvg(const std::filesystem::path& path, const SmoothCurves& curves, const View& view) {
    write(path, svg(curves, view));
}
void writeGeojson(const std::filesystem::path& path, const Curves& curves, const std::string& name) {
    write(path, geojson(curves, name));
}
void writeText(const std::filesystem::path& path, const Curves& curves) { write(path, gmtText(curves)); }

GreyPicture picture(const Curves& curves, const View& view, int pixels) {
    constexpr int kSamples = 4;  // along each axis of a pixel
    const Point size = scaled(view, pixels);
    const auto width = static_cast<std::int32_t>(size.x), height = static_cast<std::int32_t>(size.y);
    Polygon all;
    for (std::size_t r = 0; r < curves.rings.size(); ++r) {
        all.rings.push_back(curves.world(r));
        for (Point& p : all.rings.back()) p = onPicture(p, view);
    }
    const Point h{sizeOf(view).x / (width * kSamples), sizeOf(view).y / (height * kSamples)};
    const Region inside = rasterise({all}, {view.extent.low + 0.5 * h, h});
    std::vector<std::int32_t> covered(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
    for (std::int32_t y = 0; y < height * kSamples; ++y)
        for (const Span& span : inside.row(y))
            for (std::int32_t x = std::max(0, span.first); x <= std::min(span.last, width * kSamples - 1);
                 ++x)
                ++covered[static_cast<std::size_t>(y / kSamples) * static_cast<std::size_t>(width) +
                          static_cast<std::size_t>(x / kSamples)];
    GreyPicture grey{width, height, {}};
    grey.values.reserve(covered.size());
    for (const std::int32_t count : covered)
        grey.values.push_back(static_cast<std::uint8_t>(255 - 255 * count / (kSamples * kSamples)));
    return grey;
}

void writePng(const std::filesystem::path& path, const Curves& curves, const View& view, int pixels) {
    const GreyPicture grey = picture(curves, view, pixels);
    Picture png{.width = grey.width, .height = grey.height, .pixelSize = {{1, 1}}};
    for (const std::uint8_t value : grey.values) png.samples.push_back(static_cast<std::byte>(value));
    write(path, pngBytes(png));
}

std::string sheetOf(const std::vector<Panel>& panels, const View& view) {
    constexpr double kSide = 260, kGap = 20, kLabel = 24;
    constexpr std::size_t kMostColumns = 5;
    const Point size = scaled(view, kSide);
    const std::size_t columns = std::min(panels.size(), kMostColumns),
                      rows = (panels.size() + kMostColumns - 1) / kMostColumns;
    const double cellWidth = size.x + kGap, cellHeight = size.y + kLabel + kGap;
    std::string out = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
        "viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\" font-size=\"14\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        static_cast<double>(columns) * cellWidth + kGap, static_cast<double>(rows) * cellHeight + kGap);
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const double x = kGap + static_cast<double>(i % kMostColumns) * cellWidth,
                     y = kGap + static_cast<double>(i / kMostColumns) * cellHeight;
        out += fmt::format(
            "<svg x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" {}>"
            "<path fill=\"{}\" fill-rule=\"evenodd\" d=\"{}\"/></svg>\n"
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
            x, y, size.x, size.y, viewBox(view), kInk, pathOf(panels[i].curves, view), x + size.x / 2,
            y + size.y + 18, escaped(panels[i].label));
    }
    return out + "</svg>\n";
}

}  // namespace isowave::curves2d
