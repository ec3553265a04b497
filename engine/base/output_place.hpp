// Where an output goes: what a file name given for writing stands for, before anything is opened.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <tuple>

#include "base/error.hpp"

namespace palpa {

/// What two names of one file have in common, hard and symbolic links included.
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

  std::string name;            ///< as messages tell it: what the user wrote, "stdout" for "-"
  std::filesystem::path path;  ///< where symbolic links lead, those that lead nowhere included
  Kind kind = Kind::absent;
  /// Behind a descriptor that is open already ("-", /dev/stdout, /proc/self/fd/3): it is written where it stands.
  bool open_already = false;
  /// It is stdout: "-", or any name of the file or pipe that stdout is open on. Opened anew, what is written by the one
  /// would take the place of what is written by the other.
  bool is_stdout = false;
  FileIdentity identity;  ///< of what is there; where nothing is, of the folder that it would come into
  mode_t mode = 0;        ///< of what is there; so are:
  uid_t owner = 0;
  gid_t group = 0;
  nlink_t links = 0;  ///< names that it has

  std::filesystem::path folder() const;
};

/// "-" is stdout. Never throws for what is or is not there.
OutputPlace output_place(const std::filesystem::path& file);

/// Throws failure() where a file cannot be created or replaced there, without trying: no such folder, a folder, no
/// permission, a file system that is read only. (A full disk shows only when it is written to.)
void refuse_unwritable(const OutputPlace& place);

/// failure(): `name: cannot be written:` and what the system's error code means, such as a full disk.
Error write_failure(const std::string& name, int code);

}  // namespace palpa
