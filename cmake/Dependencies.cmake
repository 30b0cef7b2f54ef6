# Every package that the build looks for. scripts/setup installs them on Debian 12.

find_package(Threads REQUIRED)
find_package(ZLIB REQUIRED)
find_package(EXPAT REQUIRED)
find_package(libzip REQUIRED)
find_package(draco REQUIRED)  # asks for no more than its own library
# Codecs of Zarr; Debian has no CMake packages of them.
find_package(PkgConfig REQUIRED)
pkg_check_modules(BLOSC REQUIRED IMPORTED_TARGET blosc)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_package(TIFF 4.5 REQUIRED)
find_package(TBB REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(tsl-robin-map REQUIRED)
if(NOT ISOWAVE_SANITIZE)
  find_package(mimalloc 2.0 REQUIRED)
endif()

# OpenVDB ships only a Find module, in a folder that also holds a FindTBB of its own: put the folder on
# the module path for this one call and take it off again.
list(APPEND CMAKE_MODULE_PATH /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB)
find_package(OpenVDB 10 REQUIRED)
list(POP_BACK CMAKE_MODULE_PATH)

find_package(CGAL 5.5 REQUIRED)

if(ISOWAVE_TESTS)
  find_package(GTest REQUIRED)
endif()
