// How somebody likes to look at things, remembered from one day to the next: layers, background, panels, fine pictures,
// pace. Not what is looked at.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

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

}  // namespace palpa::viewer
