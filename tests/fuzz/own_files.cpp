#include "tests/fuzz/own_files.h"

#include <zlib.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "isowave/subdivision.h"
#include "tools/option_values.h"

namespace isowave::fuzz {
namespace {

// ---- hierarchy (subdivision/meshes/hierarchy_file.h): 8 bytes magic, version, length and CRC-32 of the header, header

constexpr std::size_t kLengthAt = 12, kCrcAt = 16, kHeaderAt = 20;

std::uint32_t crcOf(std::string_view bytes) {
    return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::size_t valueBytes(const std::string& name) {
    if (name == "points" || name.starts_with("details")) return 24;
    return name == "creases" ? 16 : 4;
}

// Sets the checksum of each section that the header names, as far as the file holds it.
void mendSections(nlohmann::json& header, std::string_view rest) {
    std::size_t at = 0;
    for (auto& entry : header.at("sections")) {
        const auto count = entry.at("count").get<std::uint64_t>();
        const std::size_t each = valueBytes(entry.at("name").get<std::string>());
        if (count > (rest.size() - at) / each) return;
        entry["crc32"] = crcOf(rest.substr(at, count * each));
        at += count * each;
    }
}

std::string withTrueChecksums(std::string_view bytes) {
    std::uint32_t length = 0;
    if (bytes.size() < kHeaderAt) return std::string(bytes);
    std::memcpy(&length, bytes.data() + kLengthAt, sizeof length);
    if (length > bytes.size() - kHeaderAt) return std::string(bytes);
    std::string text(bytes.substr(kHeaderAt, length));
    const std::string_view rest = bytes.substr(kHeaderAt + length);
    try {
        nlohmann::json header = nlohmann::json::parse(text);
        mendSections(header, rest);
        text = header.dump();
    } catch (const nlohmann::json::exception&) {
        // no JSON: with a true checksum it reaches the reader's own parser
    }
    std::string result(bytes.substr(0, kLengthAt));
    for (const std::uint32_t value : {static_cast<std::uint32_t>(text.size()), crcOf(text)})
        result.append(reinterpret_cast<const char*>(&value), sizeof value);
    return result + text + std::string(rest);
}

Answer readHierarchy(std::string_view bytes) {
    const auto path = fileOf(withTrueChecksums(bytes), "mesh.details");
    return answerOf(path.string(), [&] {
        const subdivision::Hierarchy hierarchy = subdivision::loadHierarchy(path);
        constexpr std::size_t kFewFaces = 4096;
        if (hierarchy.steps() > 4 || hierarchy.base.faceCount() > kFewFaces) return;
        const subdivision::PolygonMesh mesh = subdivision::reconstruct(hierarchy);
        for (const auto corner : mesh.corners)
            require(corner < mesh.points.size(), "a corner beyond the points");
    });
}

// ---- values

Answer readValues(std::string_view bytes) {
    const std::string text(bytes);
    Answer any = Answer::refused;
    const auto attempt = [&](const auto& work) {
        if (answerOf(text, work) == Answer::read) any = Answer::read;
    };
    attempt([&] { require(std::isfinite(tools::number(text)), "a number that is not finite"); });
    attempt([&] { require(tools::positive(text) > 0, "a positive number that is none"); });
    attempt([&] {
        const auto value = tools::integer(text, -5, 1'000'000'000'000);
        require(value >= -5 && value <= 1'000'000'000'000, "an integer out of its range");
    });
    attempt([&] {
        const StepRange range = tools::range(text);
        require(range.first >= 0 && (!range.last || *range.last >= range.first), "a range that is none");
    });
    attempt([&] {
        for (const double x : tools::triple(text, "0.5x0.5x1")) require(std::isfinite(x), "not finite");
    });
    attempt([&] { tools::wholeTriple(text, "10x20x30"); });
    attempt([&] { tools::list(text, tools::number); });
    attempt([&] { require(!tools::place(text).empty(), "a place without a name"); });
    return any;
}

}  // namespace

std::vector<Target> ownFileTargets() { return {{"hierarchy", readHierarchy}, {"values", readValues}}; }

}  // namespace isowave::fuzz
