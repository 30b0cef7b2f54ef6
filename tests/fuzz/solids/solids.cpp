// The targets of fuzz_solids: what works on grids.
#include "tests/fuzz/solids/packed.h"
#include "tests/fuzz/solids/shapes.h"
#include "tests/fuzz/solids/vdb.h"

namespace isowave::fuzz {

std::vector<Target> targets() {
    std::vector<Target> all = shapeTargets();
    for (Target& target : vdbTargets()) all.push_back(std::move(target));
    for (Target& target : packedTargets()) all.push_back(std::move(target));
    return all;
}

}  // namespace isowave::fuzz
