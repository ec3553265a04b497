#include "support/shared_data.hpp"

#include <unistd.h>

#include <cstdlib>
#include <mutex>
#include <vector>

namespace palpa::test {
namespace {

/// Removes the scratch folders when the process ends.
struct Scratch {
  std::mutex lock;
  std::vector<std::filesystem::path> folders;
  ~Scratch() {
    std::error_code ignored;
    for (const auto& folder : folders)
      std::filesystem::remove_all(folder, ignored);
  }
};

}  // namespace

std::filesystem::path source_file(const std::string& relative) {
  return std::filesystem::path(PALPA_SOURCE_DIR) / relative;
}

std::filesystem::path shared_data(const std::string& relative) {
  const char* root = std::getenv("PALPA_SHARED");
  const std::filesystem::path path =
      (root && *root ? std::filesystem::path(root) : source_file("../shared")) / "data" / relative;
  return std::filesystem::exists(path) ? path : std::filesystem::path();
}

std::filesystem::path scratch_folder(const std::string& name) {
  static Scratch scratch;
  auto folder = std::filesystem::temp_directory_path() / ("palpa-" + std::to_string(getpid()) + "-" + name);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const std::scoped_lock guard(scratch.lock);
  scratch.folders.push_back(folder);
  return folder;
}

}  // namespace palpa::test
