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
# Were the package to lean on the source tree, it would break where that tree is gone.
file(GLOB_RECURSE package_files ${prefix}/lib/*.cmake)
foreach(file IN LISTS package_files)
  file(STRINGS ${file} leaks REGEX "${BUILD}")
  if(leaks)
    message(FATAL_ERROR "${file} names the build directory: ${leaks}")
  endif()
endforeach()

run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/consumer -B ${consumer} -G Ninja -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
    -DWANTED_VERSION=${VERSION})
run(${CMAKE_COMMAND} --build ${consumer})
set(assets ${prefix}/share/palpa/assets)
foreach(program feel everything)
  run(${consumer}/${program} ${assets}/cube.glb ${assets}/finger.ply)
endforeach()
run(${consumer}/byte_link_test ${BUILD}/package/bytes)
run(${prefix}/bin/palpa --version)
