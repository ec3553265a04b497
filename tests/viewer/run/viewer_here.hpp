// palpa-viewer without a window, within this process: for tests of pictures and refused lines that need not start a
// program.
#pragma once

#include <string>
#include <vector>

#include "cli/process.hpp"

namespace palpa::test {

/// The program's exit code, and the line that it would print on failure. Other output goes to this process's stdout and
/// stderr, and warnings are lost.
Result viewer_here(const std::vector<std::string>& words);

}  // namespace palpa::test
