// The voxels of a frame, from its file.
#pragma once

#include <cstdint>
#include <optional>

#include "io/image/dicom/bytes.h"
#include "io/image/dicom/frame.h"

namespace isowave::imageio {

// Keeps the last file open: frames of one file come one after another.
class DicomPixels {
  public:
    // The frame's pixels, slope and intercept applied, x fastest. Returns how many integers float32 could not hold
    // exactly (none where a scale is applied). REQUIRES: frame.object->problem is empty; out holds pixels() values.
    // Throws InputError.
    std::int64_t read(const DicomFrame& frame, float* out);

  private:
    std::string storedBytes(const DicomFrame& frame);
    std::string uncompressed(const DicomFrame& frame);
    DicomBytes& open(const DicomFrame& frame);

    std::optional<DicomBytes> bytes_;
};

}  // namespace isowave::imageio
