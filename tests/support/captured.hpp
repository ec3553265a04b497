// The messages of code under test.
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace palpa::test {

/// Everything that is written to stderr while `action` runs.
template <typename Action>
std::string stderr_of(const Action& action) {
  ::testing::internal::CaptureStderr();
  try {
    action();
  } catch (...) {
    ::testing::internal::GetCapturedStderr();  // otherwise the next capture ends the program
    throw;
  }
  return ::testing::internal::GetCapturedStderr();
}

}  // namespace palpa::test
