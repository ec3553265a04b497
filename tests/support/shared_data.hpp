// Recorded data that is not part of the repository: `../shared/data` beside the checkout, or $PALPA_SHARED/data.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace palpa::test {

/// The path if it exists, else an empty path.
std::filesystem::path shared_data(const std::string& relative);

/// A file of the source tree, e.g. source_file("assets/cube.glb").
std::filesystem::path source_file(const std::string& relative);

/// A fresh empty folder among the temporary files of the system, removed at exit. No other process has the same folder,
/// so other users and other copies of the project can run the same tests at the same time.
std::filesystem::path scratch_folder(const std::string& name);

}  // namespace palpa::test

/// Declares `variable`, or ends the test as skipped if the data does not exist.
#define PALPA_SHARED_OR_SKIP(variable, relative)                               \
  const std::filesystem::path variable = ::palpa::test::shared_data(relative); \
  if (variable.empty()) GTEST_SKIP() << "skipped: no ../shared/data/" << relative
