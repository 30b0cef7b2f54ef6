#include "io/picture/jpeg.h"

#include <cstdio>  // jpeglib.h wants FILE

#include <fmt/format.h>
#include <jerror.h>
#include <jpeglib.h>

#include <algorithm>
#include <cctype>
#include <csetjmp>
#include <vector>

#include "isowave/error.h"

namespace isowave {
namespace {

// A block of 8 x 8 samples takes a bit at least, its first coefficient's code (ITU-T T.81, F.1.2.1). Colours at full resolution, three
// samples a pixel, beside colour differences at a fourth of it: 3 * 1024 samples from 18 blocks.
constexpr double kMostExpansion = 3 * 1024 * 8 / 18.0;
constexpr int kMostScans = 100;

// What libjpeg's callbacks are given. libjpeg's frames lie between them and run(): nothing in those has a destructor.
struct Decoder {
    jpeg_decompress_struct jpeg{};
    jpeg_error_mgr errors{};
    jpeg_progress_mgr progress{};
    std::jmp_buf back;
    char message[JMSG_LENGTH_MAX] = "damaged";
};

[[noreturn]] void giveUp(j_common_ptr jpeg) {
    auto* decoder = static_cast<Decoder*>(jpeg->client_data);
    decoder->errors.format_message(jpeg, decoder->message);
    std::longjmp(decoder->back, 1);
}

// Below 0 are warnings: of a file that breaks off, or whose codes make no sense. libjpeg would go on with grey. Bytes that are not
// needed, and unusual marks of a program, harm nothing.
void onMessage(j_common_ptr jpeg, int level) {
    const int code = jpeg->err->msg_code;
    if (level < 0 && code != JWRN_EXTRANEOUS_DATA && code != JWRN_ADOBE_XFORM && code != JWRN_JFIF_MAJOR)
        giveUp(jpeg);
}

void onProgress(j_common_ptr jpeg) {
    auto* decoder = static_cast<Decoder*>(jpeg->client_data);
    if (decoder->jpeg.input_scan_number <= kMostScans) return;
    std::snprintf(decoder->message, sizeof decoder->message, "it has more than %d scans", kMostScans);
    std::longjmp(decoder->back, 1);
}

class JpegReader {
  public:
    JpegReader(std::string_view bytes, const std::string& name) : name_(name), bytes_(bytes) {
        d_.jpeg.err = jpeg_std_error(&d_.errors);
        d_.errors.error_exit = giveUp;
        d_.errors.emit_message = onMessage;
        d_.errors.output_message = [](j_common_ptr) {};
        d_.progress.progress_monitor = onProgress;
        d_.jpeg.client_data = &d_;
        run([&] {
            jpeg_create_decompress(&d_.jpeg);
            d_.jpeg.client_data = &d_;
            d_.jpeg.progress = &d_.progress;
        });
    }
    ~JpegReader() { jpeg_destroy_decompress(&d_.jpeg); }
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;

    Picture picture() {
        Picture picture = header();
        allocate(picture, name_, 8, bytes_.size(), kMostExpansion);
        const std::size_t stride = picture.samples.size() / static_cast<std::size_t>(picture.height);
        std::vector<JSAMPROW> rows;
        for (std::size_t at = 0; at < picture.samples.size(); at += stride)
            rows.push_back(reinterpret_cast<JSAMPROW>(picture.samples.data()) + at);
        run([&] {
            jpeg_start_decompress(&d_.jpeg);
            while (d_.jpeg.output_scanline < d_.jpeg.output_height)
                jpeg_read_scanlines(&d_.jpeg, rows.data() + d_.jpeg.output_scanline,
                                    d_.jpeg.output_height - d_.jpeg.output_scanline);
            jpeg_finish_decompress(&d_.jpeg);
        });
        return picture;
    }

  private:
    Picture header() {
        run([&] {
            jpeg_mem_src(&d_.jpeg, reinterpret_cast<const unsigned char*>(bytes_.data()),
                         static_cast<unsigned long>(bytes_.size()));
            jpeg_read_header(&d_.jpeg, TRUE);
        });
        const int components = d_.jpeg.num_components;
        if (components != 1 && components != 3)
            throw InputError(name_,
                             fmt::format("is a JPEG of {} colours, such as CMYK, which is not read; save "
                                         "it as PNG",
                                         components));
        d_.jpeg.out_color_space = components == 1 ? JCS_GRAYSCALE : JCS_RGB;
        d_.jpeg.dct_method = JDCT_ISLOW;  // the exact one
        Picture picture;
        picture.width = d_.jpeg.image_width;
        picture.height = d_.jpeg.image_height;
        picture.channels = components;
        picture.isColour = components == 3;
        checkSize(picture, name_);
        return picture;
    }

    // f calls libjpeg and makes nothing that has a destructor.
    template <class F>
    void run(const F& f) {
        if (setjmp(d_.back)) {
            std::string message = d_.message;
            std::replace_if(
                message.begin(), message.end(), [](unsigned char c) { return !std::isprint(c); }, '?');
            throw InputError(name_, "cannot be read as a JPEG: " + message);
        }
        f();
    }

    const std::string& name_;
    std::string_view bytes_;
    Decoder d_;
};

}  // namespace

bool isJpeg(std::string_view bytes) { return bytes.starts_with("\xff\xd8\xff"); }

Picture readJpeg(std::string_view bytes, const std::string& name) {
    if (!isJpeg(bytes)) throw InputError(name, "is no JPEG");
    return JpegReader(bytes, name).picture();
}

}  // namespace isowave
