// The information of a program or library for the loader: the dynamic section of an ELF file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpa::test {

struct ElfFile {
  bool position_independent = false;  ///< the loader may put it at any address
  bool program = false;               ///< it names a loader, so it is not a library
  std::vector<std::string> needed;    ///< libraries, by name
  std::optional<std::string> search;  ///< RPATH or RUNPATH
  bool binds_at_start = false;        ///< all functions are resolved before its first instruction
  bool read_only_after_relocation = false;
  std::optional<bool> executable_stack;  ///< empty if the file does not say
  std::vector<std::string> imported;     ///< symbols that others define
  std::string code;                      ///< the bytes of its executable segments
};

/// Empty if the file is not an ELF file of 64 bits, or has no dynamic section.
std::optional<ElfFile> read_elf(const std::filesystem::path& file);

}  // namespace palpa::test
