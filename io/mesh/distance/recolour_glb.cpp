#include "io/mesh/distance/recolour_glb.h"

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/read_file.h"
#include "io/mesh/distance/distance_colours.h"
#include "io/mesh/sink.h"

namespace isowave {
namespace {

// glTF 2.0, 4.4: header and heads of the two chunks.
constexpr std::size_t kHeader = 12, kChunkHead = 8;

std::uint32_t u32At(const std::string& bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

}  // namespace

void recolourGlb(const std::filesystem::path& path, double range) {
    std::string bytes = readFile(path, "a GLB");
    const std::size_t described = u32At(bytes, kHeader);
    auto gltf = nlohmann::json::parse(bytes.substr(kHeader + kChunkHead, described));
    if (!gltf.contains("meshes")) return;
    nlohmann::json& mesh = gltf["meshes"][0];
    const std::size_t binary = kHeader + kChunkHead + described + kChunkHead;
    const auto placeOf = [&](const char* attribute) {
        const auto& accessor =
            gltf["accessors"].at(mesh["primitives"][0]["attributes"].at(attribute).get<std::size_t>());
        const auto& view = gltf["bufferViews"].at(accessor["bufferView"].get<std::size_t>());
        return binary + view["byteOffset"].get<std::size_t>();
    };
    const std::size_t distances = placeOf("_DISTANCE_TO_LEVEL0"), colours = placeOf("COLOR_0");
    for (std::size_t at = 0; distances + at * sizeof(float) < colours; ++at) {
        float distance = 0;
        std::memcpy(&distance, bytes.data() + distances + at * sizeof distance, sizeof distance);
        const StoredColour colour = storedDistanceColour(distance, range);
        std::memcpy(bytes.data() + colours + at * sizeof colour, &colour, sizeof colour);
    }
    mesh["extras"]["distance_of_last_colour"] = range;
    std::string text = gltf.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint64_t rest = bytes.size() - (kHeader + kChunkHead + described);
    Sink sink(path);
    sink.text({bytes.data(), 8});  // magic and version
    sink.binary(static_cast<std::uint32_t>(kHeader + kChunkHead + text.size() + rest),
                static_cast<std::uint32_t>(text.size()));
    sink.text({bytes.data() + kHeader + 4, 4});  // "JSON"
    sink.text(text);
    sink.text({bytes.data() + bytes.size() - rest, rest});
    sink.finish();
}

}  // namespace isowave
