// The file of a Hierarchy: saveHierarchy(), writeHierarchy() and loadHierarchy() of isowave/subdivision.h. Everything is
// little-endian:
//
//   8 bytes   "isowmesh"
//   uint32    version, 1 or, where details are 0 and so take fewer bytes, 2
//   uint32    length of the header in bytes
//   uint32    CRC-32 of the header
//   header    JSON: {"scheme", "variant", "steps", "sections": [{"name", "count", "crc32"}, ..]}
//   sections  in that order, one after the other:
//               points 3 float64 | faces uint32 (corners of each face) | corners uint32 | creases uint32 uint32 float64
//               | pinned uint32 | details-1 3 float64 | .. | details-K | order-vertices uint32 | order-corners uint32
//             version 2 has before details-k kept-k, uint32, a bit for each detail of the step, the lowest first: 1 where it is
//             not 0. Only those are in details-k, whose entry has "of", the number of all
#pragma once

#include "isowave/subdivision.h"
