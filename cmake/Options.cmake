# Compiler flags that every target of palpa shares, as one interface target.
add_library(palpa_options INTERFACE)
target_compile_options(palpa_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor>
  # Vulkan structs are initialised with sType only; the language sets the rest to zero.
  -Wno-missing-field-initializers
  # The twins must give the same bytes with any instruction set that a later flag enables.
  -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 loses the rounding of double(float(x)) when it vectorises neighbouring components: it removes the conversion
  # from double to float and back. The twins would then not round as the device does.
  target_compile_options(palpa_options INTERFACE -fno-tree-slp-vectorize)
  # The compiler collects garbage only above 1 GB. The largest source stays below that, and a test with many templates
  # compiles a fifth sooner.
  target_compile_options(palpa_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:--param=ggc-min-heapsize=1000000>)
endif()
# Set everywhere, because the flags of a library may require it, and headers parsed without it cannot be used for a
# source with it.
target_compile_options(palpa_options INTERFACE -pthread)
if(PALPA_WERROR)
  target_compile_options(palpa_options INTERFACE -Werror)
endif()
# Some flags differ for tests.
define_property(DIRECTORY PROPERTY PALPA_OF_TESTS INHERITED)
define_property(TARGET PROPERTY PALPA_OF_TESTS INHERITED)
set(of_tests $<BOOL:$<TARGET_PROPERTY:PALPA_OF_TESTS>>)
if(PALPA_UNITS)
  # In tests, local names in one source may shadow constants of another. Local names that shadow each other are still
  # reported.
  target_compile_options(palpa_options INTERFACE $<${of_tests}:-Wno-shadow>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(palpa_options INTERFACE $<$<AND:${of_tests},$<COMPILE_LANGUAGE:CXX>>:-Wshadow=local>)
  endif()
endif()
# Hardening: a memory error must end the program so that an attacker cannot use it. palpa reads untrusted files, and its
# guard has a board open. These flags require nothing from users of the installed libraries except the C library that
# they have. Sanitizers do their own, stricter checks.
if(NOT PALPA_SANITIZE)
  target_compile_options(palpa_options INTERFACE -fstack-protector-strong -fstack-clash-protection)
  target_compile_definitions(palpa_options INTERFACE _GLIBCXX_ASSERTIONS)
  target_link_options(palpa_options INTERFACE LINKER:-z,relro,-z,now)
  # The C library's buffer checks need optimisation, which Debug builds and tests do not have. Some distributions define
  # it differently.
  set(fortify 2)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 12)
    set(fortify 3)
  endif()
  target_compile_options(palpa_options INTERFACE
    "$<$<AND:$<NOT:${of_tests}>,$<NOT:$<CONFIG:Debug>>>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=${fortify}>")
endif()
if(PALPA_SANITIZE)
  # In the tests' own code, AddressSanitizer finds the errors of the last three checks when they happen, or nobody would
  # write such code there. Building with these checks takes a quarter longer.
  target_compile_options(palpa_options INTERFACE
    -fsanitize=${PALPA_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer
    $<${of_tests}:-fno-sanitize=null,alignment,vptr>)
  target_link_options(palpa_options INTERFACE -fsanitize=${PALPA_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")  # with sanitizers, GCC warns of a regular expression's states
    target_compile_options(palpa_options INTERFACE -Wno-maybe-uninitialized)
  endif()
  # Undefined behaviour stops the program at an illegal instruction, and AddressSanitizer then reports the file and
  # line. For reports that also give the values, the compiler would add half a million records of data, which the tests'
  # thousands of programs would all register when they start. The check of virtual tables needs these records: it is
  # part of the preset tsan.
  if(PALPA_SANITIZE MATCHES "address" AND PALPA_SANITIZE MATCHES "undefined")
    if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
      target_compile_options(palpa_options INTERFACE -fno-sanitize=vptr -fsanitize-trap=undefined)
    else()
      target_compile_options(palpa_options INTERFACE -fsanitize-undefined-trap-on-error)
    endif()
  endif()
  # Programs and the Python module share AddressSanitizer's library: a process must not have two.
  set(PALPA_ASAN_LIBRARY libasan.so)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang" AND PALPA_SANITIZE MATCHES "address")
    set(PALPA_ASAN_LIBRARY libclang_rt.asan-${CMAKE_SYSTEM_PROCESSOR}.so)
    execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=${PALPA_ASAN_LIBRARY} OUTPUT_VARIABLE library
                    OUTPUT_STRIP_TRAILING_WHITESPACE)
    cmake_path(GET library PARENT_PATH folder)
    target_link_options(palpa_options INTERFACE -shared-libasan LINKER:-rpath,${folder})
  endif()
  # Compilers have different names for these.
  foreach(sanitizer address thread)
    if(PALPA_SANITIZE MATCHES ${sanitizer})
      string(TOUPPER ${sanitizer} name)
      target_compile_definitions(palpa_options INTERFACE PALPA_${name}_SANITIZER)
    endif()
  endforeach()
  # The sanitizers' data on every check and global is full of addresses. A position-independent program has to relocate
  # over a million of them at every start, and tests start thousands of programs.
  # The libraries stay position-independent, because they are in the Python module, too; in a program, the linker
  # resolves their addresses.
  if(NOT PALPA_SANITIZE MATCHES "thread")
    target_compile_options(palpa_options
                           INTERFACE $<$<NOT:$<BOOL:$<TARGET_PROPERTY:POSITION_INDEPENDENT_CODE>>>:-fno-pie>)
    target_link_options(palpa_options INTERFACE $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:-no-pie>)
  endif()
  # The programs have about 100 MB each. LLVM's linker, if installed, takes less than half the time.
  find_program(PALPA_LLD ld.lld)
  if(PALPA_LLD)
    target_link_options(palpa_options INTERFACE -fuse-ld=lld)
  endif()
endif()
if(PALPA_COVERAGE)
  target_compile_options(palpa_options INTERFACE --coverage)
  target_link_options(palpa_options INTERFACE --coverage)
endif()
# palpa_computes(SOURCE...): with sanitizers, the tests would spend more than half of their time in these sources, so
# the compiler optimises them.
function(palpa_computes)
  if(PALPA_SANITIZE)
    set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS -O2 SKIP_PRECOMPILE_HEADERS ON)
  endif()
endfunction()
