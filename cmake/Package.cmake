# Debian packages with CPack (./dev package): palpa, palpa-viewer, libpalpa-dev and python3-palpa. The target
# palpa_manual makes what the programs say about themselves, and everything that is installed; it is not part of an
# ordinary build.
set(manual ${PROJECT_BINARY_DIR}/manual)
# The authors of the commits. A person who distributes packages gives a name and an address of their own.
set(PALPA_PACKAGE_MAINTAINER "Seed 09e3c03d maintainers <maintainers@users.noreply.h-seed-09e3c03d.example>"
    CACHE STRING "Maintainer of Debian packages")
set(contact ${PALPA_PACKAGE_MAINTAINER})
set(viewer "")
if(PALPA_BUILD_VIEWER)
  set(viewer $<TARGET_FILE:palpa-viewer>)
endif()
add_custom_target(palpa_manual
  COMMAND ${CMAKE_COMMAND} -DPALPA=$<TARGET_FILE:palpa> -DVIEWER=${viewer} -DVERSION=${PROJECT_VERSION} -DOUT=${manual}
          -DCHANGES=${PROJECT_SOURCE_DIR}/CHANGELOG.md -DCONTACT=${contact} -P ${PROJECT_SOURCE_DIR}/cmake/Manual.cmake
  VERBATIM)
get_property(libraries GLOBAL PROPERTY PALPA_OWN_LIBRARIES)
add_dependencies(palpa_manual palpa ${libraries})
if(PALPA_BUILD_VIEWER)
  add_dependencies(palpa_manual palpa-viewer)
endif()

set(data ${CMAKE_INSTALL_DATADIR})
set(sources ${PROJECT_SOURCE_DIR}/cmake/package)
install(DIRECTORY ${manual}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT palpa
        OPTIONAL FILES_MATCHING PATTERN "*.gz")
install(FILES ${manual}/bash/palpa DESTINATION ${data}/bash-completion/completions COMPONENT palpa OPTIONAL)
install(FILES ${manual}/zsh/_palpa DESTINATION ${data}/zsh/vendor-completions COMPONENT palpa OPTIONAL)
install(FILES ${manual}/fish/palpa.fish DESTINATION ${data}/fish/vendor_completions.d COMPONENT palpa OPTIONAL)
if(PALPA_BUILD_VIEWER)
  install(FILES ${manual}/viewer/man/palpa-viewer.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT palpa-viewer
          OPTIONAL)
  install(FILES ${manual}/viewer/palpa-viewer DESTINATION ${data}/bash-completion/completions COMPONENT palpa-viewer
          OPTIONAL)
  install(FILES ${manual}/viewer/_palpa-viewer DESTINATION ${data}/zsh/vendor-completions COMPONENT palpa-viewer
          OPTIONAL)
  install(FILES ${manual}/viewer/palpa-viewer.fish DESTINATION ${data}/fish/vendor_completions.d COMPONENT palpa-viewer
          OPTIONAL)
  install(FILES ${sources}/palpa-viewer.desktop DESTINATION ${data}/applications COMPONENT palpa-viewer)
  install(FILES ${sources}/palpa-viewer.svg DESTINATION ${data}/icons/hicolor/scalable/apps COMPONENT palpa-viewer)
  install(FILES ${sources}/org.palpa.viewer.metainfo.xml DESTINATION ${data}/metainfo COMPONENT palpa-viewer)
endif()

# Debian's own files, which other installations do not need.
set(packages palpa libpalpa-dev)
if(PALPA_BUILD_VIEWER)
  list(APPEND packages palpa-viewer)
endif()
if(TARGET palpa_python)
  list(APPEND packages python3-palpa)
  add_dependencies(palpa_manual palpa_python)
