// What a refusal must look like: one line, exit code 4, naming file and fault.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "base/error.hpp"

namespace palpa::test {

/// The message of the Error that `act` throws, after checking that it is one line with that exit code; "" if it throws
/// none.
template <typename Act>
std::string refusal(const Act& act, Exit code = Exit::bad_input) {
  try {
    act();
  } catch (const Error& error) {
    const std::string line = error.what();
    EXPECT_EQ(error.code(), code) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    EXPECT_LT(line.size(), 600u);
    return line;
  }
  return "";
}

inline void write_text(const std::string& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  ASSERT_TRUE(out.good()) << file;
}

inline std::string read_text(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace palpa::test

#define EXPECT_REFUSED(act, part)                                           \
  do {                                                                      \
    const std::string line_ = ::palpa::test::refusal([&] { (void)(act); }); \
    EXPECT_NE(line_.find(part), std::string::npos) << line_;                \
  } while (false)
