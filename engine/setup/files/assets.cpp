#include "setup/files/assets.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "base/error.hpp"

namespace palpa::setup {

namespace fs = std::filesystem;

namespace {

/// Set once, when a program starts.
std::string& asset_folder() {
  static std::string folder;
  return folder;
}

}  // namespace

void set_asset_folder(const std::string& folder) {
  asset_folder() = folder;
}

std::string find_asset(const std::string& name) {
  std::error_code ignored;
  if (name.empty()) throw bad_usage("the name of a file in palpa's assets folder is missing, such as cube.glb");
  const fs::path normal = fs::path(name).lexically_normal();
  if (normal.is_absolute() || normal.empty() || *normal.begin() == "..")
    throw bad_input(name, "leads out of palpa's assets folder");
  if (const char* folder = std::getenv("PALPA_ASSETS"); folder && *folder) {
    const fs::path file = fs::path(folder) / name;
    if (fs::exists(file, ignored)) return file.string();
    throw bad_input(file.string(), "not found; PALPA_ASSETS should name palpa's assets folder");
  }
  if (const fs::path own = fs::path(asset_folder()) / name; !asset_folder().empty() && fs::exists(own, ignored))
    return own.string();
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  const fs::path installed = program.parent_path().parent_path() / "share/palpa/assets" / name;
  if (fs::exists(installed, ignored)) return installed.string();
  for (fs::path folder = program.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    const fs::path file = folder / "assets" / name;
    if (fs::exists(file, ignored)) return file.string();
    if (fs::exists(folder / "assets/cube.glb", ignored))
      throw bad_input(name, fmt::format("is not in palpa's assets folder, {}", (folder / "assets").string()));
  }
  throw bad_input(name, "not found beside the program; set PALPA_ASSETS to palpa's assets folder");
}

}  // namespace palpa::setup
