// What a program or a library says about itself to the loader: the dynamic section of an ELF file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpa::test {

struct ElfFile {
  bool position_independent = false;  ///< the loader may put it anywhere
  bool program = false;               ///< it asks for a loader of its own: no library
  std::vector<std::string> needed;    ///< libraries, by name
  std::optional<std::string> search;  ///< RPATH or RUNPATH
  bool binds_at_start = false;        ///< all functions are found before the first of its instructions
  bool read_only_after_relocation = false;
  std::optional<bool> executable_stack;  ///< nothing where the file does not say
  std::vector<std::string> imported;     ///< symbols that others define
  std::string code;                      ///< the bytes of its executable segments
};

/// Nothing where the file is no ELF file of 64 bits, or has no dynamic section.
std::optional<ElfFile> read_elf(const std::filesystem::path& file);

}  // namespace palpa::test
