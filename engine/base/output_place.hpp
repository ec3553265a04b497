// The place of an output: what a file name given for writing refers to, determined before anything is opened.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <tuple>

#include "base/error.hpp"

namespace palpa {

/// Identifies a file under all of its names, hard and symbolic links included.
struct FileIdentity {
  std::uint64_t device = 0, inode = 0;
  bool operator==(const FileIdentity&) const = default;
  bool operator<(const FileIdentity& other) const {
    return std::tie(device, inode) < std::tie(other.device, other.inode);
  }
};

struct OutputPlace {
  enum class Kind {
    absent,  ///< nothing is there yet
    file,    ///< a regular file
    folder,
    other,  ///< a device, a pipe, a terminal
  };

  std::string name;            ///< for messages: what the user wrote, "stdout" for "-"
  std::filesystem::path path;  ///< with symbolic links resolved, dangling ones included
  Kind kind = Kind::absent;
  /// It refers to a descriptor that is already open ("-", /dev/stdout, /proc/self/fd/3), so it is written in place.
  bool open_already = false;
  /// It is stdout: "-", or any name of the file or pipe that stdout is open on. If it were opened a second time, the
  /// two writers would overwrite each other's output.
  bool is_stdout = false;
  FileIdentity identity;  ///< of the existing file; if there is none, of the folder that it would be created in
  mode_t mode = 0;        ///< of the existing file, like the next three:
  uid_t owner = 0;
  gid_t group = 0;
  nlink_t links = 0;  ///< number of its names

  std::filesystem::path folder() const;
};

/// "-" is stdout. Never throws, whatever exists or does not exist there.
OutputPlace output_place(const std::filesystem::path& file);

/// Throws failure() if a file clearly cannot be created or replaced there: no such folder, a folder, no permission, a
/// read-only file system. Tries nothing. (A full disk only shows during writing.)
void refuse_unwritable(const OutputPlace& place);

/// failure(): `name: cannot be written:` and the meaning of the system's error code, such as a full disk.
Error write_failure(const std::string& name, int code);

}  // namespace palpa
