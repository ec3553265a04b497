// The `palpa` command within this process: for tests of its output, because starting a program takes most of its time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/support/process.hpp"

namespace palpa::cli {
struct Extensions;
}

namespace palpa::test {

/// Like palpa() (process.hpp), but starts no program: calls the command's main in this process, with everything that
/// the program has except the rows of `palpa bench`. Its output is kept; stdout goes to `stdout_file` instead if given,
/// e.g. /dev/full. `extend` changes what the rooms above the engine add to the command. The result has no signal and no
/// processor time. The line must end by itself: after two minutes, SIGALRM ends the test program. test_cli_usage.cpp
/// shows that the output is the same as the program's.
Result palpa_here(const std::vector<std::string>& arguments, const std::string& stdout_file = {},
                  const std::function<void(cli::Extensions&)>& extend = {});

}  // namespace palpa::test
