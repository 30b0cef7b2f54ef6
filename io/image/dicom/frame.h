// The frames of a DICOM file, each with its own place and values. A slice of a series is a file of one frame; from
// here on there is no other difference between them.
//
// What a frame says is looked for in its own functional groups, then in the shared ones, then at the top of the data
// set, whatever the SOP class is: a secondary capture with PixelSpacing and ImagePositionPatient lies where these say.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/value_type.h"
#include "io/image/dicom/data_set.h"
#include "isowave/mesh.h"

namespace isowave::imageio {

// What all frames of a file share.
struct DicomObject {
    DicomFile file;  // without its set
    std::string seriesUid, description, studyUid, frameOfReference, instanceUid, modality;
    std::int64_t columns = 0, rows = 0, frames = 1;
    // A pixel takes `allocated` bits: 1, 8, 12, 16, 32 or 64, of which `stored` up to `highBit` are the value.
    int allocated = 16, stored = 16, highBit = 15;
    ValueType type = ValueType::int16;  // uint8 for 1 bit, 16 bits for 12
    std::string colour;
    std::vector<std::string> segments;  // of a segmentation: "1 'liver'"
    bool isLabelMap = false;            // a segmentation whose pixels are numbers of segments
    std::optional<double> background;   // of one: the number that stands for none, beside 0
    double mostFraction = 0;           // of one whose values are shares of a voxel: what stands for all of it
    std::vector<std::string> remarks;  // what whoever uses the image has to know
    std::string problem;               // why its pixels cannot be used; empty when they can

    std::int64_t pixels() const { return columns * rows; }
};

// One number by which frames at one place differ: a time, an echo.
struct DicomMoment {
    const char* name;
    std::string text;
    double value;
};

struct DicomFrame {
    std::shared_ptr<const DicomObject> object;
    std::int64_t index = 0;                        // within its file
    std::optional<Vec3> position;                  // of the centre of the first pixel, LPS, mm
    std::optional<Vec3> row, column;               // unit vectors: along a row, down a column
    std::optional<std::array<double, 2>> spacing;  // along a row, down a column, mm
    std::string spacingFrom;                       // "PixelSpacing", or what was taken in its place
    double thickness = 0, between = 0;             // mm; 0 where not said
    std::optional<double> location, instance;
    std::string stackId;
    double slope = 1, intercept = 0;  // value = slope * stored + intercept
    std::vector<DicomMoment> moments;
    int segment = 0;

    // The distance of the file's frames is not said; the pixels' width stands in its place.
    bool stepAssumed = false;

    bool placed() const { return position && row && column; }
    // Unit vector. REQUIRES: row and column.
    Vec3 normal() const { return cross(*row, *column) / length(cross(*row, *column)); }
    // "IM0001.dcm", or "IM0001.dcm frame 3" of a file of several.
    std::string name() const;
};

// Frames of one size, orientation and spacing (stack.h).
using DicomStack = std::vector<DicomFrame>;

// Empty for a file without an image: a report, a plan, a DICOMDIR. Frames of which `problem` is set may be fewer than
// the file says. Throws InputError for numbers that are none and for functional groups that are not as many as frames.
std::vector<DicomFrame> framesOf(DicomFile file);

}  // namespace isowave::imageio
