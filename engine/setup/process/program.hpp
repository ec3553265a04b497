// The code that palpa's programs share: their start, and the conversion of any error to one line and an exit code.
#pragma once

#include <functional>

namespace palpa::setup {

/// Runs `body` and returns the process's exit code. If the shell left standard streams closed, files opened later do
/// not get their descriptors. A closed pipe or a file that may not grow is an error, not a signal. An Error is one line
/// on stderr. Held warnings are shown if `body` succeeded. Vulkan validation errors turn a success into a failure.
int run_program(const std::function<void()>& body);

}  // namespace palpa::setup
