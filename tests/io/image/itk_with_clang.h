// Included first where clang compiles what includes ITK: Debian's ITK was configured by g++ and refuses any other compiler. For the
// length of the one header that asks, clang says that it is the g++ whose library it uses.
#pragma once

#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wbuiltin-macro-redefined"
#pragma push_macro("__clang__")
#pragma push_macro("__GNUC__")
#undef __clang__
#undef __GNUC__
#define __GNUC__ 12
#include "itk_compiler_detection.h"
#pragma pop_macro("__GNUC__")
#pragma pop_macro("__clang__")
#pragma clang diagnostic pop
