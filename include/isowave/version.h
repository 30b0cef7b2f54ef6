// The version of the library, and what is exported from the shared one.
#pragma once

#define ISOWAVE_VERSION_MAJOR 0
#define ISOWAVE_VERSION_MINOR 1
#define ISOWAVE_VERSION_PATCH 0
#define ISOWAVE_VERSION "0.1.0"

// Everything else in a shared library is hidden.
#define ISOWAVE_EXPORT __attribute__((visibility("default")))
