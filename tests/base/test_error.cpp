#include <gtest/gtest.h>

#include <stdexcept>
#include <tuple>

#include "base/error.hpp"

namespace palpa {
namespace {

TEST(Error, KeepsItsCodeAndLine) {
  const std::tuple<Error, Exit, const char*> errors[]{
      {bad_input("cube.glb", "node 3 has a scale of zero"), Exit::bad_input, "cube.glb: node 3 has a scale of zero"},
      {bad_usage("--stride 5 is wrong"), Exit::usage, "--stride 5 is wrong"},
      {failure("disk full"), Exit::failed, "disk full"},
  };
  for (const auto& [error, code, line] : errors) {
    EXPECT_EQ(error.code(), code);
    EXPECT_STREQ(error.what(), line);
    EXPECT_THROW(throw error, std::runtime_error);
  }
}

// Other programs depend on these numbers.
TEST(Error, ExitCodesAreTheContract) {
  EXPECT_EQ(static_cast<int>(Exit::ok), 0);
  EXPECT_EQ(static_cast<int>(Exit::failed), 1);
  EXPECT_EQ(static_cast<int>(Exit::usage), 2);
  EXPECT_EQ(static_cast<int>(Exit::no_device), 3);
  EXPECT_EQ(static_cast<int>(Exit::bad_input), 4);
}

}  // namespace
}  // namespace palpa
