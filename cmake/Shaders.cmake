# palpa_shaders(TARGET folder/name.comp ...): compiles shaders/folder/name.comp to SPIR-V at build time, validates it,
# optimises it, since a driver would spend that time at each start, and embeds it as `palpa::spirv::name_comp` in the
# header "spirv/name.comp.hpp" of the build directory: for a compute shader a gpu::Kernel, for others only the words. A
# shader error fails the build. Because of the depfile, an edited shared header rebuilds every shader that includes it.
find_program(GLSLANG_VALIDATOR glslangValidator REQUIRED)
find_program(SPIRV_VAL spirv-val REQUIRED)
find_program(SPIRV_DIS spirv-dis REQUIRED)
find_program(SPIRV_OPT spirv-opt REQUIRED)

set(PALPA_SHADER_SOURCES ${PROJECT_SOURCE_DIR}/shaders)
set(PALPA_SHADER_EMBED ${CMAKE_CURRENT_LIST_DIR}/EmbedSpirv.cmake)

function(palpa_shaders TARGET)
  set(dir ${PROJECT_BINARY_DIR}/spirv)
  file(MAKE_DIRECTORY ${dir})
  foreach(source IN LISTS ARGN)
    cmake_path(GET source FILENAME shader)
    set(spv ${dir}/${shader}.spv)
    set(header ${dir}/${shader}.hpp)
    add_custom_command(
      OUTPUT ${header}
      BYPRODUCTS ${spv} ${spv}.opt
      COMMAND ${GLSLANG_VALIDATOR} --quiet --target-env vulkan1.3 -I${PROJECT_SOURCE_DIR} --depfile ${header}.d
              -o ${spv} ${PALPA_SHADER_SOURCES}/${source}
      COMMAND ${SPIRV_VAL} --target-env vulkan1.3 --scalar-block-layout ${spv}
      COMMAND ${SPIRV_OPT} -O --target-env=vulkan1.3 ${spv} -o ${spv}.opt
      COMMAND ${SPIRV_VAL} --target-env vulkan1.3 --scalar-block-layout ${spv}.opt
      COMMAND ${CMAKE_COMMAND} -DSPV=${spv} -DHEADER=${header} -DSHADER=${source} -DDEPFILE=${header}.d
              -DSPIRV_DIS=${SPIRV_DIS} -P ${PALPA_SHADER_EMBED}
      DEPENDS ${PALPA_SHADER_SOURCES}/${source} ${PALPA_SHADER_EMBED}
      DEPFILE ${header}.d
      COMMENT "Shader ${source}"
      VERBATIM)
    target_sources(${TARGET} PRIVATE ${header})
  endforeach()
  target_include_directories(${TARGET} PRIVATE ${PROJECT_BINARY_DIR})
endfunction()
