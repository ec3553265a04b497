// What the two windows of a study show, as values. Conductor makes them, screens.hpp draws them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "study/sitting/sitting.hpp"

namespace palpa::viewer {

struct ParticipantView {
  study::Screen screen = study::Screen::setup;
  std::string text{};                  ///< instruction or question
  std::string hint{};                  ///< below it, smaller
  std::vector<std::string> buttons{};  ///< the answers, in their order; the keys are button_key()
  std::size_t shape = 0;               ///< of the plan
  bool object = false;                 ///< the shape is seen
  bool marker = false;                 ///< the tile on top of it is seen
  bool operator==(const ParticipantView&) const = default;
};

/// One line of the experimenter's window.
struct StateLine {
  std::string name, value;
  bool warns = false;
  bool operator==(const StateLine&) const = default;
};

/// What the experimenter can do. The order is that of the buttons.
enum class Command { go_on, pause, stop };

struct ExperimenterView {
  std::string title{}, state{};
  bool may_sound = false;  ///< it is not known whether the array is silent
  bool sounds = false;     ///< unless that
  std::vector<StateLine> lines{};
  struct Button {
    Command command = Command::go_on;
    std::string label{}, key{};
    bool operator==(const Button&) const = default;
  };
  std::vector<Button> buttons{};  ///< those that have an effect now
  bool operator==(const ExperimenterView&) const = default;
};

/// The key of a button: 1 to 9, then a, b, c; and the button of a key, nullopt for a key of none.
inline std::string button_key(std::size_t button) {
  return std::string(1, static_cast<char>(button < 9 ? '1' + button : 'a' + (button - 9)));
}
inline std::optional<std::size_t> button_of_key(char key) {
  if (key >= '1' && key <= '9') return static_cast<std::size_t>(key - '1');
  if (key >= 'a' && key <= 'z') return static_cast<std::size_t>(key - 'a') + 9;
  return std::nullopt;
}

}  // namespace palpa::viewer
