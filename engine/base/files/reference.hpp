// Files that are named in other files: the buffers of a model, the images of a recording. The author of the naming file
// chose these names, and the user who opens it may not know them. They may therefore only lead into the folder of the
// naming file.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>

namespace palpa {

/// Whether references may leave their folders, for the whole process; the default is no. Files that a user names are
/// not references, and a rig's masks and layouts are not checked here: `calibrate --out` writes their full paths.
void allow_outside_references(bool allowed);

/// The files in `folder` that a reference may mean: the one of exactly this name, which is meant if it exists, and the
/// one for which a backslash is a slash, as programs for Windows write it. Both are the same without a backslash.
std::array<std::filesystem::path, 2> readings_of(const std::string& reference, const std::filesystem::path& folder);

/// The folder that the references of one file start from.
class ReferenceFolder {
 public:
  /// `naming` is the file that holds the references, for messages. References are relative to `folder`.
  ReferenceFolder(std::string naming, const std::filesystem::path& folder);

  /// The path of the file that `reference` names, see readings_of(), to be opened unchanged. Throws bad_input if the
  /// path, with symbolic links and ".." resolved, is not in the folder or below it. The message names the file and
  /// `what` contains the reference ("buffer 0"). Nothing is opened, and the error does not reveal whether anything
  /// exists outside.
  std::filesystem::path find(const std::string& reference, const std::string& what);

 private:
  bool holds(const std::filesystem::path& path);

  std::string naming_;
  std::filesystem::path folder_;
  std::filesystem::path root_;                   ///< the folder, resolved
  std::map<std::filesystem::path, bool> below_;  ///< the folders of earlier references, and whether each is inside
};

}  // namespace palpa
