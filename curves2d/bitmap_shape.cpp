#include "curves2d/bitmap_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>

#include "io/picture/bmp.h"
#include "io/picture/png.h"
#include "io/picture/pnm.h"
#include "io/picture/tiff.h"
#include "isowave/error.h"

namespace isowave::curves2d {
namespace {

Picture readByContent(const std::string& bytes, const std::string& name) {
    if (isPng(bytes)) return readPng(bytes, name);
    if (isTiff(bytes)) return readTiff(bytes, name);
    if (isBmp(bytes)) return readBmp(bytes, name);
    if (isPnm(bytes)) return readPnm(bytes, name);
    throw InputError(name,
                     "neither PNG, TIFF, BMP, PGM nor PBM; expected an image, or polygons in .geojson, "
                     ".json or .txt");
}

template <class F>
bool allOfBorder(std::int32_t width, std::int32_t height, const F& holds) {
    for (std::int32_t x = 0; x < width; ++x)
        if (!holds(x, 0) || !holds(x, height - 1)) return false;
    for (std::int32_t y = 0; y < height; ++y)
        if (!holds(0, y) || !holds(width - 1, y)) return false;
    return true;
}

// The last channel.
std::vector<float> opacityOf(const Picture& picture) {
    std::vector<float> values;
    const auto channels = static_cast<std::size_t>(picture.channels);
    values.reserve(picture.sampleCount() / channels);
    withType(picture.type, [&]<class T>(T) {
        const auto samples = picture.as<T>();
        for (std::size_t k = channels - 1; k < samples.size(); k += channels)
            values.push_back(static_cast<float>(samples[k]));
    });
    return values;
}

// A drawing of any colour on transparent ground is what is opaque.
void drawOnTransparentGround(const Picture& picture, Bitmap& bitmap) {
    if (!picture.hasOpacity) return;
    Bitmap opaque{bitmap.width, bitmap.height, opacityOf(picture), true};
    const double half = picture.fullValue() / 2;
    if (allOfBorder(opaque.width, opaque.height, [&](auto x, auto y) { return opaque.at(x, y) < half; }) &&
        valueRange(opaque).high > half)
        bitmap = std::move(opaque);
}

// ---- iso line

// Values relative to the iso value, positive outside. Outside the image there is the mirror image of the
// nearest pixel's value where that is inside, so the line passes half a pixel beyond the border, and the
// value itself where it is outside.
class Levels {
  public:
    Levels(const Bitmap& bitmap, double iso, bool invert)
        : bitmap_(bitmap), iso_(iso), sign_(invert ? -1 : 1) {}
    bool inside(std::int32_t x, std::int32_t y) const { return (bitmap_.at(x, y) > iso_) != (sign_ < 0); }
    double at(std::int32_t x, std::int32_t y) const {
        const std::int32_t cx = std::clamp(x, 0, bitmap_.width - 1),
                           cy = std::clamp(y, 0, bitmap_.height - 1);
        const double size = std::abs(static_cast<double>(bitmap_.at(cx, cy)) - iso_);
        const bool here = cx == x && cy == y && inside(x, y);
        return here ? -size : size;
    }

  private:
    const Bitmap& bitmap_;
    double iso_;
    int sign_;
};

// Marching squares on the bilinear interpolation; a square with two pieces is decided by its mean.
void isoSegments(const Levels& levels, std::int32_t x, std::int32_t y, const std::array<bool, 4>& in,
                 std::vector<Segment>& out) {
    constexpr int dx[] = {0, 1, 1, 0}, dy[] = {0, 0, 1, 1};
    std::array<double, 4> v;
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        v[k] = levels.at(x + dx[k], y + dy[k]);
        sum += v[k];
    }
    std::array<Point, 4> p{};
    std::array<bool, 4> crossed{};
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t to = (k + 1) % 4;
        crossed[k] = in[k] != in[to];
        // A pixel exactly at the iso value counts as outside: the crossing is there, or half-way if both are.
        const double t = v[k] != v[to] ? std::clamp(v[k] / (v[k] - v[to]), 0.0, 1.0) : 0.5;
        p[k] = {x + dx[k] + t * (dx[to] - dx[k]), y + dy[k] + t * (dy[to] - dy[k])};
    }
    const bool two = in[0] == in[2] && in[1] == in[3] && in[0] != in[1];
    for (std::size_t k = 0; k < 4; ++k) {
        if (!crossed[k] || !in[k]) continue;
        std::size_t to = (k + 1) % 4;
        if (two && sum >= 0) to = (k + 3) % 4;
        while (!crossed[to]) to = (to + 1) % 4;
        out.push_back({p[k], p[to]});
    }
}

}  // namespace

