// `palpa calibrate --nudge`: a focus at the visible fingertip, moved by keys until it is felt there; or for a tracker,
// four foci, which the fingertip touches.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/system/start_thread.hpp"
#include "cli/calibrate.hpp"
#include "cli/keys.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "session/threads.hpp"
#include "setup/files/assets.hpp"
#include "setup/options/options.hpp"
#include "setup/process/interrupt.hpp"
#include "setup/process/progress.hpp"
#include "setup/sessions/load.hpp"
#include "setup/sessions/tracker.hpp"
#include "setup/tasks/calibrate.hpp"
#include "setup/tasks/register_tracker.hpp"

namespace palpa::cli {
namespace {

constexpr const char* no_terminal =
    ": stdin is not a terminal, so keys cannot be pressed; give them as --keys \"right*3 enter\"";

constexpr const char* guide_of_cameras =
    "keep your hands away until the first focus sounds; then point with one finger to the array, touch each focus with "
    "its tip, where you feel it best, hold still, and press Enter with the other hand";
constexpr const char* guide_of_tracker =
    "touch each focus with the index finger, where you feel it best, hold still, and press Enter with the other hand";

/// Shows the state on a terminal, as soon as there is room for it.
class Shown {
 public:
  explicit Shown(bool quiet) : on_(!quiet && isatty(STDERR_FILENO) != 0) {}
  ~Shown() {
    if (on_) log::draw("\r\x1b[K");
  }
  Shown(const Shown&) = delete;
  Shown& operator=(const Shown&) = delete;
  void show(const std::string& line) {
    if (on_ && line != drawn_ && log::draw("\r" + line + "\x1b[K")) drawn_ = line;
  }

 private:
  bool on_;
  std::string drawn_;
};

/// Applies the keys to the array, or to the foci that are touched. Keys arrive by time, on a separate thread, and
/// frames use the resulting state.
class Hand final : public session::RunObserver {
 public:
  /// Of `script`, one key is pressed with each frame that has a finger. `touches`: null if a single focus is moved.
  Hand(session::Session& session, setup::Nudge& nudge, setup::TouchSteps* touches, std::vector<KeyPress> script,
       std::atomic<bool>& stop, bool quiet)
      : session_(&session),
        script_(std::move(script)),
        nudge_(&nudge),
        touches_(touches),
        stop_(&stop),
        shown_(quiet) {}

  void planned(const session::FrameReport& frame, const session::Plan&) override {
    begin(frame.time_s);
    if (next_ < script_.size() && frame.touch->finger_count > 0) {
      press(script_[next_++]);
      show();
      if (next_ == script_.size()) *stop_ = true;
    }
    const Vec3 wanted = offset();
    if (!touches_ && wanted != std::exchange(aim_, wanted)) session_->set_aim(wanted);
  }
  void press(const KeyPress& press) {
    const std::lock_guard lock(mutex_);
    if (!begun_ && press.key != Key::leave) return;
    nudge_->press(press, time_s_);
    if (nudge_->end() != setup::Nudge::End::none) *stop_ = true;
  }
  /// Shows the current state, if it has changed.
  void show() {
    const std::lock_guard lock(mutex_);
    if (!begun_) return;
    if (!touches_) return shown_.show(nudge_->place() + "; f: finer, 0: back, Enter: save, q: leave");
    const std::string hint = nudge_->hint().empty() ? "" : "not taken, " + nudge_->hint() + "; ";
    shown_.show(fmt::format("{}: {}Enter: touched, q: leave; arrows, f: finer, 0: back: {}", touches_->line(), hint,
                            nudge_->place()));
  }

 private:
  /// There is a frame, so keys from now on have an effect that can be felt.
  void begin(double time_s) {
    const std::lock_guard lock(mutex_);
    begun_ = true;
    time_s_ = time_s;
  }
  Vec3 offset() const {
    const std::lock_guard lock(mutex_);
    return nudge_->offset();
  }

  session::Session* session_;
  std::vector<KeyPress> script_;
  std::size_t next_ = 0;  ///< key of the script
  Vec3 aim_{0};           ///< of the session
  mutable std::mutex mutex_;
  setup::Nudge* nudge_;
  setup::TouchSteps* touches_;
  std::atomic<bool>* stop_;
  Shown shown_;
  bool begun_ = false;
  double time_s_ = 0;  ///< of the newest frame
};

/// Reads the terminal's keys, whether frames come or not. Earlier input is discarded.
class Typing {
 public:
  Typing(Hand& hand, const char* mode) : terminal_(mode + std::string(no_terminal)), hand_(&hand) {
    terminal_.forget();
    thread_ = start_thread("the keys", [this] { listen(); });
  }
  ~Typing() {
    ends_ = true;
    thread_.join();
  }
  Typing(const Typing&) = delete;
  Typing& operator=(const Typing&) = delete;

