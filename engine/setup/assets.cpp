#include "setup/assets.hpp"

#include <cstdlib>
#include <filesystem>

#include "base/error.hpp"

namespace palpa::setup {

namespace fs = std::filesystem;

std::string find_asset(const std::string& name) {
  std::error_code ignored;
  if (const char* folder = std::getenv("PALPA_ASSETS"); folder && *folder) {
    const fs::path file = fs::path(folder) / name;
    if (fs::exists(file, ignored)) return file.string();
    throw bad_input(file.string(), "not found; PALPA_ASSETS should name palpa's assets folder");
  }
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  const fs::path installed = program.parent_path().parent_path() / "share/palpa/assets" / name;
  if (fs::exists(installed, ignored)) return installed.string();
  for (fs::path folder = program.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    const fs::path file = folder / "assets" / name;
    if (fs::exists(file, ignored)) return file.string();
  }
  throw bad_input(name, "not found beside the program; set PALPA_ASSETS to palpa's assets folder");
}

}  // namespace palpa::setup
