# `cmake --install` installs every library with its headers, the programs, and a package for find_package(palpa):
#   find_package(palpa REQUIRED)
#   target_link_libraries(mine PRIVATE palpa::touch palpa::array)   # or palpa::palpa, the whole engine
include(CMakePackageConfigHelpers)

get_property(libraries GLOBAL PROPERTY PALPA_OWN_LIBRARIES)

add_library(palpa_everything INTERFACE)
add_library(palpa::palpa ALIAS palpa_everything)
set_target_properties(palpa_everything PROPERTIES EXPORT_NAME palpa)
target_link_libraries(palpa_everything INTERFACE ${libraries})

install(TARGETS ${libraries} palpa_everything EXPORT palpaTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libpalpa-dev
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libpalpa-dev)

# The public headers, by what a program wants to do (docs/cpp-api.md). What they include is installed with them, and
# nothing else: the other headers may change with any version.
set(PALPA_PUBLIC_HEADERS
  # scenes, bodies and skin
  geometry/files/load_triangles.hpp geometry/files/ply.hpp geometry/gltf/gltf.hpp geometry/solid.hpp
  # fingers and foci, without a session
  touch/stage.hpp
  # sessions: frame by frame, or by themselves
  session/pushed_points.hpp session/session.hpp
  # cameras, recordings and rigs
  sensing/recording.hpp sensing/rig.hpp sensing/surroundings.hpp sensing/synthetic.hpp
  # arrays and drives
  array/drive.hpp array/layouts/board_play.hpp array/layouts/layout.hpp
  # links of one's own, palpa's boards and cameras
  driver/links.hpp driver/sources.hpp session/links/link.hpp session/links/safe_link.hpp session/links/sources.hpp
  # the computation of commands
  setup/sessions/load.hpp setup/tasks/calibrate.hpp setup/tasks/decompose.hpp setup/tasks/drive.hpp
  setup/tasks/export.hpp setup/tasks/field.hpp setup/tasks/scatter.hpp setup/tasks/simulate.hpp setup/tasks/touch.hpp
  # errors, log, devices
  base/error.hpp base/log.hpp gpu/device.hpp)
install(CODE "
  set(SOURCES \"${PROJECT_SOURCE_DIR}\")
  set(HEADERS \"${PALPA_PUBLIC_HEADERS}\")
  set(INCLUDES \"${CMAKE_INSTALL_INCLUDEDIR}/palpa\")" COMPONENT libpalpa-dev)
install(SCRIPT cmake/install_headers.cmake COMPONENT libpalpa-dev)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/palpa)
install(EXPORT palpaTargets NAMESPACE palpa:: DESTINATION ${package_dir} COMPONENT libpalpa-dev)
configure_package_config_file(cmake/palpaConfig.cmake.in ${PROJECT_BINARY_DIR}/palpaConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/palpaConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/palpaConfig.cmake ${PROJECT_BINARY_DIR}/palpaConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT libpalpa-dev)
# The README's links lead into docs/. The links of these pages to headers and tests are for readers of the sources.
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT palpa)
install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT palpa)
