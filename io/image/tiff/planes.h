// Which pages of a TIFF are the slices of which channel and time, and how large a voxel is: what ImageJ, OME and
// tifffile write into the first page's ImageDescription, and what the tags say where they write nothing.
//
//   ImageJ    ImageJ=1.53t\nimages=8\nchannels=2\nslices=4\nspacing=1.2\nunit=mm      pages: channel fastest, then slice, frame
//   OME       <Pixels DimensionOrder="XYZCT" SizeZ="4" SizeC="2" PhysicalSizeZ="1.2" PhysicalSizeZUnit="mm" ..><TiffData IFD=..>
//             (Open Microscopy Environment, OME-TIFF specification 6.2)
//   tifffile  {"shape": [2, 4, 48, 40], "axes": "CZYX"}
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/picture/tiff.h"

namespace isowave::imageio {

struct TiffPlanes {
    std::int64_t slices = 1, channels = 1, times = 1;
    std::vector<std::string> channelNames;  // as many as there are channels, or none
    // The page of slice z of channel c at time t is page[z + slices * (c + channels * t)]; -1 where OME names none.
    std::vector<std::int64_t> page;
    // mm; the third is missing where nothing says how far slices are apart.
    std::array<double, 2> pixel{1, 1};
    std::optional<double> step;
    // All images lie behind the one page, one after another (ImageJ's way beyond 4 GB).
    bool behindOnePage = false;
    std::vector<std::string> remarks;
};

// Throws InputError for a description that does not fit the pages, for several images in one file and for planes that lie in other
// files. REQUIRES: pages is not empty.
TiffPlanes planesOf(const std::string& file, const std::vector<TiffPage>& pages);

}  // namespace isowave::imageio