endif()
foreach(package IN LISTS packages)
  install(FILES ${sources}/copyright DESTINATION ${data}/doc/${package} COMPONENT ${package})
  install(FILES ${manual}/changelog.gz DESTINATION ${data}/doc/${package} COMPONENT ${package} OPTIONAL)
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME palpa)
set(CPACK_PACKAGE_VENDOR "The palpa authors")
set(CPACK_PACKAGE_CONTACT ${contact})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "feel a 3-D model in mid-air")
set(CPACK_COMPONENTS_ALL ${packages})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# It has no programs. CPack would start two processes for each header to find that out.
set(CPACK_DEBIAN_LIBPALPA-DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(long "From depth images of a hand, palpa finds the points of skin that lie just\ninside a 3-D model, and drives an\
 ultrasound array so that the skin feels the\nmodel's surface.")
function(describe PACKAGE SECTION DEPENDS SUMMARY TEXT)
  string(TOUPPER ${PACKAGE} key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${PACKAGE} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${SECTION} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_DEPENDS "${DEPENDS}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${SUMMARY}\n${long}\n.\n${TEXT}" PARENT_SCOPE)
  set(CPACK_COMPONENT_${key}_DESCRIPTION "${SUMMARY}\n${long}\n.\n${TEXT}" PARENT_SCOPE)
endfunction()
describe(palpa science "" "feel a 3-D model in mid-air: command line"
         "This package has the command, the process that holds an array's board, models\nand documentation.")
describe(palpa-viewer science "palpa (= ${PROJECT_VERSION})" "feel a 3-D model in mid-air: viewer"
         "This package has the viewer, which shows a touch or a live run in a window or\nas a picture.")
set(dev libvulkan-dev libvulkan-volk-dev libglm-dev libfmt-dev libpng-dev zlib1g-dev libcli11-dev libdraco-dev
        libmeshoptimizer-dev libtomlplusplus-dev nlohmann-json3-dev libqhull-dev libusb-1.0-0-dev liblz4-dev libmd-dev
        libsqlite3-dev pkg-config)
if(LIBLO_FOUND)
  list(APPEND dev liblo-dev)
endif()
if(DBUS_FOUND)
  list(APPEND dev libdbus-1-dev)
endif()
list(JOIN dev ", " dev)
if(TARGET palpa_python)
  # The module is for one minor version of Python only. The models and the process that holds a board are in palpa.
  math(EXPR next "${PALPA_PYTHON_MINOR} + 1")
  describe(python3-palpa python
           "python3 (>= 3.${PALPA_PYTHON_MINOR}), python3 (<< 3.${next}), python3-numpy, palpa (= ${PROJECT_VERSION})"
           "feel a 3-D model in mid-air: Python module"
           "This package has the module palpa for Python, with arrays of NumPy.")
  # Python compiles the module's sources when the package is installed, and what it made goes with the package.
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/python3-palpa/postinst CONTENT
       "#!/bin/sh\nset -e\nif command -v py3compile >/dev/null; then py3compile -p python3-palpa; fi\n"
       NEWLINE_STYLE UNIX)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/python3-palpa/prerm CONTENT
       "#!/bin/sh\nset -e\nif command -v py3clean >/dev/null; then py3clean -p python3-palpa; fi\n" NEWLINE_STYLE UNIX)
  file(CHMOD ${PROJECT_BINARY_DIR}/python3-palpa/postinst ${PROJECT_BINARY_DIR}/python3-palpa/prerm PERMISSIONS
       OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  set(CPACK_DEBIAN_PYTHON3-PALPA_PACKAGE_CONTROL_EXTRA
      "${PROJECT_BINARY_DIR}/python3-palpa/postinst;${PROJECT_BINARY_DIR}/python3-palpa/prerm")
  # The last three are for the analysis of studies.
  set(CPACK_DEBIAN_PYTHON3-PALPA_PACKAGE_RECOMMENDS
      "mesa-vulkan-drivers | vulkan-icd, python3-pandas, python3-scipy, python3-matplotlib")
endif()
describe(libpalpa-dev libdevel "${dev}" "feel a 3-D model in mid-air: library for development"
         "This package has the engine as static libraries, with headers and a package\nfor CMake.")
# palpa study analyse --script starts Python.
set(CPACK_DEBIAN_PALPA_PACKAGE_RECOMMENDS
    "mesa-vulkan-drivers | vulkan-icd, libopenblas0, python3-pandas, python3-scipy, python3-matplotlib")
set(CPACK_DEBIAN_PALPA-VIEWER_PACKAGE_RECOMMENDS "mesa-vulkan-drivers | vulkan-icd")
include(CPack)
