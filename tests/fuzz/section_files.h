// Our own files of sections (base/section_file.h): curve-pyramid (.iwc), curve-details, relief-details.
#pragma once

#include "tests/fuzz/target.h"

namespace isowave::fuzz {

// What is read is climbed or put together again, and comes back the same when it is written and read again. Checksums are set right
// first, since a mutation that a checksum finds says nothing of what lies behind it. A file behind the word "plain" has its sections
// but the first without compression, which the target supplies: a mutated zlib stream hardly ever is one.
std::vector<Target> sectionFileTargets();

}  // namespace isowave::fuzz
