// MRC2014 and CCP4 maps of electron microscopes and crystallography (.mrc, .map, .rec, .ccp4): ccpem.ac.uk/mrc-format.
//
// World coordinates are in angstrom, as all programs of the field have them. A voxel is the cell's edge over mx, my, mz, along
// the cell's edges (angles other than 90 degrees are a shear); mapc, mapr, maps say which of them columns, rows and sections run along.
// The first voxel lies at ORIGIN or, where that is 0, at nxstart, nystart, nzstart. No axis is an anatomical one.
#pragma once

#include <filesystem>
#include <string>

#include "io/image/source.h"
#include "isowave/image.h"

namespace isowave::imageio {

// Whether a file that begins so has the map's stamp "MAP " (MRC2000 and later) and axes 1, 2, 3 in some order.
bool beginsAsMrc(const std::string& start);

// Modes 0 (signed, and unsigned where IMOD's flag says so), 1, 2, 6 and 12, in either byte order; a stack of volumes (space
// group 401 and more) holds volumes to choose from. Maps of before 2000, without stamp, too, where the name says MRC. Throws
// InputError: no MRC header, other modes, truncated.
SourcePtr openMrc(const std::filesystem::path& path, const ImageReadOptions& options);

}  // namespace isowave::imageio
