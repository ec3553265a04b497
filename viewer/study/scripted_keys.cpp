#include "viewer/study/scripted_keys.hpp"

#include <chrono>

namespace palpa::viewer {
namespace {

ScriptedPress press(Key key, bool experimenter) {
  ScriptedPress out{.experimenter = experimenter};
  out.event.kind = WindowEvent::Kind::key;
  out.event.key = key;
  out.event.at_ns =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
  return out;
}

}  // namespace

std::optional<ScriptedPress> ScriptedKeys::next(const study::StudyPlan& plan, Conductor& conductor) const {
  const study::Sitting& sitting = conductor.sitting();
  switch (sitting.screen()) {
    case study::Screen::setup:
      if (!conductor.presentation().fault().empty()) return press(key_of('q'), true);
      return conductor.presentation().ready() ? std::optional(press(Key::space, true)) : std::nullopt;
    case study::Screen::paused:
      return press(key_of('q'), true);
    case study::Screen::consent:
    case study::Screen::depth_consent:
      return press(key_of('1'), false);
    case study::Screen::ready:
      if (!conductor.presentation().ready() && sitting.block().kind != study::BlockKind::rest) return std::nullopt;
      return press(Key::space, false);
    case study::Screen::feedback:
      return press(Key::space, false);
    case study::Screen::question:
      return press(key_of(button_key(participant_.answer(plan, sitting)).front()), false);
    case study::Screen::touching:
    case study::Screen::rest:
    case study::Screen::end:
    case study::Screen::stopped:
      break;
  }
  return std::nullopt;
}

}  // namespace palpa::viewer
