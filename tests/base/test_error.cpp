#include <gtest/gtest.h>

#include <stdexcept>

#include "base/error.hpp"

namespace palpa {
namespace {

TEST(Error, BadInputNamesTheFileFirst) {
  const Error error = bad_input("cube.glb", "node 3 has a scale of zero");
  EXPECT_EQ(error.code(), Exit::bad_input);
  EXPECT_STREQ(error.what(), "cube.glb: node 3 has a scale of zero");
}

TEST(Error, UsageAndFailureKeepTheirLine) {
  EXPECT_EQ(bad_usage("no").code(), Exit::usage);
  EXPECT_STREQ(bad_usage("--stride 5 is not coprime to --foci 10").what(), "--stride 5 is not coprime to --foci 10");
  EXPECT_EQ(failure("no").code(), Exit::failed);
  EXPECT_STREQ(failure("disk full").what(), "disk full");
}

TEST(Error, IsCaughtAsAStandardException) {
  EXPECT_THROW(throw bad_input("a", "b"), std::runtime_error);
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
