// The one exception type that leaves palpa's public functions, and the exit codes of its programs.
#pragma once

#include <stdexcept>
#include <string>

namespace palpa {

/// What a program returns to the shell.
enum class Exit : int {
  ok = 0,
  failed = 1,     ///< a run-time failure: lost device, full disk, closed pipe
  usage = 2,      ///< unusable arguments
  no_device = 3,  ///< no usable Vulkan device or display
  bad_input = 4,  ///< a missing, broken or implausible file
};

/// `what()` is one line that says what is wrong, where, and what would be right. It ends without a full stop or
/// newline.
class Error : public std::runtime_error {
 public:
  Error(Exit code, const std::string& line) : std::runtime_error(line), code_(code) {}
  Exit code() const { return code_; }

 private:
  Exit code_;
};

/// `file: fault`, exit code 4. For every fault that a file's author can cause.
Error bad_input(const std::string& file, const std::string& fault);
/// Exit code 2.
Error bad_usage(const std::string& line);
/// Exit code 1.
Error failure(const std::string& line);

}  // namespace palpa
