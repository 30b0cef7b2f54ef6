#include "tests/fuzz/solids/packed.h"

#include <array>
#include <cmath>

#include "compress/packed_file.h"
#include "compress/sections.h"
#include "isowave/isowave.h"
#include "tests/fuzz/bytes.h"
#include "tests/zoo/mesh_check.h"
#include "tests/zoo/zoo.h"

namespace isowave::fuzz {
namespace {

using compress::kPackedFormat;

// To the bit and within a bound: other sections are read by other code.
std::vector<Section> smallSections(bool lossless) {
    const auto sectionsWith = [](std::optional<double> bound) {
        const BSplineField field = zoo::distanceField(zoo::smoothSolids().at(1));
        return sectionsOf(kPackedFormat, compress::pack(field, "small", {.bound = bound}).bytes);
    };
    static const std::array<std::vector<Section>, 2> kinds{sectionsWith({}), sectionsWith(0.1)};
    return kinds[lossless ? 0 : 1];
}

void changeContent(std::string& content, Bytes& bytes) {
    if (content.empty()) return;
    const auto place = [&] {
        return (static_cast<std::size_t>(bytes.next()) << 8 | static_cast<std::size_t>(bytes.next())) %
               content.size();
    };
    if (bytes.between(0, 7) == 0) content.resize(place() + 1);
    for (int left = bytes.between(0, 8); left > 0; --left) content[place()] = static_cast<char>(bytes.next());
}

void changeSections(std::vector<Section>& sections, Bytes& bytes) {
    if (sections.empty()) return;
    const auto any = [&] { return sections.begin() + bytes.next() % static_cast<int>(sections.size()); };
    switch (bytes.between(0, 7)) {
        case 0:
            sections.erase(any());
            return;
        case 1:
            sections.push_back(Section(*any()));
            return;
        case 2:
            return std::iter_swap(any(), any());
        case 3:
            any()->kind = static_cast<std::uint32_t>(bytes.next());
            return;
        default:
            changeContent(any()->content, bytes);
    }
}

std::string changedFile(std::string_view input) {
    Bytes bytes(input);
    std::vector<Section> sections = smallSections(bytes.flag());
    for (int k = bytes.between(0, 4); k-- > 0;) changeSections(sections, bytes);
    return isowave::fileOf(kPackedFormat, sections);
}

Answer readPacked(std::string_view input) {
    const bool isFile = input.substr(0, kPackedFormat.magic.size()) == kPackedFormat.magic;
    const auto path = fileOf(isFile ? std::string(input) : changedFile(input), "small.iwz");
    return answerOf(path.string(), [&] {
        const Pyramid pyramid = Pyramid::open(path);
        const std::string wrong = zoo::whatIsWrongWith(pyramid.field(0).polygonize());
        require(wrong.empty(), ("the mesh is not closed and 2-manifold: " + wrong).c_str());
        makeLadder(open(path));
    });
}

}  // namespace

std::vector<Target> packedTargets() { return {{"packed", readPacked}}; }

}  // namespace isowave::fuzz
