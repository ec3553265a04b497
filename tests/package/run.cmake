# cmake -DBUILD=... -DVERSION=... -DCOMPILER=... -DLAUNCHER=... -P run.cmake
set(prefix ${BUILD}/package/prefix)
set(consumer ${BUILD}/package/consumer)
file(REMOVE_RECURSE ${BUILD}/package)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\nexits with ${result}:\n${output}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
foreach(file lib/udev/rules.d/70-palpa.rules libexec/palpa/palpa-guard)
  if(NOT EXISTS ${prefix}/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()
# The installed programs, looked at as the built ones are.
run(${CMAKE_COMMAND} -E env PALPA_PROGRAMS=${prefix}/bin:${prefix}/libexec/palpa ${BUILD}/bin/tests_house
    --of=test_programs.cpp)
# What the installed README points to is there. (A list is not cut at what follows a bracket, so that brackets go
# first.)
file(READ ${prefix}/share/doc/palpa/README.md readme)
string(REPLACE "](" "@" readme "${readme}")
string(REGEX MATCHALL "@[^):#@]+[)#]" links "${readme}")
if(NOT links)
  message(FATAL_ERROR "the installed README has no links")
endif()
foreach(link IN LISTS links)
  string(REGEX REPLACE "[@)#]" "" target ${link})
  if(NOT EXISTS ${prefix}/share/doc/palpa/${target})
    message(FATAL_ERROR "the installed README points to ${target}, which is not installed")
  endif()
endforeach()
# Its page about C++ links to installed headers only, apart from examples in the tests.
file(READ ${prefix}/share/doc/palpa/docs/cpp-api.md page)
string(REPLACE "](" "@" page "${page}")
string(REGEX MATCHALL "@\\.\\./[^):#@]+\\.hpp" headers "${page}")
if(NOT headers)
  message(FATAL_ERROR "docs/cpp-api.md links to no header")
endif()
foreach(header IN LISTS headers)
  string(REGEX REPLACE "@\\.\\./(engine/)?" "" header ${header})
  if(NOT header MATCHES "^tests/" AND NOT EXISTS ${prefix}/include/palpa/${header})
    message(FATAL_ERROR "docs/cpp-api.md points to ${header}, which is not installed")
  endif()
endforeach()
# Were the package to lean on the source tree, it would break where that tree is gone.
file(GLOB_RECURSE package_files ${prefix}/lib/*.cmake)
foreach(file IN LISTS package_files)
  file(STRINGS ${file} leaks REGEX "${BUILD}")
  if(leaks)
    message(FATAL_ERROR "${file} names the build directory: ${leaks}")
  endif()
  # How palpa is hardened is its own business.
  file(STRINGS ${file} flags REGEX "-fstack|FORTIFY|GLIBCXX_ASSERTIONS|relro")
  if(flags)
    message(FATAL_ERROR "${file} asks its users for palpa's own flags: ${flags}")
  endif()
endforeach()

# Its programs run only for a moment; optimising them would take longer.
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/consumer -B ${consumer} -G Ninja -DCMAKE_BUILD_TYPE=Debug
    -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DWANTED_VERSION=${VERSION} -DPAGES=${CMAKE_CURRENT_LIST_DIR}/../..)
run(${CMAKE_COMMAND} --build ${consumer})
set(assets ${prefix}/share/palpa/assets)
foreach(program feel everything)
  run(${consumer}/${program} ${assets}/cube.glb ${assets}/finger.ply)
endforeach()
run(${consumer}/byte_link_test ${BUILD}/package/bytes)
run(${consumer}/live ${assets}/cube.glb ${assets}/finger.ply ${assets}/rigs/paper.toml ${BUILD}/package/drives)

# The example, as a user would build it.
set(example ${BUILD}/package/button_and_knob)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/../../examples/button_and_knob -B ${example} -G Ninja
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})
run(${CMAKE_COMMAND} --build ${example})
execute_process(COMMAND ${example}/button_and_knob ${assets}/button-and-knob.glb ${assets}/finger.ply
                OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
# The tip is 6 mm sin(pi t) - 2 mm deep, so 3 mm at t = 0.3135 s: the first frame after it is number 29. From 1 s to 3 s
# it goes half round.
if(NOT output STREQUAL "0.32 s: button pressed\nknob turned by 180 degrees\n")
  message(FATAL_ERROR "button_and_knob prints:\n${output}")
endif()
run(${prefix}/bin/palpa --version)
run(${prefix}/bin/palpa play heartbeat --layout openmpd --duration 0.1s --csv ${BUILD}/package/heartbeat.csv)
