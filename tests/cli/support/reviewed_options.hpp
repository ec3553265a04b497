// Each option of each command, and where it has an effect. Used by tests that no option is ignored silently.
//
// Lines and options are texts of words. ROOT/ is the source tree, SCRATCH/ a folder of small inputs, OUT/ an empty
// folder.
#pragma once

#include <string>
#include <vector>

namespace palpa::test {

/// Options that have no effect on a line, each with its value.
struct IdleOptions {
  std::string told;  ///< a part of the refusal; OPTION is the option's name
  std::vector<std::string> given;
};

/// Options that change the results of a line, each with its value.
struct EffectiveOptions {
  std::string beside;  ///< further words of the line, with and without the option
  std::vector<std::string> given;
};

struct ReviewedLine {
  std::string line;                 ///< lacks nothing
  std::vector<IdleOptions> idle{};  ///< refused beside that line
  std::string untried{};            ///< options that have an effect, and are tried in Python or elsewhere
  std::string tried_as{};           ///< the line on which the following are tried; empty: `line`
  std::vector<EffectiveOptions> effective{};
};

/// At least one for each command. Writes small inputs to the folder `scratch`.
std::vector<ReviewedLine> reviewed_lines(const std::string& scratch);

}  // namespace palpa::test
