# Writes HEADER: the words of the SPIR-V module SPV as a constexpr array. Run by palpa_shaders.
file(READ ${SPV} hex HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${hex}")
string(REGEX REPLACE "((0x[0-9a-f]+,)(0x[0-9a-f]+,)(0x[0-9a-f]+,)(0x[0-9a-f]+,)(0x[0-9a-f]+,)(0x[0-9a-f]+,)(0x[0-9a-f]+,)(0x[0-9a-f]+,))"
       "\\1\n" words "${words}")
cmake_path(GET SHADER FILENAME file)
string(MAKE_C_IDENTIFIER ${file} name)
file(WRITE ${HEADER} "// Generated from shaders/${SHADER}.\n#pragma once\n#include <cstdint>\n"
  "namespace palpa::spirv {\ninline constexpr std::uint32_t ${name}[] = {\n${words}};\n}  // namespace palpa::spirv\n")
# glslang names the .spv as the rule's target; the build system knows the header.
file(READ ${DEPFILE} rule)
string(REPLACE "${SPV}" "${HEADER}" rule "${rule}")
file(WRITE ${DEPFILE} "${rule}")
