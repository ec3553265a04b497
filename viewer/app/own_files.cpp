#include "viewer/app/own_files.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "setup/files/assets.hpp"

namespace palpa::viewer {
namespace {

namespace fs = std::filesystem;

/// The asset with that name, if it is installed.
void add(std::vector<NamedFile>& files, const std::string& name, const std::string& asset) {
  try {
    files.push_back({name, setup::find_asset(asset)});
  } catch (const Error&) {
  }
}

bool is_scene(const fs::path& file) {
  return file.extension() == ".glb" || file.extension() == ".gltf";
}

/// Whether it is what touches, and not what is touched.
bool is_hand(const std::string& name) {
  return name.starts_with("finger") || name.starts_with("hand");
}

}  // namespace

void list_own_files(PanelData& data) {
  for (const char* name : {"cube", "pyramid", "prism", "semi-sphere"})
    add(data.objects, name, std::string(name) + ".glb");
  add(data.rigs, "paper: three cameras, a tunnel of arrays, a screen", "rigs/paper.toml");
  data.layouts = array::layout_names();
}

std::vector<std::string> scenes_beside(const std::string& file) {
  const fs::path now(file), folder = now.has_parent_path() ? now.parent_path() : fs::path(".");
  const bool hands = is_hand(now.filename().string());
  std::vector<std::string> scenes;
  std::error_code fault;
  for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end; entry.increment(fault)) {
    const fs::path name = entry->path().filename();
    if (is_scene(name) && (hands || !is_hand(name.string())))
      scenes.push_back((now.has_parent_path() ? folder / name : name).string());
  }
  std::ranges::sort(scenes);
  return scenes;
}

}  // namespace palpa::viewer
