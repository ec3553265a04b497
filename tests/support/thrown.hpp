// The palpa::Error that a function throws, and the form that its line must have.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "base/error.hpp"

namespace palpa::test {

/// The Error that `work` throws; an Error with Exit::ok if it throws none.
template <typename Work>
Error thrown_by(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return error;
  }
  return Error(Exit::ok, "");
}

/// The line of the Error that `work` throws; checks that it is one line with that exit code. "" if it throws none.
template <typename Work>
std::string error_of(const Work& work, Exit code = Exit::bad_input) {
  const Error error = thrown_by(work);
  if (error.code() == Exit::ok) return "";
  const std::string line = error.what();
  EXPECT_EQ(error.code(), code) << line;
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  EXPECT_LT(line.size(), 600u) << line;
  return line;
}

}  // namespace palpa::test

#define EXPECT_CONTAINS(text, part) \
  EXPECT_NE(std::string(text).find(part), std::string::npos) << "\"" << (text) << "\" lacks \"" << (part) << "\""

#define EXPECT_ERROR(act, code, part) EXPECT_CONTAINS(::palpa::test::error_of([&] { (void)(act); }, code), part)

#define EXPECT_REFUSED(act, part) EXPECT_ERROR(act, ::palpa::Exit::bad_input, part)
