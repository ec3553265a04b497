// What palpa's programs have in common: how they begin, and how whatever goes wrong becomes one line and an exit code.
#pragma once

#include <functional>
#include <string>

namespace palpa::setup {

/// Runs `body` and returns the process's exit code. Standard streams that the shell left closed cannot be hit by files
/// opened later; a closed pipe or a file that may not grow is an error and no signal. An Error is one line on stderr;
/// held warnings are shown when `body` succeeded. Vulkan validation errors make a success a failure.
int run_program(const std::function<void()>& body);

/// The command line parser's own message as one of palpa's: "...; see palpa touch --help".
std::string usage_line(const std::string& parser_message, const std::string& command);

}  // namespace palpa::setup
