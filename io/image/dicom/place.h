// Where the frames of a stack lie.
//
// u unit vector along the stack, p[i] positions, t[i] = (p[i] - p[0]) . u.  The third axis is the step from the first
// frame to the last, divided by their number less one. For an untilted scan that is the normal of the frames times
// their distance, as itk::ImageSeriesReader has it; for a tilted gantry it leans, and the voxels stay where the scanner
// saw them.
//
// Frames lie on one line in even steps when no p[i] is farther from p[0] + i step u than 1 % of a step, or than the
// rounding of the positions allows, but never farther than 10 % of a step. Many scanners round to 0.1 mm, some before
// they add an offset of four digits; so the rounding is seen in the differences p[i] - p[0], which are then whole
// multiples of 0.1 mm, and not in the digits.
#pragma once

#include <string>
#include <vector>

#include "io/image/dicom/frame.h"
#include "isowave/image.h"

namespace isowave::imageio {

struct PlacedStack {
    bool saysSides = true;        // false: nothing says where left and right are
    DicomStack frames;            // from the origin on
    std::vector<double> heights;  // t[i], mm
    double step = 0;              // mm; 0 where a single frame or the files do not say it
    std::int64_t slices = 0;      // that the volume has: frames.size() unless resampled
    bool even = true;             // t[i] = i step
    Vec3 along;                   // u
    std::vector<std::string> remarks;
};

// Throws InputError, which names frames and numbers: frames at one place (several volumes) of which options.time
// chooses none, frames beside the line, uneven steps unless options.resampleSlices, frames that say neither their place
// nor their order. REQUIRES: frames of one stack, at least one.
PlacedStack placeStack(const std::string& folder, DicomStack stack, const ImageReadOptions& options);

// Whether frames without a second one at any place lie on one line in even steps. REQUIRES: all are placed().
bool liesEvenly(DicomStack stack);

// Farthest that a position may be from its even place. REQUIRES: step > 0.
double placeTolerance(const DicomStack& stack, double step);

}  // namespace isowave::imageio
