// The files of a folder from which one is chosen, as plain values.
#pragma once

#include <string>
#include <vector>

namespace palpa::viewer {

/// In place of an option: the name under which moved solids are saved.
inline constexpr const char* save_as = "save as";

/// What is being chosen, and what it is for.
struct FilePicker {
  std::string title{};                 ///< "object"
  std::string option{};                ///< the option that gets the file; empty: it is opened
  std::string prefix{};                ///< before the file in the option's value: "recording:"
  std::vector<std::string> endings{};  ///< of the files that are listed: ".glb"; empty: all files
  bool folders = false;                ///< a folder is chosen
  bool is_new = false;                 ///< a name that need not exist yet is chosen
  std::string folder{};                ///< that is listed
  std::string name{};                  ///< as typed, or as clicked

  struct Entry {
    std::string name;
    bool folder = false;
    bool recording = false;  ///< a folder that is a recording: it is chosen, not entered
  };
  std::vector<Entry> entries{};
  std::string fault{};   ///< why the folder cannot be listed
  std::string listed{};  ///< the folder of `entries`
};

/// To open a model, a PLY or a recording. Begins beside the newest of the `recent` files.
FilePicker picker_to_open(const std::vector<std::string>& recent);
/// Fills `entries` if the folder has changed: folders first, by name, without hidden ones.
void list_files(FilePicker& picker);
/// Whether the folder has a recording.toml.
bool is_recording(const std::string& folder);
/// Folders where people look for files, with their names: the current one, the home folder, and palpa's own if it is
/// not empty. A folder has one name only.
struct NamedFolder {
  std::string name, folder;
};
std::vector<NamedFolder> starting_folders(const std::string& own);
/// The folder above.
std::string folder_above(const std::string& folder);
/// Whether the name is that of a folder, but a file is to be chosen.
bool is_folder_to_enter(const FilePicker& picker);
/// The chosen file, as short as possible: relative to the current folder if it is below that.
std::string chosen_file(const FilePicker& picker);

}  // namespace palpa::viewer
