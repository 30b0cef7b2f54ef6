#include "tests/fuzz/picture.h"

#include "io/picture/asc.h"
#include "io/picture/bmp.h"
#include "io/picture/jpeg.h"
#include "io/picture/npy.h"
#include "io/picture/picture.h"
#include "io/picture/png.h"
#include "io/picture/pnm.h"
#include "io/picture/tiff.h"

namespace isowave::fuzz {
namespace {

using Reader = Picture (*)(std::string_view bytes, const std::string& name);

void check(const Picture& picture) {
    require(picture.width > 0 && picture.height > 0 && picture.channels > 0, "a picture without pixels");
    const auto pixels = static_cast<std::size_t>(picture.width * picture.height);
    require(picture.samples.size() == pixels * picture.channels * sizeOf(picture.type),
            "samples are missing");
    require(luminance(picture).size() == pixels, "grey values are missing");
    answerOf("picture", [&] {
        require(heights(picture, "picture").size() == pixels * heightChannels(picture),
                "heights are missing");
    });
}

bool isStorable(const Picture& p) {
    const bool integer = p.type == ValueType::uint8 || p.type == ValueType::uint16;
    const int values = p.channels - (p.hasOpacity ? 1 : 0);
    return integer && values == (p.isColour ? 3 : 1);
}

void checkPng(const Picture& picture) {
    if (!isStorable(picture)) return;
    const Picture again = readPng(pngBytes(picture), "again");
    require(again.samples == picture.samples && again.channels == picture.channels,
            "a picture changes when it is written as PNG and read again");
}

Answer read(std::string_view bytes, Reader reader) {
    return answerOf("picture", [&] {
        const Picture picture = reader(bytes, "picture");
        check(picture);
        checkPng(picture);
    });
}

}  // namespace

std::vector<Target> pictureTargets() {
    const std::pair<const char*, Reader> readers[] = {
        {"png", readPng}, {"pnm", readPnm},           {"bmp", readBmp},   {"npy", readNpy},
        {"asc", readAsc}, {"tiff-picture", readTiff}, {"jpeg", readJpeg},
    };
    std::vector<Target> targets;
    for (const auto& [name, reader] : readers)
        targets.push_back({name, [reader = reader](std::string_view bytes) { return read(bytes, reader); }});
    return targets;
}

}  // namespace isowave::fuzz
