// The register of all files that a program reads and writes. It ensures that no file that was read is overwritten, that
// no file is written twice under two names, and that nothing is written that the command line (or the viewer's user)
// did not ask for.
//
// Every access goes through the register. All reading uses base/input_file.hpp, all writing uses base/open_output.hpp
// (OutputFile, StreamWriter and open_output() itself), and these two ask the register each time. tests/house/files.py
// finds every other way to open a file in the sources, and lists the few exceptions.
//
// A command declares its outputs (base/outputs.hpp) before it reads or opens anything. The order of accesses then does
// not matter:
//   - an output that was read before its declaration is refused when it is declared,
//   - an input that is declared as an output is refused when it is opened for reading,
//   - writing to an undeclared file is a programming error, and throws an Error.
// Files are identified by device and inode, or by folder and name if they do not exist yet. Links, "..", "//" and
// /proc/self/fd therefore cannot bypass the register. Devices and pipes cannot be overwritten and are not refused.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include "base/output_place.hpp"

namespace palpa {

/// During its lifetime, the register remembers what is read, and everything that is written must be declared. palpa's
/// programs keep one all the time. Programs that use palpa as a library, and tests, have none: then the register only
/// guards declared outputs.
class KeptRegister {
 public:
  KeptRegister();
  ~KeptRegister();
  KeptRegister(const KeptRegister&) = delete;
  KeptRegister& operator=(const KeptRegister&) = delete;
};

namespace file_register {

/// A file as its folder and its name in that folder, whether it exists or not.
struct Entry {
  FileIdentity folder;
  std::string name;
  bool operator==(const Entry&) const = default;
  bool operator<(const Entry& other) const { return std::tie(folder, name) < std::tie(other.folder, other.name); }
};

/// One declared output.
struct Claim {
  const void* owner;   ///< claims of one owner end together
  std::string option;  ///< "--json", for messages
  OutputPlace place;
  bool is_folder = false;    ///< everything inside it is declared, too
  bool is_replaced = false;  ///< for a folder: nothing inside it may be read, because it will be deleted
  // Filled in by claim():
  Entry entry{};
  std::int64_t born = 0;
};

/// Declares all of the claims, or none. Throws bad_usage for a file that was already read, for one of palpa's own, and
/// for one that another owner declares under another option.
void claim(std::vector<Claim> claims);
/// Ends all claims of that owner.
void release(const void* owner);

/// Call before reading a file: remembers it. Throws bad_usage, naming the option, if the file is declared as an output.
void reads(const std::filesystem::path& file, const FileIdentity& identity);
/// Whether reads() has anything to do.
bool is_in_use();

/// Call before writing to a place. Throws bad_usage if it was read, failure() if it is not declared.
void writes(const OutputPlace& place);

/// Adds one of palpa's own files, which palpa reads and writes without being asked: the viewer's settings, the cache.
/// Throws bad_usage, naming the option, if the file is declared as an output.
void add_own(const std::filesystem::path& file);

}  // namespace file_register
}  // namespace palpa
