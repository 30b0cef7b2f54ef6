# isowave_module(NAME SOURCES a.cpp ... [PUBLIC lib ...] [PRIVATE lib ...])
# One static library for each folder, `isowave_NAME`, also known as `isowave::NAME`.
function(isowave_module name)
  cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target isowave_${name})
  if(NOT arg_SOURCES)  # bootstrap: a folder with headers only
    add_library(${target} INTERFACE)
    add_library(isowave::${name} ALIAS ${target})
    target_link_libraries(${target} INTERFACE ${arg_PUBLIC})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
    set_property(GLOBAL APPEND PROPERTY ISOWAVE_MODULES ${target})
    return()
  endif()
  add_library(${target} STATIC ${arg_SOURCES})
  add_library(isowave::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/isowave>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  isowave_warnings(${target})
  target_link_libraries(${target} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
  set_property(GLOBAL APPEND PROPERTY ISOWAVE_MODULES ${target})
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
    target_compile_options(${target} PRIVATE -fsanitize=${ISOWAVE_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${ISOWAVE_SANITIZE})
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
  # With precompiled headers g++ 12 forgets that std::string is a system header: the same bug, more false alarms.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${name} PRIVATE -Wno-array-bounds -Wno-stringop-overread -Wno-stringop-overflow)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120 PROPERTIES TIMEOUT ${arg_TIMEOUT})
endfunction()
include(GoogleTest)
