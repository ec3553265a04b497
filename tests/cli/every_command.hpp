// All of palpa's commands and their options, as its own help lists them: what is tried with each forgets none.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace palpa::test {

/// In the order of palpa --help.
std::vector<std::string> every_command();

struct HelpedOption {
  std::string name;  ///< "--delta"
  std::string type;  ///< what stands for its value, "LENGTH"; empty for a flag
};
/// `help` is what a program's --help printed.
std::vector<HelpedOption> options_in(const std::string& help);

/// By command, a line that succeeds within a fraction of a second without a GPU, and what it reads; emulate's goes on
/// until a signal.
class QuickLines {
 public:
  QuickLines();
  /// Fails the test where a command has none.
  std::vector<std::string> of(const std::string& command) const;

 private:
  std::filesystem::path folder_;
  std::map<std::string, std::vector<std::string>> lines_;
};

/// Without an option and its values.
std::vector<std::string> without(std::vector<std::string> line, const std::string& option);

}  // namespace palpa::test
