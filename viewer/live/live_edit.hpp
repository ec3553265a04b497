// The options of a live run while the user changes them.
#pragma once

#include <optional>
#include <string>

#include "line/option_table.hpp"
#include "setup/sessions/live_run.hpp"

namespace palpa::viewer {

/// The text in an option's field.
struct OptionText {
  std::string option;
  std::optional<std::string> text;  ///< nullopt: the default
};

/// Holds the values and also the command line that gives them. The line has only the options that were set. Both always
/// change together. Text fields are set by the option's name; everything else has its own function.
class LiveEdit {
 public:
  LiveEdit() = default;
  /// Takes those options of the viewer's command line that `palpa run` also has, see live_table(). The values need not
  /// go together: a single touch has a scene but no source. Throws bad_usage for a text that is not a value of its
  /// option.
  explicit LiveEdit(const line::Given& line);

  const setup::LiveOptions& options() const { return options_; }
  /// Throws bad_usage if the options do not go together. Warns about unusual ones.
  void check() const;

  /// The scene is in this file from now on. Clears options that only concern the contents of another file.
  void open_scene(const std::string& file);
  /// The same for a new file, whatever its name.
  void replace_scene(const std::string& file);
  /// Frames come from this recording from now on. Clears options that concern made-up frames.
  void play_recording(const std::string& folder);
  bool plays_recording() const { return options_.source.starts_with("recording:"); }
  /// A single touch becomes a live run. Clears options that only concern its spectrum.
  void leave_touch();

  /// What a text field of that option shows: the first value; empty for a flag. nullopt if the option has its default.
  std::optional<std::string> text(const std::string& option) const;
  /// Sets the option to the text of such a field; nullopt restores the default. The option is one of live_table() or
  /// copied_table(). Throws bad_usage for a text that is not a value of the option, and then changes nothing.
  void set(const std::string& option, const std::optional<std::string>& text);

  /// The options of the run as on a command line.
  const line::Given& line() const { return line_; }
  /// Whether a run with either is the same run. The ceiling may differ, because it changes while a run continues.
  bool runs_as(const LiveEdit& other) const;
  /// The command `palpa run` with the same options and those of copied_table().
  std::string command() const;

 private:
  setup::LiveOptions options_;
  line::Given line_;         ///< options of live_table()
  line::Given copied_only_;  ///< options of copied_table()
};

}  // namespace palpa::viewer
