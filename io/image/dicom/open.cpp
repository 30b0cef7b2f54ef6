#include "io/image/dicom/open.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/image/check.h"
#include "io/image/dicom/sources.h"
#include "io/image/dicom/stack.h"
#include "io/image/kind.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

// What objects without pixels are, for messages.
std::string kindOfObject(const DicomFile& file) {
    const std::string sop = file.set.text(tag::kSopClass), modality = oneLine(file.set.text(tag::kModality));
    if (sop == "1.2.840.10008.1.3.10" || sop.empty()) return "an index or a report";
    return modality.empty() ? "no image" : fmt::format("no image: {}", modality);
}

// Files that were left out, in one remark.
class LeftOut {
  public:
    void add(const fs::path& file, const std::string& why, bool damaged) {
        constexpr int kMost = 5;
        if (++count_ <= kMost)
            text_ += fmt::format("{}{} ({})", count_ == 1 ? "" : ", ", file.filename().string(), why);
        if ((damaged || kindByName(file) == FileKind::dicom) && damaged_.empty())
            damaged_ = fmt::format("{} ({})", file.filename().string(), why);
    }
    // The first file that is damaged, or called a DICOM file and none.
    const std::string& damaged() const { return damaged_; }
    void remarkIn(std::vector<std::string>& remarks) const {
        if (count_ == 0) return;
        remarks.push_back(count_ <= 5 ? "left out: " + text_
                                      : fmt::format("left out: {} and {} more", text_, count_ - 5));
    }
    const std::string& text() const { return text_; }

  private:
    int count_ = 0;
    std::string text_, damaged_;
};

void requireUsable(const DicomStack& stack) {
    for (const DicomFrame& frame : stack)
        if (!frame.object->problem.empty())
            throw InputError(frame.object->file.path.string(), frame.object->problem);
}

bool isSegmentation(const DicomStack& stack) {
    return (stack[0].segment > 0 || stack[0].object->isLabelMap) && stack[0].placed();
}

// options.stack: a segment.
SourcePtr openPicked(const std::string& name, DicomStack stack, const ImageReadOptions& options) {
    requireUsable(stack);
    if (isSegmentation(stack)) return segmentsSource(name, std::move(stack), options);
    PlacedStack placed = placeStack(name, std::move(stack), options);
    Header header = headerOf(placed, options);
    return framesSource(std::move(placed), std::move(header));
}

SourcePtr openStack(const std::string& name, std::vector<DicomFrame> frames, const ImageReadOptions& options,
                    std::vector<std::string> remarks) {
    std::vector<DicomStack> stacks = stacksOf(std::move(frames));
    ImageReadOptions within = options;
    // Beside other stacks, options.stack chooses the segmentation and not a segment of it.
    const bool alone = stacks.size() == 1 && isSegmentation(stacks[0]);
    if (!alone) within.stack.reset();
    SourcePtr source = openPicked(
        name, alone ? std::move(stacks[0]) : pickStack(name, std::move(stacks), options, remarks), within);
    auto& warnings = source->header.warnings;
    warnings.insert(warnings.begin(), remarks.begin(), remarks.end());
    return source;
}

}  // namespace

SourcePtr openDicomFolder(const fs::path& folder, const std::vector<fs::path>& files,
                          const ImageReadOptions& options) {
    std::vector<DicomFrame> frames;
    LeftOut leftOut;
    for (const fs::path& path : files) {
        if (fs::file_size(path) == 0) throw InputError(path.string(), "is empty; expected a DICOM slice");
        if (!looksLikeDicom(path)) {
            leftOut.add(path, "not DICOM", false);
            continue;
        }
        DicomFile file = readDicomFile(path);
        const std::string kind = kindOfObject(file), problem = file.problem;
        std::vector<DicomFrame> its = framesOf(std::move(file));
        if (its.empty()) leftOut.add(path, problem.empty() ? kind : problem, !problem.empty());
        frames.insert(frames.end(), std::make_move_iterator(its.begin()), std::make_move_iterator(its.end()));
    }
    if (frames.empty()) throw InputError(folder.string(), "holds no DICOM image; " + leftOut.text());
    std::vector<std::string> remarks;
    leftOut.remarkIn(remarks);
    try {
        return openStack(folder.string(), std::move(frames), options, std::move(remarks));
    } catch (const InputError& error) {
        // A slice that seems to be missing may be the one that could not be read.
        if (leftOut.damaged().empty()) throw;
        throw InputError(fmt::format("{}; left out was {}", error.what(), leftOut.damaged()));
    }
}

SourcePtr openDicomFile(const fs::path& path, const ImageReadOptions& options) {
    const std::string name = path.string();
    if (!looksLikeDicom(path))
        throw InputError(
            name,
            "is no DICOM file: it has neither 'DICM' at byte 128 nor elements of group 0002 or 0008 at "
            "its start");
    DicomFile file = readDicomFile(path);
    const std::string kind = kindOfObject(file), problem = file.problem;
    std::vector<DicomFrame> frames = framesOf(std::move(file));
    if (frames.empty())
        throw InputError(name, problem.empty()
                                   ? fmt::format("is a DICOM file without an image ({}); give the folder of "
                                                 "the slices",
                                                 kind)
                                   : problem);
    requireUsable({frames[0]});
    if (frames[0].object->frames == 1)
        throw InputError(
            name, fmt::format("is a 2D image ({} x {}); expected a volume; give the folder of its series",
                              frames[0].object->columns, frames[0].object->rows));
    return openStack(name, std::move(frames), options, {});
}

}  // namespace isowave::imageio
