// Tests that need a pseudo terminal are skipped on a machine that has none, such as a container without /dev/pts.
#pragma once

#include <gtest/gtest.h>
#include <pty.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

namespace palpa::test {

/// Why no pseudo terminal can be opened; "" if one can. Opens both of its ends, as the tests do.
inline std::string pseudo_terminal_fault() {
  int master = -1, slave = -1;
  if (::openpty(&master, &slave, nullptr, nullptr, nullptr) != 0) return std::strerror(errno);
  ::close(slave);
  ::close(master);
  return "";
}

}  // namespace palpa::test

/// The first line of every test that needs a pseudo terminal: skips the test if there is none.
#define PALPA_TERMINAL_OR_SKIP()                                                        \
  if (const std::string fault = ::palpa::test::pseudo_terminal_fault(); !fault.empty()) \
  GTEST_SKIP() << "skipped: no pseudo terminal: " << fault
