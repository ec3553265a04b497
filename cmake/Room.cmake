# palpa_room(NAME SOURCES ... [SHADERS ...] [PUBLIC ...] [PRIVATE ...]): one room of the engine as a static library
# palpa::NAME. PUBLIC and PRIVATE are the rooms and libraries it may use; arrows point downward only.
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
  target_link_libraries(${target} PUBLIC ${ROOM_PUBLIC} PRIVATE ${ROOM_PRIVATE} $<BUILD_INTERFACE:palpa_options>)
  if(ROOM_SHADERS)
    palpa_shaders(${target} ${ROOM_SHADERS})
  endif()
  set_property(GLOBAL APPEND PROPERTY PALPA_ROOMS ${target})
endfunction()

# palpa_test(NAME SOURCES ... [LINKS ...] [LABELS ...]): one GoogleTest executable per topic, one ctest entry. A test may
# include the embedded SPIR-V ("spirv/name.comp.hpp") of any room it links.
function(palpa_test NAME)
  cmake_parse_arguments(TEST "" "" "SOURCES;LINKS;LABELS" ${ARGN})
  add_executable(${NAME} ${TEST_SOURCES})
  target_link_libraries(${NAME} PRIVATE ${TEST_LINKS} palpa_test_support GTest::gtest palpa_options)
  target_include_directories(${NAME} PRIVATE ${PROJECT_BINARY_DIR})
  add_test(NAME ${NAME} COMMAND ${NAME})
  set_tests_properties(${NAME} PROPERTIES LABELS "${TEST_LABELS}" TIMEOUT 600)
endfunction()
