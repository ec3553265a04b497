// What palpa's programs have in common: how they begin, and how whatever goes wrong becomes one line and an exit code.
#pragma once

#include <functional>

namespace palpa::setup {

/// Runs `body` and returns the process's exit code. Standard streams that the shell left closed cannot be hit by files
/// opened later; a closed pipe or a file that may not grow is an error and no signal. An Error is one line on stderr;
/// held warnings are shown when `body` succeeded. Vulkan validation errors make a success a failure.
int run_program(const std::function<void()>& body);

}  // namespace palpa::setup
