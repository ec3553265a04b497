// The `palpa` command in this process: for what it says of a line, where most of a program's time is its start.
#pragma once

#include <string>
#include <vector>

#include "process.hpp"

namespace palpa::test {

/// As palpa() (process.hpp), but no program is started: the command's own main runs here, with all that the program has
/// but what only `palpa bench` measures. What it prints is kept, or goes to `stdout_file`, e.g. /dev/full. The result
/// knows no signal and no processor time. For lines that end by themselves: after two minutes SIGALRM ends the test
/// program. test_cli_here.cpp shows that both say the same of a line.
Result palpa_here(const std::vector<std::string>& arguments, const std::string& stdout_file = {});

}  // namespace palpa::test
