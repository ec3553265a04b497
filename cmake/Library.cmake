# Third-party headers that many sources include are parsed once for all sources built with the same flags. None of
# palpa's own headers are among them. The compiler does not report a source that forgets to include them;
# tests/house/includes.py does (./dev check).
set(PALPA_COMMON_HEADERS <algorithm> <array> <atomic> <chrono> <cmath> <cstdint> <cstring> <filesystem> <fstream>
  <functional> <limits> <map> <memory> <numbers> <numeric> <optional> <random> <span> <string> <string_view> <thread>
  <utility> <vector>
  <glm/glm.hpp>)

# palpa_common_headers(TARGET LINKS ... HEADERS ...): a target that only parses the common headers and the given ones.
# GCC uses them for a source with additional definitions, but never for a source with fewer definitions.
function(palpa_common_headers TARGET)
  cmake_parse_arguments(COMMON "" "" "LINKS;HEADERS" ${ARGN})
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${TARGET}.cpp CONTENT "")
  add_library(${TARGET} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${TARGET}.cpp)
  target_link_libraries(${TARGET} PRIVATE ${COMMON_LINKS} palpa_options Threads::Threads)
  target_include_directories(${TARGET} PRIVATE ${GLM_INCLUDE_DIR})
  target_precompile_headers(${TARGET} PRIVATE ${PALPA_COMMON_HEADERS} ${COMMON_HEADERS})
endfunction()

# palpa_library(NAME SOURCES ... [SHADERS ...] [PUBLIC ...] [PRIVATE ...]): a folder of the engine as a static library
# palpa::NAME. PUBLIC and PRIVATE are the libraries that it may use, besides fmt. Dependencies point downward only.
function(palpa_library NAME)
  cmake_parse_arguments(LIBRARY "" "" "SOURCES;SHADERS;PUBLIC;PRIVATE" ${ARGN})
  set(target palpa_${NAME})
  add_library(${target} STATIC ${LIBRARY_SOURCES})
  add_library(palpa::${NAME} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${NAME} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/engine>
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/palpa>)
  target_link_libraries(${target} PUBLIC ${LIBRARY_PUBLIC} PRIVATE ${LIBRARY_PRIVATE} fmt::fmt
                        $<BUILD_INTERFACE:palpa_options>)
  target_precompile_headers(${target} REUSE_FROM palpa_headers)
  if(LIBRARY_SHADERS)
    palpa_shaders(${target} ${LIBRARY_SHADERS})
  endif()
  set_property(GLOBAL APPEND PROPERTY PALPA_OWN_LIBRARIES ${target})
endfunction()

# palpa_test_headers(TARGET): the tests' common headers. PALPA_TEST_HEADERS names the target that matches the flags of a
# folder's tests.
function(palpa_test_headers TARGET)
  palpa_common_headers(${TARGET} LINKS GTest::gtest HEADERS <gtest/gtest.h> <nlohmann/json.hpp>)
endfunction()

# palpa_test_library(NAME SOURCES ... [LINKS ...]): code that several tests use, compiled once.
function(palpa_test_library NAME)
  cmake_parse_arguments(TEST "" "" "SOURCES;LINKS" ${ARGN})
  add_library(${NAME} STATIC ${TEST_SOURCES})
  target_link_libraries(${NAME} PUBLIC ${TEST_LINKS} palpa_test_support GTest::gtest PRIVATE palpa_options)
  target_precompile_headers(${NAME} REUSE_FROM ${PALPA_TEST_HEADERS})
endfunction()

# palpa_test_computes(SOURCE...): these sources compute reference values for a long time, so they are optimised in every
# build.
function(palpa_test_computes)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS -O2 SKIP_PRECOMPILE_HEADERS ON)
endfunction()

# palpa_test(NAME SOURCES ... [LINKS ...] [LABELS ...] [COST SECONDS] [NEEDS ...] [DEFINES ...] [SHADERS ...] [WAITS]
# [LIVE] [ALONE]): a topic of tests, one ctest entry. The topics of a folder share one GoogleTest program, tests_FOLDER.
# ctest runs it once for each topic, with only the tests of the topic's sources (tests/support/main.cpp). Building NAME
# builds that program. ALONE: the topic has its own program. A test may include the embedded SPIR-V
# ("spirv/name.comp.hpp") of any library that it links. COST is the approximate time of long tests in seconds, which ctest
# starts first. It learns the times of tests without COST; a given one stays, so it must be about right. WAITS: the test
# mostly waits for clocks and for programs that wait; two such tests run in the place of one that computes. LIVE: its
# outcome depends on how fast the machine is, because it needs real processes, clocks, terminals or windows; it gets the
# label live, and only ./dev test live runs it. NEEDS: additional targets that must be built.
function(palpa_test NAME)
  cmake_parse_arguments(TEST "ALONE;WAITS;LIVE" "COST" "SOURCES;LINKS;LABELS;NEEDS;DEFINES;SHADERS" ${ARGN})
  # A build that looks for data races builds nothing else.
  if(PALPA_SANITIZE MATCHES "thread" AND NOT "threads" IN_LIST TEST_LABELS)
    return()
  endif()
  if(TEST_LIVE)
    list(APPEND TEST_LABELS live)
  endif()
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME folder)
  set(program tests_${folder})
  if(TEST_ALONE)
    string(REGEX REPLACE "^test_" "tests_" program ${NAME})
  endif()
  if(NOT TARGET ${program})
    add_executable(${program})
    target_link_libraries(${program} PRIVATE palpa_test_support GTest::gtest palpa_options)
    target_include_directories(${program} PRIVATE ${PROJECT_BINARY_DIR})
    target_precompile_headers(${program} REUSE_FROM ${PALPA_TEST_HEADERS})
  endif()
  target_sources(${program} PRIVATE ${TEST_SOURCES})
  target_link_libraries(${program} PRIVATE ${TEST_LINKS})
  target_compile_definitions(${program} PRIVATE ${TEST_DEFINES})
  if(TEST_SHADERS)
    palpa_shaders(${program} ${TEST_SHADERS})
  endif()
  if(TEST_NEEDS)
    add_dependencies(${program} ${TEST_NEEDS})
  endif()
  add_custom_target(${NAME} DEPENDS ${program})
  set(of ${TEST_SOURCES})
  list(TRANSFORM of REPLACE ".*/" "")
  list(FILTER of INCLUDE REGEX "^test_")
  list(JOIN of "," of)
  add_test(NAME ${NAME} COMMAND ${program} --of=${of})
  set_tests_properties(${NAME} PROPERTIES LABELS "${TEST_LABELS}" TIMEOUT 600)
  # A test that computes takes both places of a core; tests/house/suite.sh gives two per core.
  if(NOT TEST_WAITS)
    set_tests_properties(${NAME} PROPERTIES PROCESSORS 2)
  endif()
  if(TEST_COST)
    set_tests_properties(${NAME} PROPERTIES COST ${TEST_COST})
  endif()
  # A driver that compiles on the processor caches its shaders. Tests that start palpa wait until one run has filled the
  # cache; otherwise, the first few topics would all compile the same shaders. Builds with sanitizers use what the build
  # without has cached.
  if(TEST_LINKS MATCHES "palpa_test_(cli|touch_json)" AND NOT PALPA_SANITIZE)
    set_tests_properties(${NAME} PROPERTIES FIXTURES_REQUIRED shaders)
  endif()
endfunction()
