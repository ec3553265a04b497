# Compiler flags that every target of palpa shares, as one interface target.
add_library(palpa_options INTERFACE)
target_compile_options(palpa_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
  # Vulkan structs are begun with sType alone; the rest is zero by the language.
  -Wno-missing-field-initializers
  # The twins must give the same bytes whatever instruction set a later flag turns on.
  -ffp-contract=off)
if(PALPA_WERROR)
  target_compile_options(palpa_options INTERFACE -Werror)
endif()
if(PALPA_SANITIZE)
  target_compile_options(palpa_options INTERFACE -fsanitize=${PALPA_SANITIZE} -fno-sanitize-recover=all
                                                 -fno-omit-frame-pointer)
  target_link_options(palpa_options INTERFACE -fsanitize=${PALPA_SANITIZE})
endif()
if(PALPA_COVERAGE)
  target_compile_options(palpa_options INTERFACE --coverage)
  target_link_options(palpa_options INTERFACE --coverage)
endif()
