// The register of all files that a program reads and writes: nothing that was read is written over, nothing is written
// twice under two names, and nothing is written that the command line (or a viewer's user) did not ask for.
//
// There is no way around it. Whatever is read goes through base/input_file.hpp, whatever is written through
// base/open_output.hpp (OutputFile, StreamWriter and open_output() itself), and these two ask the register each time.
// tests/house/files.py finds every other way to open a file in the sources, and lists the few that may stay.
//
// A command declares its outputs (base/outputs.hpp) before it reads or opens anything. Then the order no longer
// matters:
//   - an output that was read before it is declared is refused when it is declared,
//   - an input that is declared as an output is refused when it is opened for reading,
//   - what is opened for writing without being declared is a programming error, and an Error.
// Files are told apart by what they are (device and inode), and where there is none yet by folder and name, so links,
// "..", "//" and /proc/self/fd are no way around it either. Devices and pipes cannot be overwritten and are not
// refused.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include "base/output_place.hpp"

namespace palpa {

/// While one lives, as in palpa's programs all the time, what is read is remembered, and what is written has to be
/// declared. Programs that use palpa as a library, and tests, do without: there only declared outputs are guarded.
class KeptRegister {
 public:
  KeptRegister();
  ~KeptRegister();
  KeptRegister(const KeptRegister&) = delete;
  KeptRegister& operator=(const KeptRegister&) = delete;
};

namespace file_register {

/// A file by its folder and its name there, whether it exists or not.
struct Entry {
  FileIdentity folder;
  std::string name;
  bool operator==(const Entry&) const = default;
  bool operator<(const Entry& other) const { return std::tie(folder, name) < std::tie(other.folder, other.name); }
};

/// One declared output.
struct Claim {
  const void* owner;   ///< whose claims end together
  std::string option;  ///< "--json", for messages
  OutputPlace place;
  bool is_folder = false;  ///< all that lies within it is declared, too
  // Filled in by claim():
  Entry entry{};
  std::int64_t born = 0;
};

/// Declares them, or none. Throws bad_usage for what was read already, and for what another owner declares under
/// another option.
void claim(std::vector<Claim> claims);
/// Ends the claims of that owner.
void release(const void* owner);

/// A file is about to be read: remembers it. Throws bad_usage, naming the option, where it is declared as an output.
void reads(const std::filesystem::path& file, const FileIdentity& identity);
/// Whether reads() would have anything to do.
bool is_in_use();

/// A place is about to be written to. Throws bad_usage where it was read, failure() where it is not declared.
void writes(const OutputPlace& place);

/// One of palpa's own files, which it reads and writes without being asked: the viewer's settings, the cache.
void add_own(const std::filesystem::path& file);

}  // namespace file_register
}  // namespace palpa
