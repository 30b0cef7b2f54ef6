#include "io/image/segments.h"

#include "io/image/check.h"
#include "io/image/dicom/data_set.h"
#include "io/image/dicom/tags.h"
#include "io/image/formats/nrrd.h"
#include "io/image/kind.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace {

std::vector<ImageSegment> dicomSegments(const std::filesystem::path& path) {
    std::vector<ImageSegment> segments;
    const DicomFile file = readDicomFile(path);
    for (const DicomSet& segment : file.set.items(tag::kSegments))
        segments.push_back(
            {segment.number(tag::kSegmentNumber, 0), oneLine(segment.text(tag::kSegmentLabel))});
    return segments;
}

}  // namespace

std::vector<ImageSegment> segmentsOf(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return {};
    try {
        const FileKind kind = kindOf(path);
        if (kind == FileKind::nrrd) return nrrdSegments(path);
        if (kind == FileKind::dicom) return dicomSegments(path);
    } catch (const InputError&) {
        return {};  // who reads the voxels says it
    }
    return {};
}

}  // namespace isowave::imageio
