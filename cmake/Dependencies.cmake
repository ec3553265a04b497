# All libraries that palpa links. They are Debian packages (see ./dev deps), except V-HACD and, if it is installed,
# librealsense2.
find_package(PkgConfig REQUIRED)
find_package(Vulkan REQUIRED)
find_package(Threads REQUIRED)
find_package(fmt REQUIRED)
find_package(draco REQUIRED)
find_package(meshoptimizer REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PNG REQUIRED)
# It comes with libpng, which needs it.
find_package(ZLIB REQUIRED)
find_package(SQLite3 REQUIRED)
find_path(VOLK_INCLUDE_DIR volk.h REQUIRED)
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)
find_path(TINYGLTF_INCLUDE_DIR tiny_gltf.h REQUIRED)
# Its header is compiled into palpa (engine/geometry/gltf/model.cpp), and says the version.
file(STRINGS ${TINYGLTF_INCLUDE_DIR}/tiny_gltf.h TINYGLTF_VERSION REGEX "- v[0-9]" LIMIT_COUNT 1)
string(REGEX MATCH "[0-9]+[.][0-9.]*[0-9]" TINYGLTF_VERSION "${TINYGLTF_VERSION}")
find_path(GLM_INCLUDE_DIR glm/glm.hpp REQUIRED)
pkg_check_modules(LIBUSB REQUIRED IMPORTED_TARGET libusb-1.0)
pkg_check_modules(LIBMD REQUIRED IMPORTED_TARGET libmd)
pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(OPENBLAS REQUIRED openblas)
pkg_check_modules(QHULL REQUIRED IMPORTED_TARGET qhull_r)
include(cmake/Vhacd.cmake)
# The first version that can report whether a camera is still plugged in.
if(PALPA_REALSENSE STREQUAL "AUTO")
  find_package(realsense2 2.55 QUIET)
elseif(PALPA_REALSENSE)
  find_package(realsense2 2.55 REQUIRED)
endif()
# Messages to a live run.
if(PALPA_LIBLO STREQUAL "AUTO")
  pkg_check_modules(LIBLO QUIET IMPORTED_TARGET liblo)
elseif(PALPA_LIBLO)
  pkg_check_modules(LIBLO REQUIRED IMPORTED_TARGET liblo)
endif()
# Real-time scheduling through rtkit.
if(PALPA_DBUS STREQUAL "AUTO")
  pkg_check_modules(DBUS QUIET IMPORTED_TARGET dbus-1)
elseif(PALPA_DBUS)
  pkg_check_modules(DBUS REQUIRED IMPORTED_TARGET dbus-1)
endif()
if(PALPA_BUILD_VIEWER)
  find_package(glfw3 REQUIRED)
  # The sound in the headphones of a study's participants.
  if(PALPA_SDL2 STREQUAL "AUTO")
    pkg_check_modules(SDL2 QUIET IMPORTED_TARGET sdl2)
  elseif(PALPA_SDL2)
    pkg_check_modules(SDL2 REQUIRED IMPORTED_TARGET sdl2)
  endif()
endif()
if(PALPA_BUILD_TESTS)
  find_package(GTest REQUIRED)
endif()

# What `palpa --version` says of them.
find_package(CLI11 REQUIRED)
set(PALPA_FEATURES "")
foreach(feature IN ITEMS "viewer:${PALPA_BUILD_VIEWER}" "librealsense2:${realsense2_FOUND}" "liblo:${LIBLO_FOUND}"
        "D-Bus:${DBUS_FOUND}" "SDL2:${SDL2_FOUND}" "V-HACD:${PALPA_VHACD_DIR}")
  string(REGEX MATCH "^([^:]+):(.*)$" match ${feature})
  if(CMAKE_MATCH_2)
    string(APPEND PALPA_FEATURES "+${CMAKE_MATCH_1} ")
  else()
    string(APPEND PALPA_FEATURES "-${CMAKE_MATCH_1} ")
  endif()
endforeach()
string(STRIP "${PALPA_FEATURES}" PALPA_FEATURES)
set(PALPA_LIBRARIES "")
foreach(library IN ITEMS "CLI11 ${CLI11_VERSION}" "D-Bus ${DBUS_VERSION}" "draco ${draco_VERSION}"
                         "fmt ${fmt_VERSION}" "GLFW ${glfw3_VERSION}"
                         "liblo ${LIBLO_VERSION}" "libmd ${LIBMD_VERSION}" "libpng ${PNG_VERSION_STRING}"
                         "libusb ${LIBUSB_VERSION}" "lz4 ${LZ4_VERSION}" "meshoptimizer ${meshoptimizer_VERSION}"
                         "nlohmann-json ${nlohmann_json_VERSION}" "OpenBLAS ${OPENBLAS_VERSION}"
                         "qhull ${QHULL_VERSION}" "SDL2 ${SDL2_VERSION}" "SQLite ${SQLite3_VERSION}" "tinygltf ${TINYGLTF_VERSION}"
                         "toml++ ${tomlplusplus_VERSION}"
                         "Vulkan ${Vulkan_VERSION}" "zlib ${ZLIB_VERSION_STRING}")
  if(library MATCHES " [0-9]")
    string(APPEND PALPA_LIBRARIES "${library}, ")
  endif()
endforeach()
string(REGEX REPLACE ", $" "" PALPA_LIBRARIES "${PALPA_LIBRARIES}")
