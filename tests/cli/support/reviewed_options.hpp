// Each option of each command, and where it has an effect. Used by tests that no option is ignored silently.
#pragma once

#include <string>
#include <vector>

namespace palpa::test {

/// An option that has no effect on a line.
struct IdleOption {
  std::vector<std::string> given;  ///< the option first
  std::string told;                ///< a part of the refusal
};

/// An option that changes the results of a line.
struct EffectiveOption {
  std::vector<std::string> given;     ///< the option first
  std::vector<std::string> beside{};  ///< further words of the line, with and without it
};

struct ReviewedLine {
  std::vector<std::string> line;        ///< lacks nothing
  std::vector<IdleOption> idle{};       ///< refused beside that line
  std::string untried{};                ///< options that have an effect, but are costly to try, or need other inputs
  std::vector<std::string> tried_as{};  ///< the line on which the following are tried; empty: `line`
  std::vector<EffectiveOption> effective{};
};

/// At least one for each command. `scratch` is a folder for small inputs. In `tried_as` and in effective options, the
/// word OUT stands for an empty folder.
std::vector<ReviewedLine> reviewed_lines(const std::string& scratch);

/// Those of `palpa export --played`, of `palpa study`, and of `palpa emulate`.
std::vector<ReviewedLine> of_played(const std::string& scratch);
std::vector<ReviewedLine> of_studies();
std::vector<ReviewedLine> of_emulate();

/// The options of a GPU, which a command that uses none does not have.
std::vector<IdleOption> no_gpu_at_all();

/// The words of a text, between spaces.
std::vector<std::string> words_of(const std::string& text);

}  // namespace palpa::test
