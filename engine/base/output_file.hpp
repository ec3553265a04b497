// The one way in which palpa writes whole files. What is read while it grows is base/stream_writer.hpp's.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/output_place.hpp"

namespace palpa {

/// A file that is there whole or not at all: written without a name and put into its place by finish(), so that whoever
/// looks finds the old one or the new one, also when two write the same. A program that is killed leaves nothing
/// behind, but on file systems without nameless files, where it leaves a `.palpa-...` beside the place. Symbolic links
/// are followed; a file that is replaced keeps its mode, owner and group, a new one has the umask's. Nothing is
/// synchronised: after a power failure, the file system decides.
///
/// A file with several names, and one that is a mount point, would lose them or cannot be replaced: finish() copies the
/// whole of what was written into it.
///
/// Written where they stand are devices, pipes and what is open already; a file of somebody else, or of a group that
/// the program is not in; and one in a folder that takes no new files.
class OutputFile {
 public:
  /// "-" is stdout. A FIFO's reader is waited for (base/open_output.hpp). Throws failure() naming the file, and what
  /// the register of files refuses.
  explicit OutputFile(const std::filesystem::path& file);
  /// Without finish(): a file that would have been replaced is as it was, a new one is not there.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Throws failure() naming the file: a full disk, a limit, a closed pipe.
  void write(std::string_view bytes);
  /// The file is in its place. Throws as write().
  void finish();

 private:
  bool open_beside();
  bool create_beside();
  void name_beside();
  void put_in_place();
  void copy_into_place();
  void flush();
  void put(std::string_view bytes) const { put(descriptor_, bytes); }
  void put(int descriptor, std::string_view bytes) const;

  OutputPlace place_;
  bool in_place_ = true;          ///< written where it stands
  std::filesystem::path beside_;  ///< the name that it has until it is finished; empty where it has none
  int descriptor_ = -1;
  std::string buffer_;
};

/// All of `bytes` as a file, see OutputFile.
void write_file(const std::filesystem::path& file, std::string_view bytes);

}  // namespace palpa
