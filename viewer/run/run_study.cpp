#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "setup/process/ending.hpp"
#include "setup/process/interrupt.hpp"
#include "setup/sessions/load.hpp"
#include "setup/sessions/study_plan.hpp"
#include "viewer/options/monitors.hpp"
#include "viewer/run/drawing_threads.hpp"
#include "viewer/run/run.hpp"
#include "viewer/run/stopper.hpp"
#include "viewer/study/conductor.hpp"
#include "viewer/study/participant_scene.hpp"
#include "viewer/study/screens.hpp"
#include "viewer/study/scripted_keys.hpp"
#include "viewer/window/swapchain.hpp"
#include "viewer/window/window.hpp"
#include "viewer/window/window_surface.hpp"

namespace palpa::viewer {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

/// The plan, if a sitting can be run with it.
study::StudyPlan plan_to_run(const setup::StudyRunOptions& options, const LiveSession::Kinds& kinds) {
  study::StudyPlan plan = setup::load_plan(options.plan);
  take_layouts(plan, options, kinds);
  check_study_links(plan, options, kinds);
  constexpr double longest_touch_s = 1800;
  for (const study::PlanBlock& block : plan.blocks) {
    if (block.kind == study::BlockKind::rest || block.touch_s <= longest_touch_s) continue;
    throw bad_usage(
        fmt::format("{}: a touch of {:g} min is longer than a sitting can keep, 30 min: give touch_s at most "
                    "1800",
                    options.plan, block.touch_s / 60));
  }
  return plan;
}

study::EarLevel level_of(study::StudyPlan plan, const StudyShapes& shapes, const setup::StudyRunOptions& options) {
  const std::vector<Box> objects = take_shapes(plan, shapes);
  std::optional<array::Layout> placed;
  if (!options.rig.empty() && sensing::load_rig(options.rig).array)
    placed = setup::load_posed_rig({.rig = options.rig, .layout = ""}).layout;
  study::refuse_silent(plan, placed ? &*placed : nullptr);
  study::EarLevel level = study::predict_ear_level(plan, objects, placed ? &*placed : nullptr);
  study::check_signature(plan, level, options.override_by);
  study::refuse_loud(plan, level, options.override_by);
  return level;
}

/// A window that shows pictures that were made for it.
class Shown {
 public:
  Shown(const gpu::Device& device, Window& window)
      : window_(&window), surface_(device, window), presenter_(device, surface_.get()) {}

  /// Takes the window's events. If it was damaged, it is drawn again.
  std::vector<WindowEvent> take() {
    std::vector<WindowEvent> events = std::exchange(waited_, {});
    window_->take(events);
    const auto damages = [](const WindowEvent& event) { return event.kind == WindowEvent::Kind::damage; };
    damaged_ = damaged_ || std::ranges::any_of(events, damages);
    return events;
  }
  void wait(double timeout_s) { window_->wait(timeout_s, waited_); }
  bool closing() const { return window_->closing(); }
  VkExtent2D size() const { return window_->size(); }
  bool damaged() const {
    const VkExtent2D now = window_->size();
    return damaged_ || now.width != size_.width || now.height != size_.height;
  }
  bool visible() const { return window_->size().width > 1 && window_->size().height > 1; }
  void show(const drawing::Pixels& pixels) {
    if (!presenter_.draw(pixels)) return;
    size_ = {pixels.width, pixels.height};
    damaged_ = false;
  }

 private:
  Window* window_;
  WindowSurface surface_;
  Presenter presenter_;
  std::vector<WindowEvent> waited_;
  VkExtent2D size_{};
  bool damaged_ = true;
};

/// Shows a view whenever it has changed, but not more often than `apart`.
template <typename View, typename Draw>
void show_changed(Shown& window, const View& view, std::optional<View>& shown, Clock::time_point& last,
                  Clock::duration apart, Draw draw) {
  if (!window.visible() || (shown == view && !window.damaged())) return;
  const Clock::time_point now = Clock::now();
  if (now - last < apart) return;
  last = now;
  window.show(draw(window.size()));
  if (!window.damaged()) shown = view;
}

/// A warning if the window has another shape than the rig's screen; else empty.
std::string stretched_line(const ParticipantScene& scene, const VkExtent2D& size) {
  if (size.width < 2 || size.height < 2) return {};
  return stretched(scene.setting().screen, size.width, size.height);
}

/// The two windows of a sitting.
class SittingWindows {
 public:
  SittingWindows(const gpu::Device& device, Window& panel, Window& window, const ParticipantScene& scene)
      : device_(&device), scene_(&scene), experimenter_(device, panel), participant_(device, window) {}

  void wait(double timeout_s) { experimenter_.wait(timeout_s); }
  bool closing() const { return experimenter_.closing() || participant_.closing(); }

