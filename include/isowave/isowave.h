// All of isowave but openvdb.h.
#pragma once

#include "isowave/curves.h"
#include "isowave/error.h"
#include "isowave/field.h"
#include "isowave/filters.h"
#include "isowave/image.h"
#include "isowave/ladder.h"
#include "isowave/measure.h"
#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "isowave/pyramid.h"
#include "isowave/solid.h"
#include "isowave/subdivision.h"
#include "isowave/version.h"
