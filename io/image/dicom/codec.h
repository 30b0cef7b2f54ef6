// One compressed frame -> its stored pixels, through GDCM in a child process.
//
// GDCM is given the pieces of one frame and what the data set says of its pixels, never the file. Its assertions and
// its codecs, which damaged data may crash or lead astray, end the child and not the program.
#pragma once

#include <string>

#include "io/image/dicom/frame.h"

namespace isowave::imageio {

// pieces: the fragments of the frame, one after another. Returns pixels() values of object.type in this machine's byte
// order. Throws InputError, which names the frame and the way in which it is compressed.
std::string decodeFrame(const DicomFrame& frame, const std::vector<std::string>& pieces);

}  // namespace isowave::imageio
