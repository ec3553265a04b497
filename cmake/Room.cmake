# Other people's headers that many sources include, parsed once for all sources built with the same flags; none of palpa's
# own. Since the compiler cannot miss them in a source that forgets them, tests/house/includes.py does (./dev check).
set(PALPA_COMMON_HEADERS <algorithm> <array> <atomic> <chrono> <cmath> <cstdint> <cstring> <filesystem> <fstream> <functional>
  <limits> <map> <memory> <numbers> <numeric> <optional> <random> <span> <string> <string_view> <thread> <utility> <vector>
  <glm/glm.hpp>)

# palpa_common_headers(TARGET LINKS ... HEADERS ...): a target that only parses the common headers, and these. GCC takes them for a
# source that defines more than they saw, never for one that defines less.
function(palpa_common_headers TARGET)
  cmake_parse_arguments(COMMON "" "" "LINKS;HEADERS" ${ARGN})
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${TARGET}.cpp CONTENT "")
  add_library(${TARGET} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${TARGET}.cpp)
  target_link_libraries(${TARGET} PRIVATE ${COMMON_LINKS} palpa_options Threads::Threads)
  target_include_directories(${TARGET} PRIVATE ${GLM_INCLUDE_DIR})
  target_precompile_headers(${TARGET} PRIVATE ${PALPA_COMMON_HEADERS} ${COMMON_HEADERS})
endfunction()

# palpa_room(NAME SOURCES ... [SHADERS ...] [PUBLIC ...] [PRIVATE ...] [HEADERS ...]): one room of the engine as a static library
# palpa::NAME. PUBLIC and PRIVATE are the rooms and libraries it may use, beside fmt; arrows point downward only.
function(palpa_room NAME)
  cmake_parse_arguments(ROOM "" "" "SOURCES;SHADERS;PUBLIC;PRIVATE" ${ARGN})
  set(target palpa_${NAME})
  add_library(${target} STATIC ${ROOM_SOURCES})
  add_library(palpa::${NAME} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${NAME} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/engine>
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/palpa>)
  target_link_libraries(${target} PUBLIC ${ROOM_PUBLIC} PRIVATE ${ROOM_PRIVATE} fmt::fmt $<BUILD_INTERFACE:palpa_options>)
  target_precompile_headers(${target} REUSE_FROM palpa_headers)
  if(ROOM_SHADERS)
    palpa_shaders(${target} ${ROOM_SHADERS})
  endif()
  set_property(GLOBAL APPEND PROPERTY PALPA_ROOMS ${target})
endfunction()

# palpa_test_headers(TARGET): the tests' common headers. PALPA_TEST_HEADERS names those of the flags that a folder's tests are built
# with.
function(palpa_test_headers TARGET)
  palpa_common_headers(${TARGET} LINKS GTest::gtest HEADERS <gtest/gtest.h> <nlohmann/json.hpp>)
endfunction()

# palpa_test_library(NAME SOURCES ... [LINKS ...]): what several tests use, compiled once for them.
function(palpa_test_library NAME)
  cmake_parse_arguments(TEST "" "" "SOURCES;LINKS" ${ARGN})
  add_library(${NAME} STATIC ${TEST_SOURCES})
  target_link_libraries(${NAME} PUBLIC ${TEST_LINKS} palpa_test_support GTest::gtest PRIVATE palpa_options)
  target_precompile_headers(${NAME} REUSE_FROM ${PALPA_TEST_HEADERS})
endfunction()

# palpa_test(NAME SOURCES ... [LINKS ...] [LABELS ...] [COST SECONDS]): one GoogleTest executable per topic, one ctest entry. A
# test may include the embedded SPIR-V ("spirv/name.comp.hpp") of any room it links. COST is for the long ones, by about how many
# seconds: ctest, which learns it from a first run, starts them first.
function(palpa_test NAME)
  cmake_parse_arguments(TEST "" "COST" "SOURCES;LINKS;LABELS" ${ARGN})
  add_executable(${NAME} ${TEST_SOURCES})
  target_link_libraries(${NAME} PRIVATE ${TEST_LINKS} palpa_test_support GTest::gtest palpa_options)
  target_include_directories(${NAME} PRIVATE ${PROJECT_BINARY_DIR})
  target_precompile_headers(${NAME} REUSE_FROM ${PALPA_TEST_HEADERS})
  add_test(NAME ${NAME} COMMAND ${NAME})
  set_tests_properties(${NAME} PROPERTIES LABELS "${TEST_LABELS}" TIMEOUT 600)
  if(TEST_COST)
    set_tests_properties(${NAME} PROPERTIES COST ${TEST_COST})
  endif()
endfunction()
