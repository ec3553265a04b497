// What code under test says.
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace palpa::test {

/// What is written to stderr while `action` runs.
template <typename Action>
std::string stderr_of(const Action& action) {
  ::testing::internal::CaptureStderr();
  try {
    action();
  } catch (...) {
    ::testing::internal::GetCapturedStderr();  // else the next capture ends the program
    throw;
  }
  return ::testing::internal::GetCapturedStderr();
}

}  // namespace palpa::test
