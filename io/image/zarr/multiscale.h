// What OME-Zarr, versions 0.1 to 0.4, says of an image: which arrays are its resolutions, what their axes are and where they lie.
//     https://ngff.openmicroscopy.org/0.4
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace isowave::imageio {

struct ZarrAxis {
    char name = 0;                      // x, y, z, t, c; 0: something else
    std::string unit;                   // "" where there is none
    double scale = 1, translation = 0;  // of index i: scale i + translation, in that unit
};

// One array of a store, and what is known of its axes.
struct ZarrChoice {
    std::filesystem::path array;
    std::vector<ZarrAxis> axes;  // empty where no one says what they are
    bool placed = false;         // scale and translation are the store's
    bool isOme = false;
    std::string others;  // the other resolutions, for a remark: "1, 2"; empty where there are none
};

// path: an array (its folder, with .zarray), an image (its folder, with multiscales in .zattrs), whose first resolution it then is, or one
// of its resolutions by name: scan.zarr/2. Throws InputError for a store of version 3, a group of several images (lists them),
// attributes that make no sense.
ZarrChoice chooseZarrArray(const std::filesystem::path& path);

// Whether a folder is a Zarr store or a part of one, of any version.
bool isZarr(const std::filesystem::path& folder);

}  // namespace isowave::imageio
