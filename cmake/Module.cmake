# isowave_module(NAME SOURCES a.cpp ... [PUBLIC lib ...] [PRIVATE lib ...] [GRIDS])
# One static library for each folder, `isowave_NAME`, in the build also known as `isowave::NAME`; all files of the folder
# belong to it. Installed by cmake/Install.cmake, which calls it isowave::part_NAME.
# GRIDS: sources work on OpenVDB's grids; its headers are parsed once for all of them (4 s a source otherwise).
function(isowave_module name)
  cmake_parse_arguments(arg "GRIDS" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target isowave_${name})
  add_library(${target} STATIC ${arg_SOURCES})
  add_library(isowave::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME part_${name} CXX_VISIBILITY_PRESET hidden)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  isowave_warnings(${target})
  target_link_libraries(${target} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
  if(arg_GRIDS)
    isowave_no_precompiled_alarms(${target})
  endif()
  if(arg_GRIDS AND name STREQUAL "volume")
    target_precompile_headers(${target} PRIVATE ${PROJECT_SOURCE_DIR}/volume/vdb.h <fmt/format.h>)
  elseif(arg_GRIDS)
    target_precompile_headers(${target} REUSE_FROM isowave_volume)
  endif()
endfunction()

# With precompiled headers g++ 12 forgets that std::string is a system header: GCC bug 105651, more false alarms.
function(isowave_no_precompiled_alarms target)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overread -Wno-stringop-overflow)
  endif()
endfunction()

# Our warnings, for our own targets only; the libraries' headers are system headers to the compiler.
function(isowave_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
  # g++ 12 sees overlapping copies in std::string's operator+ (GCC bug 105651): a false alarm.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
  if(ISOWAVE_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(ISOWAVE_SANITIZE)
    target_compile_options(${target} PRIVATE
      -fsanitize=${ISOWAVE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${ISOWAVE_SANITIZE})
  endif()
  # What libFuzzer looks at: a counter an edge. Comparisons too would steer it better and cost the tests half of their speed;
  # its dictionary and the seeds stand in for them.
  if(ISOWAVE_FUZZ)
    target_compile_options(${target} PRIVATE -fsanitize-coverage=inline-8bit-counters,pc-table)
  endif()
endfunction()

# isowave_test(NAME SOURCES a_test.cpp ... LIBS lib ... [PRECOMPILE header ...]): one test program, one ctest entry a
# TEST(). Headers that cost seconds are parsed once for all sources, each of which still includes what it uses
# (-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON builds without), and a release compiles with -O1: what the tests call is optimized,
# they themselves need not be. Together that halves what compiling them takes.
function(isowave_test name)
  cmake_parse_arguments(arg "" "TIMEOUT" "SOURCES;LIBS;PRECOMPILE" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  isowave_warnings(${name})
  target_compile_definitions(${name} PRIVATE
    ISOWAVE_TEST_DATA="${PROJECT_SOURCE_DIR}/tests/data"
    ISOWAVE_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    ISOWAVE_BINARY="$<TARGET_FILE_DIR:${name}>/isowave")
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/tests)
  target_link_libraries(${name} PRIVATE ${arg_LIBS} GTest::gtest GTest::gmock GTest::gtest_main)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  target_precompile_headers(${name} PRIVATE <gmock/gmock.h> <gtest/gtest.h> ${arg_PRECOMPILE})
  isowave_no_precompiled_alarms(${name})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  set(environment "")
  if(ISOWAVE_SANITIZE)  # a child process that may take no more memory is told so, not ended; all is slower
    set(environment ENVIRONMENT ASAN_OPTIONS=allocator_may_return_null=1)
    math(EXPR arg_TIMEOUT "5 * ${arg_TIMEOUT}")
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120 PROPERTIES TIMEOUT ${arg_TIMEOUT} ${environment})
endfunction()
include(GoogleTest)
