// The targets of fuzz_files: what is read without a grid.
#include <iterator>

#include "tests/fuzz/image.h"
#include "tests/fuzz/mesh.h"
#include "tests/fuzz/own_files.h"
#include "tests/fuzz/picture.h"
#include "tests/fuzz/section_files.h"
#include "tests/fuzz/vector.h"
#include "tests/fuzz/zarr.h"

namespace isowave::fuzz {

std::vector<Target> targets() {
    std::vector<Target> all;
    for (const auto& group : {meshTargets, imageTargets, pictureTargets, vectorTargets, ownFileTargets,
                              sectionFileTargets, zarrTargets}) {
        auto some = group();
        all.insert(all.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
    }
    return all;
}

}  // namespace isowave::fuzz
