#include "viewer/panel_data/file_list.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <tuple>

namespace palpa::viewer {
namespace {

namespace fs = std::filesystem;

fs::path absolute_folder(const std::string& folder) {
  std::error_code ignored;
  const fs::path whole = fs::absolute(folder.empty() ? "." : folder, ignored).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

}  // namespace

FilePicker picker_to_open(const std::vector<std::string>& recent) {
  return {.title = "a glTF model, a PLY or a recording",
          .endings = {".glb", ".gltf", ".ply", ".toml"},
          .folder = recent.empty() ? std::string(".") : folder_above(recent.front())};
}

void list_files(FilePicker& picker) {
  if (!picker.listed.empty() && picker.listed == picker.folder) return;
  picker.folder = absolute_folder(picker.folder).string();
  picker.listed = picker.folder;
  picker.entries.clear();
  picker.fault.clear();
  std::error_code fault;
  for (fs::directory_iterator entry(picker.folder, fault), end; !fault && entry != end; entry.increment(fault)) {
    const std::string name = entry->path().filename().string();
    std::error_code ignored;
    const bool folder = entry->is_directory(ignored);
    const bool wanted = picker.endings.empty() ||
                        std::ranges::find(picker.endings, entry->path().extension().string()) != picker.endings.end();
    if (name.starts_with('.') || (!folder && (picker.folders || !wanted))) continue;
    picker.entries.push_back({name, folder, folder && is_recording(entry->path().string())});
  }
  if (fault) picker.fault = fault.message();
  std::ranges::sort(picker.entries, [](const FilePicker::Entry& a, const FilePicker::Entry& b) {
    return std::tuple(!a.folder, a.name) < std::tuple(!b.folder, b.name);
  });
}

bool is_recording(const std::string& folder) {
  std::error_code ignored;
  return fs::is_regular_file(fs::path(folder) / "recording.toml", ignored);
}

std::vector<NamedFolder> starting_folders(const std::string& own) {
  const char* const home = std::getenv("HOME");
  std::vector<NamedFolder> folders;
  for (const NamedFolder& entry :
       {NamedFolder{"current folder", "."}, {"home", home != nullptr ? home : ""}, {"palpa's objects", own}}) {
    std::error_code ignored;
    if (entry.folder.empty() || !fs::is_directory(entry.folder, ignored)) continue;
    const std::string whole = absolute_folder(entry.folder).string();
    if (std::ranges::find(folders, whole, &NamedFolder::folder) == folders.end())
      folders.push_back({entry.name, whole});
  }
  return folders;
}

std::string folder_above(const std::string& folder) {
  return absolute_folder(folder).parent_path().string();
}

bool is_folder_to_enter(const FilePicker& picker) {
  std::error_code ignored;
  const fs::path whole = fs::path(picker.folder) / picker.name;
  if (picker.folders || picker.name.empty() || !fs::is_directory(whole, ignored)) return false;
  return picker.is_new || !is_recording(whole.string());
}

std::string chosen_file(const FilePicker& picker) {
  const fs::path whole = picker.name.empty() ? fs::path(picker.folder) : fs::path(picker.folder) / picker.name;
  std::error_code fault;
  const fs::path here = fs::current_path(fault);
  const fs::path near = fault ? fs::path() : whole.lexically_relative(here);
  if (near.empty() || *near.begin() == "..") return whole.string();
  return near.string();
}

}  // namespace palpa::viewer
