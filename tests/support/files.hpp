// Small files, read and written whole.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace palpa::test {

inline void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.flush();
  EXPECT_TRUE(out.good()) << file;
}

/// All bytes of a file; empty if the file does not exist.
inline std::string read_text(const std::filesystem::path& file) {
  const std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();  // this loop is in the standard library, which is optimised in every build
  return text.str();
}

/// The files and folders in a folder, and itself, that others than their owner may read: files have 0600, folders 0700.
inline std::vector<std::filesystem::path> open_to_others(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::vector<fs::path> open;
  const auto look = [&](const fs::path& path) {
    const fs::file_status status = fs::symlink_status(path);
    const fs::perms wanted = fs::is_directory(status) ? fs::perms(0700) : fs::perms(0600);
    if (!fs::is_symlink(status) && status.permissions() != wanted) open.push_back(path);
  };
  look(folder);
  for (const fs::path& path : fs::recursive_directory_iterator(folder))
    look(path);
  return open;
}

}  // namespace palpa::test
