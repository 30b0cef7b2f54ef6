// countSelfIntersections(), as isowave/measure.h promises it, by CGAL's exact predicates.
#pragma once

#include "isowave/measure.h"