  /// Returns whether the experimenter leaves, which is possible at the end.
  bool take_experimenters(Conductor& conductor) {
    bool leaves = false;
    for (const WindowEvent& event : experimenter_.take()) {
      const VkExtent2D size = experimenter_.size();
      const auto places = button_places(conductor.experimenter_view(), size.width, size.height);
      const bool leaving_key =
          event.kind == WindowEvent::Kind::key && event.down && (event.key == key_of('q') || event.key == Key::escape);
      leaves = leaves || (conductor.over() && leaving_key);
      conductor.experimenter(event, button_at(places, event.x, event.y));
    }
    return leaves;
  }

  void take_participants(Conductor& conductor) {
    for (const WindowEvent& event : participant_.take()) {
      const VkExtent2D size = participant_.size();
      conductor.participant(event,
                            scene_->button_at(conductor.participant_view(), size.width, size.height, event.x, event.y));
    }
  }

  void show(const Conductor& conductor) {
    const ParticipantView view = conductor.participant_view();
    show_changed(participant_, view, shown_participant_, participant_at_, 0ms,
                 [&](const VkExtent2D& size) { return scene_->draw(*device_, eye_, view, size.width, size.height); });
    ExperimenterView state = conductor.experimenter_view();
    if (const std::string line = stretched_line(*scene_, participant_.size()); !line.empty()) {
      state.lines.insert(state.lines.begin(), {"picture", line, true});
      if (std::exchange(told_stretched_, line) != line) log::warning(line);
    }
    const bool at_once = !shown_experimenter_ || shown_experimenter_->state != state.state ||
                         shown_experimenter_->sounds != state.sounds;
    show_changed(experimenter_, state, shown_experimenter_, experimenter_at_, at_once ? 0ms : 250ms,
                 [&](const VkExtent2D& size) { return draw(state, size.width, size.height); });
  }

 private:
  const gpu::Device* device_;
  const ParticipantScene* scene_;
  std::optional<Offscreen> eye_;
  Shown experimenter_, participant_;
  std::optional<ParticipantView> shown_participant_;
  std::optional<ExperimenterView> shown_experimenter_;
  Clock::time_point participant_at_{}, experimenter_at_{};
  std::string told_stretched_;  ///< the warning about the participant's window that was given
};

/// As high as usual, with the shape of the screen, so that objects appear where they are felt.
setup::WindowSize default_size(const sensing::Screen& screen) {
  constexpr double height = 720, most_width = 1600;
  const double width = std::min(height * screen.width_m / screen.height_m, most_width);
  return {static_cast<std::uint32_t>(std::lround(width)),
          static_cast<std::uint32_t>(std::lround(width * screen.height_m / screen.width_m))};
}

/// On a single monitor without a window manager, both windows would lie on each other.
void place_beside(Window& panel, Window& window, bool sized) {
  const std::optional<WindowPlace> one = panel.place(), other = window.place(), area = panel.work_area();
  if (!one || !other || !area) return;
  if (const std::optional<TwoPlaces> places = side_by_side(*area, *one, *other, sized)) {
    panel.move(places->left);
    window.move(places->right);
  }
}

/// The participant's window: of the size that was asked for, on the monitor that was asked for, or on the last of
/// several. On a single monitor, the experimenter must see their window, too.
Window participant_window(const setup::StudyRunOptions& options, const sensing::Screen& screen) {
  constexpr const char* title = "palpa participant";
  const std::vector<std::string> monitors = Window::monitors();
  if (options.size.empty() && (monitors.size() > 1 || !options.monitor.empty()))
    return {chosen_monitor(monitors, options.monitor), title, true};
  const setup::WindowSize size =
      options.size.empty() ? default_size(screen) : setup::parse_window_size("--size", options.size);
  return {WindowWish{.width = size.width, .height = size.height, .in_points = options.size.empty()}, title};
}

void report(const setup::StudyRunOptions& options, const Outputs& outputs, const study::Agenda& agenda,
            const study::Record& record) {
  if (!options.common.json.empty()) write_file(options.common.json, to_json(agenda, *options.participant));
  if (!setup::shows_summary(options.common, outputs)) return;
  std::string stay_void;
  for (const std::uint32_t step : agenda.stay_void())
    stay_void += fmt::format("{}{}", stay_void.empty() ? " (these stay void: step " : ", ", step + 1);
  if (!stay_void.empty()) stay_void += ")";
  write_file("-", fmt::format("participant {}: {} of {} steps complete, {} void{}, {}; see {}{}\n",
                              *options.participant, agenda.complete(), agenda.steps().size(), agenda.voided(),
                              stay_void, counted(agenda.starts(), "start"), record.folder().beh().string(),
                              agenda.finished() ? "" : "; the same command continues"));
}

/// If all steps of the participant are in the journal, and only its end is missing, writes the end: this needs neither
/// windows nor an array. Returns whether it was so. Throws bad_usage if the participant has finished.
bool complete(const study::StudyPlan& plan, const setup::StudyRunOptions& options, const Outputs& outputs) {
  struct StepsAreLeft {};
  try {
    study::Record record(plan, *options.participant, options.out, options.rehearse.has_value(),
                         [] { throw StepsAreLeft(); });
    record.refuse_finished();
    const study::Sitting sitting(plan, record.agenda(), start_entry(options, "off"),
                                 [&](const study::Entry& entry) { record.add(entry); });
    report(options, outputs, sitting.agenda(), record);
    return true;
  } catch (const StepsAreLeft&) {
    return false;
  }
}

/// Ends the program at once, without waiting for a device. The watch for signals may have decided how; then it has
/// printed its line.
[[noreturn]] void leave_at_once(const std::string& line, std::optional<log::Relay>& relay) {
  if (setup::decide_ending(Exit::failed)) setup::tell_ending(line);
  relay.reset();
  ::_exit(static_cast<int>(setup::ending()));
}

void press_next(ScriptedKeys& script, const study::StudyPlan& plan, Conductor& conductor) {
  const std::optional<ScriptedPress> press = script.next(plan, conductor);
  if (!press) return;
  if (press->experimenter) {
    conductor.experimenter(press->event, std::nullopt);
  } else {
    conductor.participant(press->event, std::nullopt);
  }
}

/// Runs the sitting until it is over or somebody leaves. Returns why it paused last.
std::string conduct(SittingWindows& windows, Conductor& conductor, const study::StudyPlan& plan,
                    std::optional<ScriptedKeys>& script) {
  std::string reason;
  for (bool leaves = false; !leaves;) {
    windows.wait(script ? std::min(conductor.wait_s(), 0.02) : conductor.wait_s());
    leaves = windows.take_experimenters(conductor);
    windows.take_participants(conductor);
    if (windows.closing()) {
      conductor.stop();
      break;
    }
    if (script) press_next(*script, plan, conductor);
    conductor.advance();
    if (!conductor.presentation().fault().empty()) reason = conductor.presentation().fault();
    if (conductor.sitting().screen() == study::Screen::paused) reason = conductor.sitting().reason();
    // Who is thanked can read it; who stopped the program need not wait.
    if (conductor.over() && (script || conductor.sitting().screen() == study::Screen::stopped)) break;
    windows.show(conductor);
  }
  return reason;
}

/// Silences the array and reports. Throws what ended the sitting, or ends the program.
void end_sitting(Conductor& conductor, const setup::StudyRunOptions& options, const Outputs& outputs,
                 std::optional<log::Relay>& relay) {
  if (!conductor.presentation().end(3s))
    leave_at_once("ended without finishing: a link, device or file did not answer", relay);
  const study::Agenda& agenda = conductor.sitting().agenda();
  report(options, outputs, agenda, conductor.record());
  if (!conductor.presentation().end_fault().empty()) {
    const std::string what = "ended, but " + conductor.presentation().end_fault();
    if (setup::Interrupt::signalled()) leave_at_once(what, relay);
    throw failure(what);
  }
  // After a signal, there is one second for everything, but releasing a window's device may take longer.
  if (!agenda.finished() && setup::Interrupt::signalled()) {
    leave_at_once(fmt::format("stopped by a signal after {} of {} steps; the same command continues", agenda.complete(),
                              agenda.steps().size()),
                  relay);
  }
}

}  // namespace

