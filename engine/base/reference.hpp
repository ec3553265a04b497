// Files that files name: the buffers of a model, the images of a recording. Whoever wrote the naming file chose these
// names, and whoever opens it may not know them, so they lead no further than the folder of the naming file.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace palpa {

/// Whether references may leave their folders, in the whole process; at first they may not. Files that a user names are
/// no references, and a rig's masks and layouts are not looked at by this: `calibrate --out` writes their full paths.
void allow_outside_references(bool allowed);

/// The folder that the references of one file start from.
class ReferenceFolder {
 public:
  /// `naming` is the file that holds the references, for messages; they are found from `folder`.
  ReferenceFolder(std::string naming, const std::filesystem::path& folder);

  /// The path of what `reference` names, to be opened as it is. Throws bad_input, naming the file and `what` names it
  /// ("buffer 0"), where that path, with its symbolic links and ".." resolved, is not in the folder or below it.
  /// Nothing is opened, and whether anything is there outside is not told.
  std::filesystem::path find(const std::string& reference, const std::string& what);

 private:
  bool holds(const std::filesystem::path& path);

  std::string naming_;
  std::filesystem::path folder_;
  std::filesystem::path root_;                   ///< the folder, resolved
  std::map<std::filesystem::path, bool> below_;  ///< folders of references, and whether they are in it
};

}  // namespace palpa
