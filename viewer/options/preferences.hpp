// What is remembered between runs: the user's preferences (layers, background, panels, fine pictures, what colours the
// finger, pace), where the window was, and which files were opened.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

/// Where a window is on the screen, in the system's own units.
struct WindowPlace {
  int x = 0, y = 0;
  std::uint32_t width = 0, height = 0;
  bool operator==(const WindowPlace&) const = default;
};

struct Preferences {
  Layers layers;
  bool dark = false;
  bool panels = true;
  FinePictures fine = FinePictures::automatic;
  SkinColour skin_colour = SkinColour::pressure;
  double slots_per_s = SlotTime{}.slots_per_s;
  std::map<std::string, bool> headings;  ///< of the panels, those that the user has folded (false) or unfolded
  std::optional<WindowPlace> window;
  std::vector<std::string> recent;  ///< files that were opened, the newest first
  bool operator==(const Preferences&) const = default;
};

/// $XDG_CONFIG_HOME/palpa/viewer.toml, else ~/.config/palpa/viewer.toml; nullopt if neither is known.
std::optional<std::filesystem::path> preferences_file();

/// The settings in the file, or the defaults if there is no file. Throws bad_input that names the file and the fault.
Preferences load_preferences(const std::filesystem::path& file);
/// Where the window was, if the file says so and is not broken.
std::optional<WindowPlace> remembered_window(const std::filesystem::path& file);
/// Warns once if load_preferences() would throw. For pictures without a window, which look the same for everybody.
void warn_of_preferences(const std::filesystem::path& file);
/// Replaces the file and makes its folders. Readers see either the old file or the new one. Throws failure().
void save_preferences(const std::filesystem::path& file, const Preferences& settings);

/// What to remember of `now`: settings that changed since the program `began`, and all others as remembered `before`.
/// Preferences from a command line therefore apply only to that run.
Preferences to_remember(const Preferences& before, const Preferences& began, const Preferences& now);

/// The settings of a program from its start to its end, kept in one file.
class PreferencesMemory {
 public:
  /// Empty: nothing is remembered.
  explicit PreferencesMemory(std::filesystem::path file) : file_(std::move(file)) {}
  bool remembers() const { return !file_.empty(); }
  /// Reads the file. Throws as load_preferences() does.
  void load() { recalled_ = load_preferences(file_); }
  /// As read by load() or written by remember(); the defaults before that.
  const Preferences& recalled() const { return recalled_; }
  /// The settings with which the program begins: the recalled ones, changed by the command line.
  void begin(const Preferences& settings) { began_ = settings; }
  /// Writes what has changed since begin(). If writing fails, warns once for the same settings.
  void remember(const Preferences& now);

 private:
  std::filesystem::path file_;
  Preferences recalled_, began_;
};

}  // namespace palpa::viewer
