#include "io/image/tiff/planes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string_view>

#include "io/image/check.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace {

using Words = std::map<std::string, std::string>;
constexpr std::int64_t kMostPlanes = std::int64_t(1) << 31;

std::optional<double> numberIn(const Words& words, const std::string& key) {
    const auto found = words.find(key);
    if (found == words.end()) return {};
    char* end = nullptr;
    const double value = std::strtod(found->second.c_str(), &end);
    return end != found->second.c_str() && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<double> lengthIn(const Words& words, const std::string& key) {
    const auto value = numberIn(words, key);
    return value && *value > 0 ? value : std::nullopt;
}

// A whole number from `least` on; `otherwise` where it is missing.
std::int64_t countIn(const std::string& file, const Words& words, const std::string& key, std::int64_t least,
                     std::int64_t otherwise) {
    if (!words.contains(key)) return otherwise;
    const auto value = numberIn(words, key);
    if (value && *value >= static_cast<double>(least) && *value <= static_cast<double>(kMostPlanes) &&
        *value == std::floor(*value))
        return static_cast<std::int64_t>(*value);
    throw InputError(file, fmt::format("its description says {} = '{}'; expected a whole number from {} on",
                                       key, oneLine(words.at(key)), least));
}

// ---- units

std::optional<double> millimetresIn(std::string unit) {
    for (const char* micro : {"\xc2\xb5", "\xce\xbc", "\xb5", "\\u00B5", "\\u00b5", "&#181;", "&#xB5;"})
        if (unit.starts_with(micro)) unit.replace(0, std::char_traits<char>::length(micro), "u");
    static const std::map<std::string, double> units = {
        {"pm", 1e-9},       {"\xc3\x85", 1e-7},   {"nm", 1e-6},     {"nanometer", 1e-6}, {"um", 1e-3},
        {"micron", 1e-3},   {"microns", 1e-3},    {"mm", 1},        {"millimeter", 1},   {"cm", 10},
        {"centimeter", 10}, {"dm", 100},          {"m", 1000},      {"meter", 1000},     {"km", 1e6},
        {"inch", 25.4},     {"inches", 25.4},     {"in", 25.4},     {"ft", 304.8},       {"thou", 0.0254},
        {"mil", 0.0254},    {"micrometer", 1e-3}, {"li", 25.4 / 12}};
    const auto found = units.find(unit);
    return found == units.end() ? std::nullopt : std::optional(found->second);
}

void sayNoUnit(TiffPlanes& planes, const std::string& unit) {
    planes.remarks.push_back(
        fmt::format("its voxel size is in '{}', which is no unit of length; mm are assumed; give the spacing",
                    oneLine(unit)));
}

// What the tags say: pixels in an inch or in a cm.
void takeResolution(const TiffPage& page, TiffPlanes& planes) {
    const double unit = page.unit == 2 ? 25.4 : page.unit == 3 ? 10 : 0;
    for (std::size_t a = 0; a < 2; ++a)
        if (unit > 0 && page.perUnit[a] > 0 && std::isfinite(page.perUnit[a]))
            planes.pixel[a] = unit / page.perUnit[a];
}

// ---- axes

struct Axis {
    char letter;
    std::int64_t size;
};

// Numbers the pages where planes follow each other, the first axis slowest. Page `first` is the first one.
void number(TiffPlanes& planes, const std::vector<Axis>& axes, std::int64_t first, std::int64_t begin,
            std::int64_t count) {
    const std::int64_t total = planes.slices * planes.channels * planes.times;
    planes.page.resize(static_cast<std::size_t>(total), -1);
    for (std::int64_t plane = begin; plane < std::min(total, begin + count); ++plane) {
        std::int64_t rest = plane, z = 0, c = 0, t = 0;
        for (auto axis = axes.rbegin(); axis != axes.rend(); ++axis) {
            (axis->letter == 'Z' ? z : axis->letter == 'C' ? c : t) = rest % axis->size;
            rest /= axis->size;
        }
        planes.page[static_cast<std::size_t>(z + planes.slices * (c + planes.channels * t))] =
            first + plane - begin;
    }
}

void requirePlanes(const std::string& file, const char* who, const TiffPlanes& planes, std::int64_t pages) {
    const double total = static_cast<double>(planes.slices) * static_cast<double>(planes.channels) *
                         static_cast<double>(planes.times);
    if (total == static_cast<double>(pages)) return;
    throw InputError(file,
                     fmt::format("{} says slices x channels x times = {} x {} x {} but it holds {} pages; "
                                 "it is truncated, or its description is not its own",
                                 who, planes.slices, planes.channels, planes.times, pages));
}

std::int64_t shownPages(const std::vector<TiffPage>& pages) {
    return std::count_if(pages.begin(), pages.end(), [](const TiffPage& p) { return !p.isThumbnail; });
}

// Pages that are no thumbnails, in order, in place of numbers among them.
void skipThumbnails(const std::vector<TiffPage>& pages, TiffPlanes& planes) {
    std::vector<std::int64_t> shown;
    for (std::size_t k = 0; k < pages.size(); ++k)
        if (!pages[k].isThumbnail) shown.push_back(static_cast<std::int64_t>(k));
    for (std::int64_t& page : planes.page) page = shown.at(static_cast<std::size_t>(page));
}

// ---- ImageJ

Words linesOf(const std::string& text) {
    Words words;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size()), equals = text.find('=', at);
        if (equals < end)
            words.emplace(text.substr(at, equals - at), text.substr(equals + 1, end - equals - 1));
        at = end + 1;
    }
    return words;
}

