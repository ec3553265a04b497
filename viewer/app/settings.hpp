// How somebody likes to look at things, remembered from one day to the next: layers, background, panels, fine pictures,
// pace. Not what is looked at.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

struct Settings {
  Layers layers;
  bool dark = false;
  bool panels = true;
  FinePictures fine = FinePictures::automatic;
  double slots_per_s = SlotTime{}.slots_per_s;
  bool operator==(const Settings&) const = default;
};

/// $XDG_CONFIG_HOME/palpa/viewer.toml, else ~/.config/palpa/viewer.toml; nothing where neither is known.
std::optional<std::filesystem::path> settings_file();

/// What the file says; the usual where there is none. Throws bad_input naming file and fault.
Settings load_settings(const std::filesystem::path& file);
/// One warning where load_settings() would throw: for pictures without a window, which look the same for everybody.
void warn_of_settings(const std::filesystem::path& file);
/// Writes it anew, with the folders it lies in; readers see the old file or the new one. Throws failure().
void save_settings(const std::filesystem::path& file, const Settings& settings);

/// What to remember of `now`: what was changed since the program `began`, and of all else what was remembered `before`,
/// so that what a command line says is for its run alone.
Settings to_remember(const Settings& before, const Settings& began, const Settings& now);

/// The settings of a program from its beginning to its end, in one file.
class SettingsMemory {
 public:
  /// Empty: nothing is remembered.
  explicit SettingsMemory(std::filesystem::path file) : file_(std::move(file)) {}
  bool remembers() const { return !file_.empty(); }
  /// Reads the file. Throws as load_settings() does.
  void load() { recalled_ = load_settings(file_); }
  /// As load() has read them or remember() has written them, the usual before.
  const Settings& recalled() const { return recalled_; }
  /// The program begins with these: what is recalled, and what the command line says.
  void begin(const Settings& settings) { began_ = settings; }
  /// Writes what has been changed since. Warns where that cannot be done, once for the same settings.
  void remember(const Settings& now);

 private:
  std::filesystem::path file_;
  Settings recalled_, began_;
};

}  // namespace palpa::viewer
