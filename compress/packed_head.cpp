#include "compress/packed_head.h"

#include <openvdb/io/io.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "compress/coder/quantiser.h"
#include "compress/field_points.h"
#include "compress/sections.h"

namespace isowave::compress {
namespace {

constexpr std::uint32_t kMostChunks = 1 << 16;

void require(bool holds) {
    if (!holds) throw std::runtime_error("its head makes no sense; the file is damaged");
}
bool positive(double value) { return value > 0 && std::isfinite(value); }

std::string textOf(const openvdb::math::Transform& transform) {
    std::ostringstream out;
    transform.write(out);
    return out.str();
}

openvdb::math::Transform::Ptr transformOf(std::string_view bytes) {
    initializeVdb();  // maps are looked up by their names
    std::istringstream in{std::string(bytes)};
    in.exceptions(std::ios::failbit | std::ios::badbit);
    openvdb::io::setCurrentVersion(in);
    auto transform = openvdb::math::Transform::createLinearTransform();
    try {
        transform->read(in);
    } catch (const std::exception&) {
        require(false);
    }
    require(transform->isLinear());
    return transform;
}

void writeQuantised(ByteWriter& writer, const Head& head) {
    writer.u32(head.quantised.has_value());
    if (!head.quantised) return;
    const Head::Quantised& q = *head.quantised;
    for (const double value : {q.bound, q.delta, q.reach, q.voxelsPerK}) writer.f64(value);
}
std::optional<Head::Quantised> readQuantised(ByteReader& reader) {
    const std::uint32_t given = reader.u32();
    require(given <= 1);
    if (given == 0) return std::nullopt;
    Head::Quantised q;
    for (double* value : {&q.bound, &q.delta, &q.reach, &q.voxelsPerK})
        require(positive(*value = reader.f64()));
    require(q.delta >= Quantiser::kLeastDelta && q.delta <= Quantiser::kMostDelta &&
            q.reach <= Quantiser::kMostReach);
    return q;
}

void readBox(ByteReader& reader, Head& head) {
    double count = 1;
    for (int a = 0; a < 3; ++a) head.origin[a] = reader.i32();
    for (int a = 0; a < 3; ++a) {
        const std::int32_t n = head.size[static_cast<std::size_t>(a)] = reader.i32();
        require(n >= 4 && static_cast<std::int64_t>(head.origin[a]) + n < INT32_MAX);
        count *= n;
    }
    head.points = reader.u64();
    require(count <= kMostBoxPoints && static_cast<double>(head.points) <= count);
}

void readChunks(ByteReader& reader, Head& head) {
    const std::uint32_t count = reader.u32();
    require(count > 0 && count <= kMostChunks);
    std::int32_t before = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        head.chunkEnds.push_back(reader.i32());
        require(head.chunkEnds.back() > before);
        before = head.chunkEnds.back();
    }
    require(before == head.size[0]);
}

}  // namespace

std::string bytesOf(const Head& head) {
    ByteWriter writer;
    writer.f64(head.K);
    for (int a = 0; a < 3; ++a) writer.i32(head.origin[a]);
    for (const int n : head.size) writer.i32(n);
    writer.u64(head.points);
    writeQuantised(writer, head);
    writer.u32(static_cast<std::uint32_t>(head.chunkEnds.size()));
    for (const std::int32_t end : head.chunkEnds) writer.i32(end);
    for (const auto& kind : head.weights.of)
        for (const std::int16_t weight : kind) writer.i32(weight);
    writer.text(textOf(*head.transform));
    writer.u32(static_cast<std::uint32_t>(head.source.size()));
    for (const auto& [key, value] : head.source) {
        writer.text(key);
        writer.text(value);
    }
    return deflatedHead(writer.str());
}

Head headOf(std::string_view bytes) {
    const std::string content = inflatedHead(bytes);
    ByteReader reader(content);
    Head head;
    head.K = reader.f64();
    require(positive(head.K));
    readBox(reader, head);
    head.quantised = readQuantised(reader);
    readChunks(reader, head);
    for (auto& kind : head.weights.of)
        for (std::int16_t& weight : kind) weight = static_cast<std::int16_t>(reader.i32());
    head.transform = transformOf(reader.text());
    for (std::uint32_t left = reader.u32(); left > 0; --left) {
        const std::string key(reader.text());
        head.source[key] = std::string(reader.text());
    }
    require(reader.atEnd());
    return head;
}

}  // namespace isowave::compress
