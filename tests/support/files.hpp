// Small files, read and written whole.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

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

}  // namespace palpa::test
