// Which files may be written. No file that was read is overwritten, no file is written twice under two names, and
// nothing is written that the command line (or the viewer's user) did not ask for.
//
// All reading (base/files/input_file.hpp) and all writing (base/files/output_file.hpp) asks here (see
// tests/house/files.py). A command declares its outputs before it opens anything. The order of accesses then does not
// matter: an output that was read is refused when it is declared, and a declared output when it is read. Links, "..",
// "//" and /proc/self/fd make no difference. Devices and pipes cannot be overwritten and are not refused.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"

namespace palpa {

/// Device, inode and time of birth: a file under all of its names. All zero: there is none. The inode of a deleted file
/// may be given to a new one, which is born later. (The time is 0 on file systems that do not know it.)
using FileIdentity = std::array<std::uint64_t, 3>;

/// What a file name given for writing refers to.
struct OutputPlace {
  std::string name;            ///< for messages: what the user wrote, "stdout" for "-"
  std::filesystem::path path;  ///< with symbolic links resolved, dangling ones included
  /// `unknown` is a device, a pipe or a terminal.
  std::filesystem::file_type type = std::filesystem::file_type::not_found;
  FileIdentity identity{};                       ///< that of the existing file
  std::pair<FileIdentity, std::string> entry{};  ///< its folder, and its name in that, whether it exists or not
  bool open_already = false;  ///< a descriptor that is already open ("-", /proc/self/fd/3), which is written in place
  bool is_personal = false;   ///< it lies in a declared personal folder
  bool is_stdout = false;     ///< "-", or any name of what stdout is open on; opened twice, it would overwrite itself

  std::filesystem::path folder() const { return path.has_parent_path() ? path.parent_path() : "."; }
};

/// The place of a file that may be written or removed now. Throws bad_usage if it was read; failure() if it is not
/// declared (it names the link if one leads there from a declared folder), or clearly cannot be created or replaced
/// there: no such folder, a folder, no permission, a read-only file system. Tries nothing. (A full disk only shows
/// during writing.)
OutputPlace writable_place(const std::filesystem::path& file);

/// Whether the file or folder, which need not exist, is or lies in a declared personal folder.
bool is_personal(const std::filesystem::path& file);

/// failure(): `name: cannot be written:` and the meaning of the system's error code, such as a full disk.
Error write_failure(const std::string& name, int code);

/// One of a command's outputs, as the command line gave it.
struct Output {
  enum class Kind {
    file,
    folder,              ///< a new or empty one
    recording,           ///< the same; the refusal of another one names --overwrite
    replaced_recording,  ///< a folder whose files will be deleted, so none of them may be an input
    personal_folder,     ///< of a participant: its files are read and written, and only their owner may read them
  };

  std::string option;  ///< "--json", for messages
  std::string target;  ///< "-" is stdout; "" if there is no output
  Kind kind = Kind::file;
};

/// While this object lives, the outputs may be written, with everything in their folders, and reading one of them under
/// any name is refused. Devices and pipes may be read, and written twice. If several objects live, as in the viewer,
/// the same option of two of them may name the same file.
class Outputs {
 public:
  /// Throws, before anything is changed, failure() for an output that cannot be written there; bad_usage for a folder
  /// that is not empty, two outputs that are the same file, an output that was read, an output inside another's folder,
  /// and two outputs on stdout.
  explicit Outputs(const std::vector<Output>& outputs);
  ~Outputs();
  Outputs(const Outputs&) = delete;
  Outputs& operator=(const Outputs&) = delete;

  /// Whether one of them is stdout. Nothing else may be printed to stdout then.
  bool on_stdout() const { return on_stdout_; }

 private:
  bool on_stdout_ = false;
};

/// Until the result ends, everything that is read is remembered, and everything that is written must be declared.
/// palpa's programs keep one all the time. Programs that use palpa as a library, and tests, have none: then only
/// declared outputs are guarded.
[[nodiscard]] std::shared_ptr<void> keep_register();

/// For an input that was opened (its descriptor), or is read later or never: remembers it, and throws bad_usage, naming
/// the option, if it is a declared output. Does nothing for "" and for names that are not files.
void refuse_output_as_input(const std::filesystem::path& file, int descriptor = -1);

/// Adds one of palpa's own files, which palpa reads and writes without being asked: the viewer's settings, the cache.
/// Throws bad_usage, naming the option, if the file is declared as an output.
void add_own_file(const std::filesystem::path& file);

}  // namespace palpa
