#include "io/image/dicom/codec.h"

#include <fmt/format.h>
#include <gdcmFragment.h>
#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>

#include <map>

#include "base/forked_child.h"
#include "io/image/check.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace {

// GDCM as a library talks to the terminal; the child's leads nowhere, but its own switches save the formatting.
void silenceGdcm() {
    gdcm::Trace::DebugOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
}

gdcm::PixelFormat formatOf(const DicomObject& o) {
    const bool isSigned =
        o.type == ValueType::int8 || o.type == ValueType::int16 || o.type == ValueType::int32;
    return gdcm::PixelFormat(1, static_cast<unsigned short>(o.allocated),
                             static_cast<unsigned short>(o.stored), static_cast<unsigned short>(o.highBit),
                             isSigned ? 1 : 0);
}

gdcm::DataElement elementOf(const std::vector<std::string>& pieces) {
    const gdcm::SmartPointer<gdcm::SequenceOfFragments> sequence = new gdcm::SequenceOfFragments;
    for (const std::string& piece : pieces) {
        gdcm::Fragment fragment;
        fragment.SetByteValue(piece.data(), static_cast<std::uint32_t>(piece.size()));
        sequence->AddFragment(fragment);
    }
    gdcm::DataElement element(gdcm::Tag(0x7FE0, 0x0010));
    element.SetVR(gdcm::VR::OB);
    element.SetValue(*sequence);
    return element;
}

// In the child. An empty string: GDCM gave up.
std::string decode(const DicomObject& o, const std::vector<std::string>& pieces) {
    silenceGdcm();
    gdcm::Image image;
    image.SetNumberOfDimensions(2);
    image.SetDimension(0, static_cast<unsigned>(o.columns));
    image.SetDimension(1, static_cast<unsigned>(o.rows));
    image.SetPixelFormat(formatOf(o));
    image.SetPhotometricInterpretation(o.colour == "MONOCHROME1"
                                           ? gdcm::PhotometricInterpretation::MONOCHROME1
                                           : gdcm::PhotometricInterpretation::MONOCHROME2);
    image.SetTransferSyntax(gdcm::TransferSyntax::GetTSType(o.file.syntax.c_str()));
    image.SetDataElement(elementOf(pieces));
    std::string pixels(image.GetBufferLength(), '\0');
    return image.GetBuffer(pixels.data()) ? pixels : std::string();
}

std::string syntaxName(const std::string& syntax) {
    static const std::map<std::string_view, const char*> names = {{".5", "RLE"},
                                                                  {".4.50", "JPEG baseline"},
                                                                  {".4.51", "JPEG extended"},
                                                                  {".4.57", "JPEG lossless"},
                                                                  {".4.70", "JPEG lossless"},
                                                                  {".4.80", "JPEG-LS"},
                                                                  {".4.81", "JPEG-LS"},
                                                                  {".4.90", "JPEG 2000"},
                                                                  {".4.91", "JPEG 2000"}};
    constexpr std::string_view kDicom = "1.2.840.10008.1.2";
    const auto found =
        syntax.starts_with(kDicom) ? names.find(std::string_view(syntax).substr(kDicom.size())) : names.end();
    return found == names.end() ? fmt::format("transfer syntax '{}'", oneLine(syntax)) : found->second;
}

}  // namespace

std::string decodeFrame(const DicomFrame& frame, const std::vector<std::string>& pieces) {
    const DicomObject& o = *frame.object;
    const std::int64_t bytes = o.pixels() * static_cast<std::int64_t>(sizeOf(o.type));
    const auto refuse = [&](const std::string& why) {
        throw InputError(
            o.file.path.string(),
            fmt::format("the pixels{} ({}) cannot be decoded: {}; it is damaged or compressed in a way "
                        "that is not known",
                        o.frames > 1 ? fmt::format(" of frame {}", frame.index + 1) : std::string(),
                        syntaxName(o.file.syntax), why));
    };
    if (o.allocated == 1 || o.allocated == 12) refuse(fmt::format("they have {} bits", o.allocated));
    const ChildLimits limits{.memoryBytes = 16 * bytes + (std::int64_t(512) << 20),
                             .seconds = static_cast<int>(20 + bytes / 5'000'000)};
    ChildAnswer answer = runInChild([&] { return decode(o, pieces); }, limits);
    if (!answer.failure.empty()) refuse("the decoder " + answer.failure);
    if (answer.bytes.empty()) refuse("the decoder gave up");
    if (static_cast<std::int64_t>(answer.bytes.size()) != bytes)
        refuse(fmt::format("{} bytes came out; expected {}", answer.bytes.size(), bytes));
    return std::move(answer.bytes);
}

}  // namespace isowave::imageio
