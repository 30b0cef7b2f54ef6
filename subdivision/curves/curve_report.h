// The whole story of a file of curves: `isowave curve-levels`. Nothing here prints or writes; what would be
// written is returned by name.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "subdivision/curves/curve_files.h"

namespace isowave::subdivision {

struct CurveReportOptions {
    std::string scheme = "dlg-refined";
    std::string mask = {};  // "1/8 1/2 3/4 1/2 1/8": one of your own instead, for closed curves
    int width = 0;          // of A for such a mask; 0: the smallest there is
    int levels = 6;
    std::optional<std::size_t> resample = {};  // this many points at equal steps first
    std::optional<double> threshold = {};      // details shorter than this become 0
    std::optional<std::size_t> keep = {};      // or: only this many of the longest stay
    bool compare = false;                      // the L2 errors of dlg-trial, dlg-refined, dlg-optimal too
};

struct CurveReport {
    struct Curve {
        int dimension = 2;
        bool closed = false;
        std::vector<std::size_t> points;  // of level 0, 1, ..; a short curve has fewer levels than asked for
        std::vector<double> error;        // ||level 0 - what P alone makes of level k||_2
        double roundTrip = 0;             // largest difference of a coordinate after reconstruction
        std::size_t details = 0, detailsLeft = 0;
        double thresholdError = 0;               // ||level 0 - the curve with the details that are left||_2
        std::map<std::string, double> compared;  // error of the coarsest level by scheme, when asked for
    };
    std::string scheme;
    int levels = 0;
    std::vector<Curve> curves;
    std::vector<std::string> remarks;
    // Name without folder -> bytes: level_0.EXT .. level_L.EXT, smooth.EXT (P alone on the coarsest level),
    // and thresholded.EXT when details were dropped. EXT is the input's.
    std::map<std::string, std::string> files;
};

// Curves that are too short for `levels` go as far as they can, with a remark. Throws InputError when none of
// them has that many levels (and says how many points are needed).
CurveReport reportCurves(const CurveFile& file, const std::string& extension,
                         const CurveReportOptions& options);

// A table for people, with the mean ratios beside O-T1's Coast row when schemes were compared.
std::string text(const CurveReport& report);
std::string json(const CurveReport& report);

}  // namespace isowave::subdivision