void run_study(const setup::StudyRunOptions& options, const LiveSession::Kinds& kinds) {
  const Outputs outputs({{"--json", options.common.json}});
  const study::StudyPlan plan = plan_to_run(options, kinds);
  if (complete(plan, options, outputs)) return;
  const ParticipantScene scene(plan, options);
  const StudyShapes shapes = load_shapes(plan);
  Window panel({.width = 900,
                .height = 620,
                .in_points = true,
                .instead = "a study needs one for its windows; palpa study rehearse needs none"},
               "palpa experimenter");
  Window window = participant_window(options, scene.setting().screen);
  if (Window::monitors().size() < 2) place_beside(panel, window, !options.size.empty());
  const study::EarLevel level = level_of(plan, shapes, options);
  std::optional<log::Relay> relay(std::in_place);  // nothing waits for the reader of the log
  silence_at_exits();
  const setup::Interrupt interrupt(
      "ended without finishing, one second after the signal: a link, device or file did not answer", Window::wake);
  DrawingThreads threads;
  threads.give_way();
  threads.expect();
  gpu::DeviceOptions device_options = setup::device_options(options.common);
  device_options.window_extensions = panel.extensions();
  const gpu::Device device(device_options);
  threads.have_begun();
  SittingWindows windows(device, panel, window, scene);
  Conductor conductor(plan, options, shapes, level, kinds, setup::Interrupt::flag(), Window::wake);
  log::release_warnings();
  const SilentEnd silent_end(setup::Interrupt::flag());
  std::optional<ScriptedKeys> script;
  if (options.rehearse) script.emplace(*options.rehearse, *options.participant, options.common.seed);
  const std::string reason = conduct(windows, conductor, plan, script);
  end_sitting(conductor, options, outputs, relay);
  if (script && !reason.empty() && !conductor.sitting().agenda().finished()) throw failure(reason);
}

}  // namespace palpa::viewer
