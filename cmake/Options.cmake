# Compiler flags that every target of palpa shares, as one interface target.
add_library(palpa_options INTERFACE)
target_compile_options(palpa_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor>
  # Vulkan structs are begun with sType alone; the rest is zero by the language.
  -Wno-missing-field-initializers
  # The twins must give the same bytes whatever instruction set a later flag turns on.
  -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 loses the rounding of double(float(x)) when it vectorises neighbouring components: double, float, double is then no
  # conversion at all, and the twins that round as the device does would not.
  target_compile_options(palpa_options INTERFACE -fno-tree-slp-vectorize)
  # The compiler collects its garbage from 1 GB on: the largest source stays below that, and a test of many templates is compiled a
  # fifth sooner.
  target_compile_options(palpa_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:--param=ggc-min-heapsize=1000000>)
endif()
# Everywhere, since one library's flags may ask for it, and headers that were parsed without it do not serve a source that has it.
target_compile_options(palpa_options INTERFACE -pthread)
if(PALPA_WERROR)
  target_compile_options(palpa_options INTERFACE -Werror)
endif()
# Tests are built with other flags here and there.
define_property(DIRECTORY PROPERTY PALPA_OF_TESTS INHERITED)
define_property(TARGET PROPERTY PALPA_OF_TESTS INHERITED)
set(of_tests $<BOOL:$<TARGET_PROPERTY:PALPA_OF_TESTS>>)
if(PALPA_UNITS)
  # In a unit of tests, constants of one source may stand above local names of another. Shadowed local names are still reported.
  target_compile_options(palpa_options INTERFACE $<${of_tests}:-Wno-shadow>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(palpa_options INTERFACE $<$<AND:${of_tests},$<COMPILE_LANGUAGE:CXX>>:-Wshadow=local>)
  endif()
endif()
# These options make a memory fault end a program instead of serving an attacker: palpa reads files of strangers, and its guard has a
# board open. A program that links the installed libraries needs only the C library that it has anyway. Sanitizers check more
# closely by themselves.
if(NOT PALPA_SANITIZE)
  target_compile_options(palpa_options INTERFACE -fstack-protector-strong -fstack-clash-protection)
  target_compile_definitions(palpa_options INTERFACE _GLIBCXX_ASSERTIONS)
  target_link_options(palpa_options INTERFACE LINKER:-z,relro,-z,now)
  # The C library's checks of buffers need an optimiser, which Debug builds and tests do without. Distributions define it in other ways.
  set(fortify 2)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 12)
    set(fortify 3)
  endif()
  target_compile_options(palpa_options INTERFACE
    "$<$<AND:$<NOT:${of_tests}>,$<NOT:$<CONFIG:Debug>>>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=${fortify}>")
endif()
if(PALPA_SANITIZE)
  # What the last three look for in the tests' own code, AddressSanitizer meets when it happens, or nobody would write there; to be
  # built with them costs a quarter more.
  target_compile_options(palpa_options INTERFACE
    -fsanitize=${PALPA_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer
    $<${of_tests}:-fno-sanitize=null,alignment,vptr>)
  target_link_options(palpa_options INTERFACE -fsanitize=${PALPA_SANITIZE})
  # What the sanitizers note of every check and global is full of addresses: a program that may lie anywhere has over a million to
  # mend whenever it starts, and tests start thousands.
  if(NOT PALPA_SANITIZE STREQUAL "thread")
    target_compile_options(palpa_options INTERFACE -fno-pie)
    target_link_options(palpa_options INTERFACE -no-pie)
  endif()
  # Programs of some 100 MB each: LLVM's linker, where it is, takes less than half the time.
  find_program(PALPA_LLD ld.lld)
  if(PALPA_LLD)
    target_link_options(palpa_options INTERFACE -fuse-ld=lld)
  endif()
endif()
if(PALPA_COVERAGE)
  target_compile_options(palpa_options INTERFACE --coverage)
  target_link_options(palpa_options INTERFACE --coverage)
endif()
