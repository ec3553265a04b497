// The options of a live run while somebody changes them.
#pragma once

#include <optional>
#include <string>

#include "setup/live_run.hpp"
#include "setup/option_table.hpp"

namespace palpa::viewer {

/// The values, and beside them how a command line says them: that line has just what somebody has set. Whatever changes
/// one changes the other. Fields where text is typed go by an option's name; all else has a function of its own.
class LiveEdit {
 public:
  LiveEdit() = default;
  /// Of the viewer's line what `palpa run` has, too; see live_table(). The values need not go together: a single touch
  /// has a scene but no source. Throws bad_usage for a text that is no value of its option.
  explicit LiveEdit(const setup::Given& line);

  const setup::LiveOptions& options() const { return options_; }
  /// Throws bad_usage where they do not go together; warns of what is unusual.
  void check() const;

  /// The scene is in this file from now on. What was said of another file's contents alone is cleared.
  void open_scene(const std::string& file);
  /// The same where the file is a new one, whatever its name.
  void replace_scene(const std::string& file);
  /// Frames come from this recording from now on. What was said of frames that are made up is cleared.
  void play_recording(const std::string& folder);
  /// A single touch becomes a live run: what was said of its spectrum alone is cleared.
  void leave_touch();

  /// What a text field of that option shows: the first value; empty for a flag. Nothing where it is as usual.
  std::optional<std::string> text(const std::string& option) const;
  /// As such a field says; nothing: as usual again. The option is one of live_table() or copied_table(). Throws
  /// bad_usage for a text that is no value of it, and then changes nothing.
  void set(const std::string& option, const std::optional<std::string>& text);

  /// Whether a run with one is a run with the other.
  bool runs_as(const LiveEdit& other) const { return line_ == other.line_; }
  /// `palpa run` with the same options and those of copied_table().
  std::string command() const;

 private:
  setup::LiveOptions options_;
  setup::Given line_;         ///< options of live_table()
  setup::Given copied_only_;  ///< options of copied_table()
};

}  // namespace palpa::viewer
