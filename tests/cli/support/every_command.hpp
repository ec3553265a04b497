// All of palpa's commands and their options, as its own help lists them, so that a test of all of them leaves none out.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "support/own_cache.hpp"

namespace palpa::test {

/// In the order of palpa --help. A subcommand of a group has two words, "study analyse".
std::vector<std::string> every_command();
/// Whether the line is one of that command.
bool is_of(const std::vector<std::string>& line, const std::string& command);

struct HelpedOption {
  std::string name;  ///< "--delta"
  std::string type;  ///< the placeholder of its value, "LENGTH"; empty for a flag
};
/// `help` is a page of a program's help.
std::vector<HelpedOption> options_in(const std::string& help);
/// Every option of a command of palpa, also those that all commands have.
std::vector<HelpedOption> options_of(const std::string& command);

/// Values of an option that takes numbers, as its type says: in each, another of its numbers is `odd`. Empty for other
/// types.
std::vector<std::string> odd_values(const std::string& type, const std::string& odd);

/// For each command, a command line that succeeds within a fraction of a second without a GPU, and its input files.
/// `emulate` runs until a signal comes.
class QuickLines {
 public:
  QuickLines();
  /// Fails the test if a command has none.
  std::vector<std::string> of(const std::string& command) const;
  /// Where the input files are, and the files that the lines write. What palpa keeps is in its folder "cache".
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  OwnCache cache_;
  Names names_;
};

/// The command line without an option and its values.
std::vector<std::string> without(std::vector<std::string> line, const std::string& option);

}  // namespace palpa::test