TiffPlanes planesOfImageJ(const std::string& file, const std::vector<TiffPage>& pages) {
    const Words words = linesOf(pages.front().description);
    TiffPlanes planes;
    planes.channels = countIn(file, words, "channels", 1, 1);
    planes.times = countIn(file, words, "frames", 1, 1);
    const std::int64_t shown = shownPages(pages), images = countIn(file, words, "images", 1, shown);
    planes.slices =
        countIn(file, words, "slices", 1, std::max<std::int64_t>(1, images / planes.channels / planes.times));
    planes.behindOnePage = shown == 1 && images > 1 && pages.front().firstByte > 0;
    requirePlanes(file, "ImageJ", planes, planes.behindOnePage ? images : shown);
    number(planes, {{'T', planes.times}, {'Z', planes.slices}, {'C', planes.channels}}, 0, 0,
           planes.behindOnePage ? images : shown);
    if (!planes.behindOnePage) skipThumbnails(pages, planes);

    takeResolution(pages.front(), planes);
    const std::string unit = words.contains("unit") ? words.at("unit") : "";
    const auto millimetres = millimetresIn(unit);
    const auto spacing = lengthIn(words, "spacing");
    const auto& perUnit = pages.front().perUnit;
    if (millimetres || pages.front().unit == 1) {
        for (std::size_t a = 0; a < 2; ++a)
            if (perUnit[a] > 0) planes.pixel[a] = millimetres.value_or(1) / perUnit[a];
    }
    if (spacing) planes.step = *spacing * millimetres.value_or(1);
    if (!millimetres && (spacing || planes.pixel != std::array<double, 2>{1, 1})) sayNoUnit(planes, unit);
    if (words.contains("c0") && words.contains("c1"))
        planes.remarks.push_back(
            fmt::format("ImageJ's calibration ({} + {} v) is not applied; values are as stored",
                        oneLine(words.at("c0")), oneLine(words.at("c1"))));
    return planes;
}

// ---- OME

// The attributes of a tag, "<Name a="1" b='2'".
Words attributesOf(std::string_view tag) {
    Words words;
    for (std::size_t equals = tag.find('='); equals != std::string_view::npos && equals + 1 < tag.size();
         equals = tag.find('=', equals)) {
        const char quote = tag[equals + 1];
        const std::size_t end = quote == '"' || quote == '\'' ? tag.find(quote, equals + 2) : tag.npos;
        if (end == std::string_view::npos) break;
        const std::size_t before = tag.find_last_of(" \t\r\n", equals);
        const std::size_t begin = before == std::string_view::npos ? 0 : before + 1;
        words.emplace(tag.substr(begin, equals - begin), tag.substr(equals + 2, end - equals - 2));
        equals = end;
    }
    return words;
}

struct Element {
    std::string name;
    Words words;
};

