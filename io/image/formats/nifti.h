// NIfTI-1 and NIfTI-2, in one file (.nii) or two (.hdr and .img), plain or gzip whatever the name says; and Analyze 7.5, its
// forerunner (.hdr and .img): spacing, no orientation, SPM's scale factor where there is one.
//
// Where voxels lie, as nifti1.h and nibabel have it: by the sform where sform_code > 0, else by the qform where
// qform_code > 0, else by pixdim alone (method 1), with a remark, since such a file does not say where left and right are.
// xyzt_units counts for spacing and origin. The sform is any affine map, shear included. scl_slope of 0, NaN or infinity
// means that values are as stored, whatever scl_inter says.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/image/formats/stored_volume.h"

namespace isowave::imageio {

// path: the .nii, or either file of a pair. Throws InputError for what is no NIfTI header, RGB and complex numbers, a qform
// that is no rotation, places that are not finite, 2D images.
StoredVolume readNiftiHeader(const std::filesystem::path& path);

// Whether the first bytes, inflated if need be, are those of a NIfTI or Analyze header.
bool beginsAsNifti(const std::filesystem::path& path);

// The .hdr of an .img, if there is one that is a NIfTI or Analyze header; otherwise the path itself.
std::filesystem::path niftiHeaderOf(const std::filesystem::path& path);

// The other file of a pair; nothing for a single file.
std::vector<std::string> niftiVoxelFiles(const std::filesystem::path& path);

}  // namespace isowave::imageio
