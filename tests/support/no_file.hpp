// What a reader of files must refuse at once, without waiting for it or reading all of it.
#pragma once

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {

/// Checks the messages about an absent file, a folder, a device, a pipe, a link to itself and an empty file. `ending`
/// is that of the reader's files, such as ".ply".
inline void expect_refuses_what_is_no_file(const std::function<std::string(const std::filesystem::path&)>& fault_of,
                                           const std::string& ending) {
  const auto folder = scratch_folder("no-file");
  const auto name = [&](const char* stem) { return folder / (stem + ending); };
  ASSERT_EQ(::mkfifo(name("pipe").c_str(), 0600), 0);
  std::filesystem::create_symlink(name("loop"), name("loop"));
  write_text(name("empty"), "");
  const std::vector<std::pair<std::filesystem::path, std::string>> cases{
      {name("absent"), "no such file"},       {folder, "is a folder"},
      {"/dev/zero", "is not a regular file"}, {name("pipe"), "is not a regular file"},
      {name("loop"), "cannot be opened"},     {name("empty"), "is empty"},
  };
  for (const auto& [file, message] : cases)
    EXPECT_CONTAINS(fault_of(file), message) << file;
}

}  // namespace palpa::test
