// What isowave itself writes, and the values of its options: hierarchy, values.
#pragma once

#include "tests/fuzz/target.h"

namespace isowave::fuzz {

// hierarchy: a file of details, whose checksums are set right first, since a mutation that a checksum finds says nothing of
// what lies behind it; what is read is put together again.
// values: the text of an option, as number, range, list and so on.
std::vector<Target> ownFileTargets();

}  // namespace isowave::fuzz