// The opening tags of an XML text, in order, without their namespace.
std::vector<Element> elementsOf(const std::string& text) {
    std::vector<Element> elements;
    for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
        const std::size_t end = text.find('>', at);
        if (end == std::string::npos) break;
        const std::string_view tag = std::string_view(text).substr(at + 1, end - at - 1);
        if (tag.empty() || tag[0] == '/' || tag[0] == '?' || tag[0] == '!') continue;
        std::string name(tag.substr(0, tag.find_first_of(" \t\r\n/")));
        if (const std::size_t colon = name.find(':'); colon != std::string::npos)
            name = name.substr(colon + 1);
        elements.push_back({std::move(name), attributesOf(tag)});
    }
    return elements;
}

std::string wordIn(const Words& words, const std::string& key, const std::string& otherwise) {
    const auto found = words.find(key);
    return found == words.end() ? otherwise : found->second;
}

// "XYZCT" says fastest first; here slowest first, without X and Y.
std::vector<Axis> axesOf(const std::string& file, const Words& pixels, const TiffPlanes& planes) {
    const std::string order = wordIn(pixels, "DimensionOrder", "XYZCT");
    std::string sorted = order;
    std::sort(sorted.begin(), sorted.end());
    if (sorted != "CTXYZ" || !order.starts_with("XY"))
        throw InputError(
            file,
            fmt::format("OME says DimensionOrder '{}'; expected XY and an order of Z, C, T", oneLine(order)));
    std::vector<Axis> axes;
    for (std::size_t k = 4; k >= 2; --k)
        axes.push_back({order[k], order[k] == 'Z'   ? planes.slices
                                  : order[k] == 'C' ? planes.channels
                                                    : planes.times});
    return axes;
}

// Planes that a TiffData names: from First* on, PlaneCount of them, on pages from IFD on.
void takeTiffData(const std::string& file, const Words& data, const std::vector<Axis>& axes,
                  TiffPlanes& planes) {
    std::int64_t begin = 0;
    for (const Axis& axis : axes) {
        const std::int64_t first = countIn(file, data, std::string("First") + axis.letter, 0, 0);
        if (first >= axis.size)
            throw InputError(file, fmt::format("OME says First{} = {} of {}; its description is not its own",
                                               axis.letter, first, axis.size));
        begin = begin * axis.size + first;
    }
    const bool one = data.contains("IFD");
    number(planes, axes, countIn(file, data, "IFD", 0, 0), begin,
           countIn(file, data, "PlaneCount", 0, one ? 1 : kMostPlanes));
}

void takeOmeSizes(const Words& pixels, TiffPlanes& planes) {
    const auto along = [&](char axis) -> std::optional<double> {
        const auto length = lengthIn(pixels, fmt::format("PhysicalSize{}", axis));
        if (!length) return {};
        const std::string unit = wordIn(pixels, fmt::format("PhysicalSize{}Unit", axis), "um");
        const auto millimetres = millimetresIn(unit);
        if (!millimetres) sayNoUnit(planes, unit);
        return *length * millimetres.value_or(1);
    };
    planes.pixel[0] = along('X').value_or(planes.pixel[0]);
    planes.pixel[1] = along('Y').value_or(planes.pixel[1]);
    planes.step = along('Z');
}

TiffPlanes planesOfOme(const std::string& file, const std::vector<TiffPage>& pages) {
    const auto elements = elementsOf(pages.front().description);
    const auto named = [&](const char* name) {
        return std::count_if(elements.begin(), elements.end(),
                             [&](const Element& e) { return e.name == name; });
    };
    if (named("Pixels") != 1)
        throw InputError(file,
                         fmt::format("OME says that it holds {} images; expected one; save the one wanted as "
                                     "a file of its own",
                                     named("Pixels")));
    for (const Element& e : elements)
        if (e.name == "UUID" && e.words.contains("FileName") && named("UUID") > 0 &&
            !file.ends_with(e.words.at("FileName")))
            throw InputError(
                file, fmt::format("OME says that planes lie in '{}'; expected one file; save the image "
                                  "as a single OME-TIFF",
                                  oneLine(e.words.at("FileName"))));
    TiffPlanes planes;
    takeResolution(pages.front(), planes);
    std::vector<Axis> axes;
    for (const Element& e : elements) {
        if (e.name == "Pixels") {
            planes.slices = countIn(file, e.words, "SizeZ", 1, 1);
            planes.channels = countIn(file, e.words, "SizeC", 1, 1);
            planes.times = countIn(file, e.words, "SizeT", 1, 1);
            axes = axesOf(file, e.words, planes);
            takeOmeSizes(e.words, planes);
            const auto shown = shownPages(pages);
            if (planes.slices > shown || planes.channels > shown || planes.times > shown ||
                planes.slices * planes.channels > shown ||
                planes.slices * planes.channels * planes.times > shown)
                requirePlanes(file, "OME", planes, shown);
        } else if (e.name == "Channel" && e.words.contains("Name")) {
            planes.channelNames.push_back(oneLine(e.words.at("Name")));
        } else if (e.name == "TiffData" && !axes.empty()) {
            takeTiffData(file, e.words, axes, planes);
        }
    }
    if (planes.page.empty()) number(planes, axes, 0, 0, kMostPlanes);
    if (std::ssize(planes.channelNames) != planes.channels) planes.channelNames.clear();
    return planes;
}

