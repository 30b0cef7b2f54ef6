// Frames of a folder -> stacks: frames of one series, size, orientation and pixel spacing, of which one is a volume.
#pragma once

#include <string>
#include <vector>

#include "io/image/dicom/frame.h"
#include "isowave/image.h"

namespace isowave::imageio {

// In the order in which their first frames come. Orientations are the same within 1e-3 rad, what scanners round their
// cosines to, and spacings within 2e-4, a tenth of a pixel over 512.
std::vector<DicomStack> stacksOf(std::vector<DicomFrame> frames);

// The stack that options.series and options.stack choose, or the only one. Series of one slice each, three or more of
// one study that lie in even steps on a line, are joined first, with a remark. Throws InputError that lists the stacks.
DicomStack pickStack(const std::string& folder, std::vector<DicomStack> stacks,
                     const ImageReadOptions& options, std::vector<std::string>& remarks);

}  // namespace isowave::imageio
