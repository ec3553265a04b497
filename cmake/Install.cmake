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

# Libraries include each other as "touch/types.hpp", and the structs that they share with shaders as
# "shaders/touch/contacts/contacts.h".
install(DIRECTORY engine/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/palpa COMPONENT libpalpa-dev
        FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY driver viewer shaders DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/palpa COMPONENT libpalpa-dev
  FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h")

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
