#include "io/picture/pnm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>

#include "isowave/error.h"

namespace isowave {
namespace {

bool isBlank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

// "P" digit, numbers with comments between them, pixels as text or bytes.
class PnmReader {
  public:
    PnmReader(std::string_view bytes, const std::string& name) : name_(name), bytes_(bytes) {}

    Picture picture() {
        const char kind = bytes_[1];
        const bool text = kind <= '3', bits = kind == '1' || kind == '4';
        Picture picture;
        picture.width = number("width");
        picture.height = number("height");
        checkSize(picture, name_);
        const int most = bits ? 1 : number("largest value");
        if (most < 1 || most > 65535)
            throw InputError(name_,
                             fmt::format("its largest value is {}; between 1 and 65535 is possible", most));
        picture.type = most > 255 ? ValueType::uint16 : ValueType::uint8;
        picture.bits = bits ? 1 : most > 255 ? 16 : 8;
        if (!text && at_ < bytes_.size()) ++at_;       // one white space behind the header
        const int bitsEach = text ? 8 : picture.bits;  // text takes at least a character a pixel
        if (picture.width * picture.height * bitsEach / 8 > static_cast<std::int64_t>(bytes_.size() - at_))
            truncated();
        allocate(picture, name_, bitsEach, bytes_.size() - at_, 1);
        if (bits)
            text ? textBits(picture) : packedBits(picture);
        else if (most > 255)
            takeNumbers<std::uint16_t>(picture, text, most);
        else
            takeNumbers<std::uint8_t>(picture, text, most);
        return picture;
    }

  private:
    [[noreturn]] void truncated() const {
        throw InputError(
            name_, fmt::format("ends after {} bytes, before its last pixel; it is truncated", bytes_.size()));
    }
    void skipBlanks() {
        while (at_ < bytes_.size() && (isBlank(bytes_[at_]) || bytes_[at_] == '#')) {
            if (bytes_[at_] == '#')
                at_ = std::min(bytes_.find('\n', at_), bytes_.size());
            else
                ++at_;
        }
    }
    int number(const char* what) {
        skipBlanks();
        if (at_ == bytes_.size()) truncated();
        std::int64_t value = 0;
        const std::size_t begin = at_;
        while (at_ < bytes_.size() && std::isdigit(static_cast<unsigned char>(bytes_[at_])) &&
               value < (1 << 30))
            value = 10 * value + (bytes_[at_++] - '0');
        if (at_ == begin || value >= (1 << 30))
            throw InputError(name_, fmt::format("no number at byte {}, where the {} should be", at_, what));
        return static_cast<int>(value);
    }

    void textBits(Picture& picture) {
        for (std::byte& sample : picture.samples) {
            skipBlanks();
            if (at_ == bytes_.size()) truncated();
            sample = bytes_[at_++] == '1' ? std::byte{0} : std::byte{255};
        }
    }
    void packedBits(Picture& picture) {
        const auto width = static_cast<std::size_t>(picture.width);
        const std::size_t stride = (width + 7) / 8;
        if (bytes_.size() - at_ < stride * static_cast<std::size_t>(picture.height)) truncated();
        for (std::size_t k = 0; k < picture.samples.size(); ++k) {
            const char byte = bytes_[at_ + stride * (k / width) + k % width / 8];
            picture.samples[k] = byte >> (7 - k % width % 8) & 1 ? std::byte{0} : std::byte{255};
        }
    }
    template <class T>
    void takeNumbers(Picture& picture, bool text, int most) {
        if (!text && bytes_.size() - at_ < picture.samples.size()) truncated();
        for (std::size_t k = 0; k < picture.sampleCount(); ++k) {
            const int value = text ? number("pixel") : stored<T>();
            if (value > most)
                throw InputError(
                    name_, fmt::format("pixel {} is {}; its header says that {} is the largest value", k,
                                       value, most));
            const T sample = static_cast<T>(value);
            std::memcpy(picture.samples.data() + k * sizeof(T), &sample, sizeof(T));
        }
    }
    template <class T>
    int stored() {
        int value = 0;
        for (std::size_t k = 0; k < sizeof(T); ++k)
            value = 256 * value + static_cast<unsigned char>(bytes_[at_++]);
        return value;
    }

    const std::string& name_;
    std::string_view bytes_;
    std::size_t at_ = 2;
};

}  // namespace

bool isPnm(std::string_view bytes) {
    return bytes.size() > 2 && bytes[0] == 'P' && std::string_view("1245").find(bytes[1]) != bytes.npos &&
           (isBlank(bytes[2]) || bytes[2] == '#');
}

Picture readPnm(std::string_view bytes, const std::string& name) {
    if (!isPnm(bytes)) throw InputError(name, "is neither PGM nor PBM");
    return PnmReader(bytes, name).picture();
}

}  // namespace isowave