// ---- tifffile, and nobody

// The numbers of "shape": [2, 56, 48, 40]; nothing where there is no such key.
std::vector<std::int64_t> shapeIn(const std::string& text) {
    std::vector<std::int64_t> shape;
    const std::size_t key = text.find("\"shape\"");
    if (!text.starts_with("{") || key == std::string::npos) return shape;
    const char* at = text.c_str() + std::min(text.find('[', key), text.size() - 1) + 1;
    for (char* end = nullptr;; at = *end == ',' ? end + 1 : end) {
        const long long value = std::strtoll(at, &end, 10);
        if (end == at || value < 1 || value > kMostPlanes) return shape;
        shape.push_back(value);
    }
}

std::string axesIn(const std::string& text) {
    const std::size_t key = text.find("\"axes\"");
    if (key == std::string::npos) return "";
    const std::size_t begin = text.find('"', text.find(':', key));
    return begin == std::string::npos ? "" : text.substr(begin + 1, text.find('"', begin + 1) - begin - 1);
}

// Throws for a shape of several stacks whose axes nobody names.
std::vector<Axis> axesOfShape(const std::string& file, const TiffPage& first, std::int64_t shown) {
    const auto shape = shapeIn(first.description);
    const std::string letters = axesIn(first.description);
    std::vector<Axis> axes;
    std::int64_t planes = 1;
    const std::size_t inPage = first.samples > 1 ? 3 : 2;
    for (std::size_t k = 0; k + inPage < shape.size() && planes <= shown; ++k) {
        planes *= shape[k];
        if (shape[k] > 1) axes.push_back({letters.size() == shape.size() ? letters[k] : '?', shape[k]});
    }
    if (planes != shown || axes.size() < 2)
        return {{axes.size() == 1 && (axes[0].letter == 'C' || axes[0].letter == 'T') && planes == shown
                     ? axes[0].letter
                     : 'Z',
                 shown}};
    std::string sorted;
    for (const Axis& axis : axes) sorted += axis.letter;
    std::sort(sorted.begin(), sorted.end());
    if (sorted != "CZ" && sorted != "TZ" && sorted != "CTZ" && sorted != "CT")
        throw InputError(
            file, fmt::format("its description says {} axes beside x and y, '{}'; expected Z, C and T by "
                              "name; save it as ImageJ or OME TIFF",
                              axes.size(), oneLine(letters)));
    return axes;
}

TiffPlanes planesOfTags(const std::string& file, const std::vector<TiffPage>& pages) {
    TiffPlanes planes;
    takeResolution(pages.front(), planes);
    const auto axes = axesOfShape(file, pages.front(), shownPages(pages));
    for (const Axis& axis : axes)
        (axis.letter == 'Z'   ? planes.slices
         : axis.letter == 'C' ? planes.channels
                              : planes.times) = axis.size;
    number(planes, axes, 0, 0, kMostPlanes);
    skipThumbnails(pages, planes);
    return planes;
}

}  // namespace

TiffPlanes planesOf(const std::string& file, const std::vector<TiffPage>& pages) {
    if (shownPages(pages) == 0) throw InputError(file, "holds thumbnails and masks only; expected slices");
    const std::string& text = pages.front().description;
    if (text.starts_with("ImageJ=")) return planesOfImageJ(file, pages);
    if (text.find("<OME") != std::string::npos || text.find(":OME ") != std::string::npos)
        return planesOfOme(file, pages);
    return planesOfTags(file, pages);
}

}  // namespace isowave::imageio