ValueRange valueRange(const Bitmap& bitmap) {
    const auto [low, high] = std::minmax_element(bitmap.values.begin(), bitmap.values.end());
    ValueRange range{*low, *high, true};
    range.twoValues = std::all_of(bitmap.values.begin(), bitmap.values.end(),
                                  [&](float v) { return v == range.low || v == range.high; });
    return range;
}

void refuseNotFinite(const std::string& name, const Bitmap& bitmap) {
    const auto bad = std::find_if_not(bitmap.values.begin(), bitmap.values.end(),
                                      [](float v) { return std::isfinite(v); });
    if (bad == bitmap.values.end()) return;
    const std::int64_t i = bad - bitmap.values.begin();
    throw InputError(name,
                     fmt::format("pixel ({}, {}) is {}; {} of {} pixels are not finite. Replace them first",
                                 i % bitmap.width, i / bitmap.width, *bad,
                                 std::count_if(bitmap.values.begin(), bitmap.values.end(),
                                               [](float v) { return !std::isfinite(v); }),
                                 bitmap.values.size()));
}

Bitmap readBitmap(const std::filesystem::path& path) {
    const std::string name = path.string();
    std::ifstream stream(path, std::ios::binary);
    if (!stream || std::filesystem::is_directory(path)) throw InputError(name, "cannot be read");
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    if (bytes.empty()) throw InputError(name, "is empty; expected an image or polygons");
    const Picture picture = readByContent(bytes, name);
    if (picture.pages > 1)
        throw InputError(name,
                         fmt::format("holds {} pages; a planar curve wants one. Save the page as an image",
                                     picture.pages));
    Bitmap bitmap{static_cast<std::int32_t>(picture.width), static_cast<std::int32_t>(picture.height),
                  luminance(picture)};
    drawOnTransparentGround(picture, bitmap);
    refuseNotFinite(name, bitmap);
    return bitmap;
}

bool hasLightGround(const Bitmap& bitmap, double iso) {
    return allOfBorder(bitmap.width, bitmap.height, [&](auto x, auto y) { return bitmap.at(x, y) > iso; }) &&
           valueRange(bitmap).low <= iso;
}

Shape shapeOf(const Bitmap& bitmap, double iso, bool invert, const std::string& name) {
    const Levels levels(bitmap, iso, invert);
    Shape shape;
    shape.inside.rows.resize(static_cast<std::size_t>(bitmap.height));
    bool any = false;
    for (std::int32_t y = 0; y < bitmap.height; ++y) {
        Spans& row = shape.inside.rows[static_cast<std::size_t>(y)];
        for (std::int32_t x = 0; x < bitmap.width; ++x) {
            if (!levels.inside(x, y)) continue;
            if (!row.empty() && row.back().last == x - 1)
                row.back().last = x;
            else
                row.push_back({x, x});
        }
        any = any || !row.empty();
    }
    if (!any) {
        const ValueRange range = valueRange(bitmap);
        throw InputError(name,
                         fmt::format("no pixel is inside: values run from {} to {}, inside is {} {}; choose "
                                     "another --iso or {}",
                                     range.low, range.high, invert ? "at most" : "above", iso,
                                     invert ? "leave --invert out" : "--invert"));
    }
    for (std::int32_t y = -1; y < bitmap.height; ++y) {
        SpanCursor below(shape.inside.row(y)), above(shape.inside.row(y + 1));
        std::array<bool, 4> in{false, false, false, false};
        for (std::int32_t x = -1; x < bitmap.width; ++x) {
            in = {in[1], below.contains(x + 1), above.contains(x + 1), in[2]};
            if (in[0] != in[1] || in[1] != in[2] || in[2] != in[3])
                isoSegments(levels, x, y, in, shape.boundary);
        }
    }
    return shape;
}

}  // namespace isowave::curves2d
