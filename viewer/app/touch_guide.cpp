#include "viewer/app/touch_guide.hpp"

#include <fmt/core.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "setup/process/interrupt.hpp"
#include "setup/tasks/register_tracker.hpp"

namespace palpa::viewer {
namespace {

/// Keys that leave the person where they are: views, and the silence.
bool is_of_view(Key key) {
  const char character = character_of(key);
  return character == 'o' || character == '1' || character == '3' || character == '5' || character == '7' ||
         character == '9';
}

std::optional<setup::NudgeKey> nudge_key(Key key) {
  switch (character_of(key)) {
    case character_of(Key::left):
      return setup::NudgeKey::left;
    case character_of(Key::right):
      return setup::NudgeKey::right;
    case character_of(Key::up):
      return setup::NudgeKey::up;
    case character_of(Key::down):
      return setup::NudgeKey::down;
    case character_of(Key::page_up):
      return setup::NudgeKey::away;
    case character_of(Key::page_down):
      return setup::NudgeKey::nearer;
    case character_of(Key::enter):
      return setup::NudgeKey::save;
    case character_of(Key::escape):
    case 'q':
      return setup::NudgeKey::leave;
    case 'f':
      return setup::NudgeKey::finer;
    case '0':
      return setup::NudgeKey::back;
    default:
      return std::nullopt;
  }
}

bool moves(setup::NudgeKey key) {
  return key != setup::NudgeKey::save && key != setup::NudgeKey::leave && key != setup::NudgeKey::finer;
}

/// ImGui breaks lines also within numbers, after the point.
std::string in_short_lines(std::string text) {
  for (std::size_t at = text.find("; "); at != std::string::npos; at = text.find("; ", at))
    text.replace(at, 2, "\n");
  return text;
}

/// The place before the focus on the faces of the array's transducers; the focus itself if they are all around.
Vec3 foot_of(const array::Layout& layout, const Vec3& focus) {
  const Vec3 way = setup::towards_array(layout, focus);
  double far_m = 0;
  for (const array::Transducer& transducer : layout.transducers)
    far_m += glm::dot(transducer.position - focus, way) / static_cast<double>(layout.transducers.size());
  return focus + far_m * way;
}

const drawing::Colour loud = drawing::rgb(0xd55e00), done = drawing::rgb(0x009e73);

/// Filled inside, if it has no width.
void add_ring(std::vector<FlatMark>& marks, const Vec2& centre, double radius, double width,
              const drawing::Colour& colour, const std::string& label) {
  constexpr int corners = 48;
  FlatMark ring{.colour = colour, .width = width, .filled = width == 0};
  for (int i = 0; i <= corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    ring.points.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  marks.push_back(std::move(ring));
  if (!label.empty()) marks.push_back({.points = {centre + Vec2(1.8 * radius, -radius)}, .label = label});
}

}  // namespace

TouchGuide::TouchGuide(setup::ByTouch& task, std::string json)
    : task_(&task), json_(std::move(json)), nudge_(&task.touches()) {}

bool TouchGuide::takes(const WindowEvent& event, const ShownRun& run) {
  if (event.kind == WindowEvent::Kind::drop || event.kind == WindowEvent::Kind::text) return true;
  if (event.kind != WindowEvent::Kind::key || is_of_view(event.key)) return false;
  const std::optional<setup::NudgeKey> key = nudge_key(event.key);
  if (!key || !event.down || (event.repeat && !moves(*key))) return true;
  const bool leaves = *key == setup::NudgeKey::leave;
  if (step_ != Step::touches) {
    closes_ = closes_ || leaves || *key == setup::NudgeKey::save;
  } else if (leaves || (run.shows_frame() && run.control().state() == RunState::running)) {
    // Whatever the picture shows, Enter takes what the cameras see.
    nudge_.press({*key, event.shift}, std::numeric_limits<double>::infinity());
  }
  return true;
}

bool TouchGuide::advance(ShownRun& run, PanelData& data) {
  if (step_ == Step::touches && nudge_.end() != setup::Nudge::End::none) {
    run.control().switch_off();
    finish();
  }
  data.guidance = guidance(run, data);
  return closes_;
}

void TouchGuide::finish() {
  const bool saves = nudge_.end() == setup::Nudge::End::save;
  step_ = saves ? Step::found : Step::left;
  closes_ = !saves;
  try {
    summary_ = task_->finish(saves, json_);
  } catch (const Error& error) {
    step_ = Step::failed;
    fault_ = std::current_exception();
    fault_line_ = error.what();
  }
}

Guidance TouchGuide::guidance(const ShownRun& run, const PanelData& data) const {
  constexpr const char* closing = "Enter or Escape closes the window";
  constexpr const char* leaving = "Escape: ends, and nothing is saved";
  if (step_ == Step::found) return {"The cameras are found", in_short_lines(summary_), "", closing};
  if (step_ == Step::failed) return {"Nothing is saved", fault_line_, "", closing};
  if (step_ == Step::left) return {"Nothing is saved", "", "", ""};
  const RunState state = run.control().state();
  if (state == RunState::failed) return {"The run failed", data.content.run.fault, "", leaving};
  if (state == RunState::loading || !run.shows_frame()) return {"The run begins", "Keep your hands away.", "", leaving};
  if (state != RunState::running) {
    return {"The array is off", "Take your hands away, and press Start at the top: the same focus follows.", "",
            leaving};
  }
  if (!task_->touches().focus())
    return {"Keep your hands away", "palpa looks at the empty place, half a second.", nudge_.hint(), leaving};
  return {
      task_->touches().line(),
      "Point with one finger to the array, and find the focus with its tip, where you feel it best. Hold still, and "
      "press Enter with the other hand.",
      nudge_.hint(),
      fmt::format("Arrows, Page up and down move the focus, f: finely, 0: back.  {}\nO: all off.  {}", nudge_.place(),
                  leaving)};
}

void TouchGuide::mark(const Sight& sight, std::vector<FlatMark>& marks) const {
  const shader::ViewPush push = projection(sight.viewpoint, sight.width, sight.height);
  const std::size_t touched = task_->touches().touched();
  for (std::size_t i = 0; i < touched; ++i) {
    const Projected at = project(push, setup::camera_foci[i]);
    if (at.visible) add_ring(marks, Vec2(at.x, at.y), 6 * sight.ratio, 2, done, fmt::format("{}", i + 1));
  }
  const std::optional<Vec3> focus = task_->touches().focus();
  if (!focus || step_ != Step::touches) return;
  const Projected at = project(push, *focus), foot = project(push, foot_of(task_->layout(), *focus));
  if (!at.visible) return;
  if (foot.visible) marks.push_back({.points = {Vec2(at.x, at.y), Vec2(foot.x, foot.y)}, .colour = loud, .width = 1.5});
  add_ring(marks, Vec2(at.x, at.y), 9 * sight.ratio, 0, loud, "");
  add_ring(marks, Vec2(at.x, at.y), 18 * sight.ratio, 5, loud, fmt::format("{}", touched + 1));
}

std::string TouchGuide::end(bool scripted) {
  if (fault_) std::rethrow_exception(fault_);
  if (step_ != Step::touches) return summary_;
  if (scripted && !setup::Interrupt::signalled()) {
    throw failure("--by-touch: nothing is saved, because " + nudge_.why_unsaved());
  }
  return task_->finish(false, json_);
}

}  // namespace palpa::viewer
