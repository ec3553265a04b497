// palpa-viewer without a window, as a program and within this process. The latter is for tests of pictures and refused
// lines that need not start a program.
#pragma once

#include <string>
#include <vector>

#include "cli/support/process.hpp"

namespace palpa::test {

/// The program's exit code, and the line that it would print on failure. Other output goes to this process's stdout and
/// stderr, and warnings are lost.
Result viewer_here(const std::vector<std::string>& words);

/// The program itself, without a display of any kind: headless runs must not need one.
Result viewer(const std::vector<std::string>& words);

/// A line that shows the fingertip pressed 3 mm into the cube, with further words.
std::vector<std::string> cube_touch(const std::vector<std::string>& more, const std::string& size = "320x200");
/// The same without a window, with the touch computed on the processor: its results are the same as the device's.
std::vector<std::string> host_touch(const std::vector<std::string>& more, const std::string& size = "320x200");

}  // namespace palpa::test
