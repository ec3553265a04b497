// How much of this process's memory is locked.
#pragma once

#include <fstream>
#include <string>

namespace palpa::test {

/// Kilobytes.
inline long locked_kib() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word && word != "VmLck:") {
  }
  long kib = -1;
  status >> kib;
  return kib;
}

}  // namespace palpa::test
