// A scripted participant and experimenter: the keys that they press, for a rehearsal with windows and array.
#pragma once

#include <cstdint>
#include <optional>

#include "study/plan/plan.hpp"
#include "study/sitting/rehearsal.hpp"
#include "viewer/hands/controls.hpp"
#include "viewer/study/conductor.hpp"

namespace palpa::viewer {

struct ScriptedPress {
  bool experimenter = false;  ///< in whose window
  WindowEvent event{};
};

class ScriptedKeys {
 public:
  ScriptedKeys(double accuracy, std::uint32_t number, std::uint64_t seed) : participant_(accuracy, number, seed) {}

  /// What is pressed now, if anything is: the key that the screen asks for, once it can have an effect. A pause was
  /// asked for by somebody, or something has failed: the experimenter stops.
  std::optional<ScriptedPress> next(const study::StudyPlan& plan, Conductor& conductor) const;

 private:
  study::ScriptedParticipant participant_;
};

}  // namespace palpa::viewer
