#include "io/picture/picture.h"

#include <fmt/format.h>

#include <limits>

#include "isowave/error.h"

namespace isowave {
namespace {

constexpr std::int64_t kMostPixels = std::int64_t{1} << 31;

template <class T>
double grey(const T* pixel, bool isColour) {
    if (!isColour) return static_cast<double>(pixel[0]);
    return 0.299 * static_cast<double>(pixel[0]) + 0.587 * static_cast<double>(pixel[1]) +
           0.114 * static_cast<double>(pixel[2]);
}

// Calls f(pixel, first sample) for all pixels.
template <class T, class F>
void eachPixel(const Picture& picture, F&& f) {
    const std::span<const T> samples = picture.as<T>();
    const auto step = static_cast<std::size_t>(picture.channels);
    for (std::size_t k = 0; k < samples.size() / step; ++k) f(k, samples.data() + k * step);
}

void requireOpaque(const Picture& picture, const std::string& name) {
    if (!picture.hasOpacity) return;
    withType(picture.type, [&]<class T>(T) {
        eachPixel<T>(picture, [&](std::size_t k, const T* pixel) {
            if (static_cast<double>(pixel[picture.channels - 1]) == picture.fullValue()) return;
            const auto width = static_cast<std::size_t>(picture.width);
            throw InputError(name,
                             fmt::format("the sample at row {}, column {} is transparent; its height is not "
                                         "known: fill such gaps or save it without transparency",
                                         k / width, k % width));
        });
    });
}

}  // namespace

double Picture::fullValue() const {
    return withType(type, []<class T>(T) {
        return std::is_integral_v<T> ? static_cast<double>(std::numeric_limits<T>::max()) : 1.0;
    });
}

void checkSize(const Picture& picture, const std::string& name) {
    const std::int64_t width = picture.width, height = picture.height;
    if (width < 1 || height < 1)
        throw InputError(name,
                         fmt::format("an image of {} x {} pixels; there is nothing in it", width, height));
    if (width > kMostPixels / height)
        throw InputError(name,
                         fmt::format("an image of {} x {} pixels; at most 2^31 pixels are read. Cut it or "
                                     "give its outline as polygons",
                                     width, height));
}

void allocate(Picture& picture, const std::string& name, int bitsEach, std::size_t stored, double expansion) {
    checkSize(picture, name);
    const std::int64_t width = picture.width, height = picture.height;
    if (static_cast<double>(width) * static_cast<double>(height) * bitsEach / 8 >
        static_cast<double>(stored) * expansion)
        throw InputError(name,
                         fmt::format("its header says {} x {} pixels, more than its {} bytes can hold; it is "
                                     "truncated or damaged",
                                     width, height, stored));
    picture.samples.assign(static_cast<std::size_t>(width * height) *
                               static_cast<std::size_t>(picture.channels) * sizeOf(picture.type),
                           std::byte{0});
}

std::vector<float> luminance(const Picture& picture) {
    std::vector<float> values(picture.sampleCount() / static_cast<std::size_t>(picture.channels));
    const double full = picture.fullValue();
    withType(picture.type, [&]<class T>(T) {
        eachPixel<T>(picture, [&](std::size_t k, const T* pixel) {
            const double value = grey(pixel, picture.isColour);
            const double opacity =
                picture.hasOpacity ? static_cast<double>(pixel[picture.channels - 1]) / full : 1;
            values[k] =
                static_cast<float>(picture.hasOpacity ? opacity * value + (1 - opacity) * full : value);
        });
    });
    return values;
}

int heightChannels(const Picture& picture) {
    return picture.isColour ? 1 : picture.channels - (picture.hasOpacity ? 1 : 0);
}

std::vector<double> heights(const Picture& picture, const std::string& name) {
    requireOpaque(picture, name);
    const int kept = heightChannels(picture);
    std::vector<double> values;
    values.reserve(picture.sampleCount() / static_cast<std::size_t>(picture.channels) *
                   static_cast<std::size_t>(kept));
    withType(picture.type, [&]<class T>(T) {
        eachPixel<T>(picture, [&](std::size_t, const T* pixel) {
            if (picture.isColour) return values.push_back(grey(pixel, true));
            for (int c = 0; c < kept; ++c) values.push_back(static_cast<double>(pixel[c]));
        });
    });
    return values;
}

}  // namespace isowave