 private:
  void listen() {
    session::take_no_signals();
    constexpr std::chrono::milliseconds between(20);
    KeyReader reader;
    std::vector<KeyPress> pressed;
    for (; !ends_; std::this_thread::sleep_for(between)) {
      pressed.clear();
      reader.feed(terminal_.read(), pressed);
      for (const KeyPress& press : pressed)
        hand_->press(press);
      hand_->show();
    }
  }

  RawTerminal terminal_;
  Hand* hand_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

std::string nudge_json(const Vec3& offset, bool saved, const sensing::Rig& rig) {
  JsonWriter json;
  json.begin_object().member("offset_m", offset).member("saved", saved);
  setup::add_pose(json, "T_world_layout", *rig.array->T_world_layout);
  json.end_object();
  return json.take();
}

std::string registration_json(const std::optional<setup::Registration>& found,
                              const std::vector<setup::TouchedFocus>& touches, const Transform& T_world_layout) {
  JsonWriter json;
  json.begin_object().member("saved", found.has_value());
  if (found) {
    json.member("residual_m", found->residual_m);
    setup::add_pose(json, "T_world_joints", found->T_world_joints);
    setup::add_pose(json, "T_layout_joints", glm::inverse(T_world_layout) * found->T_world_joints);
    json.key("touches").begin_array(JsonWriter::Style::block);
    for (std::size_t i = 0; i < touches.size(); ++i) {
      json.begin_object(JsonWriter::Style::line).member("focus_m", touches[i].focus_m);
      json.member("tip_m", touches[i].tip_m).member("off_m", found->off_m[i]).end_object();
    }
    json.end_array();
  }
  json.end_object();
  return json.take();
}

/// Writes what the touches give; nothing is found if the user left.
void report_registration(const CalibrateCommand& o, const Outputs& outputs, const setup::PosedRig& posed, bool saves,
                         const setup::FocusTouches& touches) {
  const std::vector<setup::TouchedFocus> touched = touches.touches().value_or(std::vector<setup::TouchedFocus>());
  std::optional<setup::Registration> found;
  if (saves) {
    found = setup::register_tracker(touched, posed.layout);
    sensing::Rig rig = setup::rig_to_write(posed, o.rig);
    rig.T_world_joints = found->T_world_joints;
    rig.joints_residual_m = found->residual_m;
    setup::write_rig(o.out, rig);
  }
  if (!o.common.json.empty()) write_file(o.common.json, registration_json(found, touched, posed.T_world_layout));
  if (setup::shows_summary(o.common, outputs)) {
    write_file("-", found ? fmt::format("the tracker is registered: {:.1f} mm rms; written to {}\n",
                                        found->residual_m * 1e3, o.out)
                          : "nothing is saved\n");
  }
}

/// Runs until Enter or q, or until the run ends otherwise.
void run_until_end(setup::LiveRun& live, const CalibrateCommand& o, std::atomic<bool>& stop, setup::Nudge& nudge,
                   setup::TouchSteps* touches) {
  const log::Relay relay;
  const setup::Interrupt interrupt(
      "ended without finishing, one second after the signal: a link, device or file did not answer");
  std::vector<KeyPress> script;
  if (!o.keys.empty()) script = parse_keys("--keys", o.keys);
  Hand hand(live.session(), nudge, touches, std::move(script), stop, o.common.quiet);
  std::optional<Typing> typing;
  if (o.keys.empty()) {
    if (touches) log::at_once(o.by_touch ? guide_of_cameras : guide_of_tracker);
    typing.emplace(hand, o.by_touch ? "--by-touch" : "--nudge");
  }
  log::release_warnings();
  live.run(hand);
}

}  // namespace

void check_keys(const CalibrateCommand& o, const char* mode) {
  if (o.out.empty()) throw bad_usage(fmt::format("{}: --out is missing: give a file for the new rig", mode));
  if (o.keys.empty() && isatty(STDIN_FILENO) == 0) throw bad_usage(mode + std::string(no_terminal));
  // Before anything is opened.
  if (!o.keys.empty() && parse_keys("--keys", o.keys).empty())
    throw bad_usage("--keys has no key: give keys such as \"right*3 enter\"");
}

KeysEnd run_with_keys(const CalibrateCommand& o, std::span<const session::SourceKind> sources,
                      std::span<const session::LinkKind> links, const char* mode, setup::TouchSteps* touches) {
  std::atomic<bool>& stop = setup::Interrupt::flag();
  setup::Nudge nudge(touches);
  KeysEnd end;
  try {
    setup::LiveRun live(o, sources, links, stop);
    run_until_end(live, o, stop, nudge, touches);
  } catch (const Error& error) {
    // A confirmed result is not lost if the link fails at the end.
    if (nudge.end() != setup::Nudge::End::save) throw;
    end.fault = error;
  }
  end.saves = nudge.end() == setup::Nudge::End::save && !setup::Interrupt::signalled();
  end.offset_m = nudge.offset();
  if (!end.saves && nudge.end() != setup::Nudge::End::leave && !setup::Interrupt::signalled()) {
    throw failure(fmt::format("{}: nothing is saved, because {}", mode, nudge.why_unsaved()));
  }
  return end;
}

void add_nudge_options(CLI::App& app, CalibrateCommand& o) {
  const line::Group group(app, "With --nudge");
  group.flag("--nudge", o.nudge,
             "plays a focus at the fingertip that cameras see; move it with the arrows, PageUp and PageDown until you "
             "feel it there, and --out gets the array's corrected place; with --source joints, plays four foci, and "
             "--out gets the tracker's place after you touched each with the index finger and pressed Enter");
  group.flag("--by-touch", o.by_touch,
             "plays eight foci one after the other; touch each with a fingertip that points to the array, and press "
             "Enter; --out gets the poses of the cameras that saw it (docs/calibration.md)");
  group.text("--scene", o.scene, "FILE", "glTF model that the fingertip touches [assets/cube.glb]");
  group.text("--link", o.link, "LINK", "where drives go, as for palpa run");
  setup::add_board_files(group, o.board_files);
  group.text("--keys", o.keys, "KEYS",
             "keys instead of a terminal's, one with each frame: \"right*3 shift+up enter\" [the terminal's]");
  group.quantity("--hold", o.hold_s, Quantity::time, line::positive(10),
                 "how long the newest frame sounds if no other comes");
  setup::add_safety(group, o.safety, &o.ceiling_known);
  setup::add_medium_options(app, o.drive.medium);
  line::imply(app, "--by-touch", "--nudge");
  line::need(app, line::under(app, {"With --nudge", "Air and tone"}), "--nudge");
}

void run_nudge(const Extensions& extensions, const CalibrateCommand& given) {
  CalibrateCommand o = given;
  check_keys(o, "--nudge");
  if (o.source.empty()) o.source = "synthetic";
  const bool tracked = setup::is_tracker(o.source);
  if (tracked && !o.scene.empty())
    throw bad_usage("--scene goes with cameras: a tracker is registered by foci in the air");
  if (o.scene.empty()) o.scene = setup::find_asset("cube.glb");
  o.touch.method.method = touch::Method::single_focus;
  o.every_frame = !o.keys.empty();  // a script takes as many frames as it has keys
  setup::check(o);
  const Outputs outputs({{"--json", o.common.json},
                         {"--out", o.out},
                         {"--link", session::file_of_link(o.link, setup::with_builtin(extensions.links))}});
  setup::take_layout_of_link(o.rig, o.link, setup::with_builtin(extensions.links));
  const setup::PosedRig posed = setup::load_posed_rig(o.rig);
  setup::FocusTouches touches;
  std::vector<session::SourceKind> sources = extensions.sources;
  if (tracked) {
    sources.push_back(touches.source());
    o.own_method = touches.method();
  }
  const KeysEnd end = run_with_keys(o, sources, extensions.links, "--nudge", tracked ? &touches : nullptr);
  if (tracked) {
    report_registration(o, outputs, posed, end.saves, touches);
    if (end.fault) throw Error(*end.fault);
    return;
  }
  const sensing::Rig rig = setup::nudged_rig(posed, o.rig, "--keys", end.offset_m);
  if (end.saves) setup::write_rig(o.out, rig);
  if (!o.common.json.empty()) write_file(o.common.json, nudge_json(end.offset_m, end.saves, rig));
  if (setup::shows_summary(o.common, outputs)) {
    const Vec3 mm = end.offset_m * 1e3;
    write_file("-", fmt::format("x {:+.1f}, y {:+.1f}, z {:+.1f} mm; {}\n", mm.x, mm.y, mm.z,
                                end.saves ? "written to " + o.out : "nothing is saved"));
  }
  if (end.fault) throw Error(*end.fault);
}

}  // namespace palpa::cli
