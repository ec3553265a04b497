// palpa-viewer without a window, in this process: for what lines draw and what is refused of them, which takes a
// program no start of its own.
#pragma once

#include <string>
#include <vector>

#include "cli/process.hpp"

namespace palpa::test {

/// The exit code that the program would end with, and the line that it would say of a failure. What it prints goes
/// where this process prints, and warnings are lost.
Result viewer_here(const std::vector<std::string>& words);

}  // namespace palpa::test
