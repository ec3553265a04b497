// The only way in which palpa writes whole files. Files that are read while they grow are written by
// base/stream_writer.hpp.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/output_place.hpp"

namespace palpa {

/// A file that is written completely or not at all. It is written without a name and put into its place by finish(), so
/// that a reader finds either the old or the new file, even if two processes write it. A killed program leaves nothing
/// behind, except on file systems without nameless files, where it leaves a `.palpa-...` beside the place. Symbolic
/// links are followed. A replaced file keeps its mode, owner and group; a new one has the umask's. Nothing is
/// synchronised: after a power failure, the file system decides.
///
/// A file with several names would lose them, and a mount point cannot be replaced. For these, finish() copies the
/// whole content into the existing file.
///
/// Written in place are devices, pipes and files that are already open; files that belong to somebody else, or to a
/// group that the program is not in; and files in a folder that takes no new files.
class OutputFile {
 public:
  /// "-" is stdout. For a FIFO, waits for its reader (base/open_output.hpp). Throws failure() naming the file, and the
  /// errors of the register of files.
  explicit OutputFile(const std::filesystem::path& file);
  /// Without finish(), an existing file is unchanged, and a new one does not exist.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Throws failure() naming the file, for example for a full disk, a limit or a closed pipe.
  void write(std::string_view bytes);
  /// Puts the file into its place. Throws as write().
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
  bool in_place_ = true;          ///< written directly to its place
  std::filesystem::path beside_;  ///< the temporary name until the file is finished; empty if it has none
  int descriptor_ = -1;
  std::string buffer_;
};

/// Writes all of `bytes` as a file, see OutputFile.
void write_file(const std::filesystem::path& file, std::string_view bytes);

}  // namespace palpa
