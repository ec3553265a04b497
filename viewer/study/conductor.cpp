#include "viewer/study/conductor.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/without_folders.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "geometry/gltf/write.hpp"
#include "session/links/foci_file.hpp"
#include "setup/process/interrupt.hpp"

namespace palpa::viewer {
namespace {

using study::Act;
using study::Screen;

/// If this program's thread stands still for longer, the array is silent until it goes on.
constexpr std::chrono::milliseconds dead_man{500};

/// What a participant presses so soon after an answer was meant as a part of it: a double click is one click.
constexpr std::int64_t double_press_ns = 300'000'000;

bool begins(Screen screen) {
  return screen == Screen::ready || screen == Screen::feedback;
}

/// Screens during which the next touch is prepared.
bool prepares(Screen screen) {
  return screen != Screen::paused && screen != Screen::end && screen != Screen::stopped;
}

/// Screens on which a press of the participant goes on to something else, and silences nothing.
bool waits_for_press(Screen screen) {
  return begins(screen) || screen == Screen::depth_consent;
}

bool masks(Screen screen) {
  return begins(screen) || screen == Screen::touching || screen == Screen::question;
}

}  // namespace

std::string to_text(const study::TouchLosses& losses) {
  std::string text;
  const auto add = [&](std::uint64_t count, const char* noun, const char* what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + counted(count, noun) + ' ' + what;
  };
  add(losses.drives, "drive", "lost");
  add(losses.skipped_drives, "drive", "never sent");
  add(losses.outdated_frames, "frame", "too late");
  add(losses.thinned_frames, "frame", "thinned");
  add(losses.left_out_frames, "frame", "left out");
  return text;
}

study::Entry start_entry(const setup::StudyRunOptions& run, const std::string& masking) {
  return {.text = study::utc_now(),
          .version = version_and_commit(),
          .rehearsal = run.rehearse.has_value(),
          .masking = masking,
          .backend = std::string(word_of(setup::backend_words, setup::used_backend(run.common).backend))};
}

Conductor::Conductor(const study::StudyPlan& plan, const setup::StudyRunOptions& run, const StudyShapes& shapes,
                     const study::EarLevel& level, const LiveSession::Kinds& kinds, std::atomic<bool>& stop,
                     std::function<void()> wake, const session::Clock& clock)
    : plan_(&plan),
      run_(&run),
      shapes_(&shapes),
      level_(level),
      record_(plan, *run.participant, run.out, run.rehearse.has_value(),
              [&] {
                masking_.emplace(plan.run.masking);
                try_study_source(plan, run, kinds);
                try_study_link(plan, run, kinds);
              }),
      clock_(&clock) {
  // As close to each other as answers are timed, also where something else interrupts this thread between them.
  for (Clock::time_point before; system_begin_ - before > std::chrono::microseconds(50);) {
    before = Clock::now();
    begin_ = time_of(clock);
    system_begin_ = Clock::now();
  }
  record_.refuse_finished();
  if (!masking_) masking_.emplace("off");  // no step is left
  sitting_ = std::make_unique<study::Sitting>(plan, record_.agenda(), start_entry(run, masking_->name()),
                                              [this](const study::Entry& entry) { write(entry); });
  run_number_ = sitting_->agenda().starts();
  if (!over()) sitting_->level(level.loudest_db(), level.equivalent_db(), run.override_by, now_ns());
  const std::filesystem::path scene = record_.folder().file(run_number_, "_shapes.glb");
  geometry::write_glb(scene, shapes.meshes);
  finger_.emplace(record_.folder(), run_number_);
  presentation_ = std::make_unique<Presentation>(plan, run, shapes, scene, kinds, stop, std::move(wake), clock);
}

/// Says how long the array sounded, so that no sound is missing in the participant's dose, whatever ended it.
void Conductor::write(study::Entry entry) {
  if (presentation_) {
    const double sounded_s = std::chrono::duration<double>(presentation_->gate().sounded_for()).count();
    if (const double since_s = sounded_s - std::exchange(written_s_, sounded_s); since_s > 0) entry.sounded_s = since_s;
  }
  record_.add(entry);
}

/// Times of the sitting count from its start.
std::int64_t Conductor::ns_of(std::int64_t steady_ns) const {
  return steady_ns - std::chrono::duration_cast<std::chrono::nanoseconds>(system_begin_.time_since_epoch()).count();
}

std::int64_t Conductor::now_ns() const {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time_of(*clock_) - begin_).count();
}

// ---- what people do -----------------------------------------------------------------------------------------------

/// Whether a touch under way ends by it.
bool Conductor::silences(Act act) const {
  if (sitting_->screen() != Screen::touching) return false;
  const bool changes = act == Act::next_shape || act == Act::other_shape;
  return !(changes && sitting_->block().kind == study::BlockKind::free);
}

/// Silence does not wait for the disk.
void Conductor::act(Act act, std::int64_t at_ns) {
  if (silences(act)) presentation_->close();
  sitting_->act(act, at_ns);
  follow_touch();
}

/// Whether it is an answer to the question that comes. Then the participant is asked to wait for it.
bool Conductor::answers_early(const std::optional<std::size_t>& button) {
  const bool early = button && sitting_->has_choice(*button);
  early_ = early_ || early;
  return early;
}

void Conductor::participant(const WindowEvent& event, std::optional<std::size_t> button) {
  const bool key = event.kind == WindowEvent::Kind::key && event.down && !event.repeat;
  const bool click = event.kind == WindowEvent::Kind::press;
  if (!key && !click) return;
  const std::int64_t at_ns = ns_of(event.at_ns);
  if (key) button = button_of_key(static_cast<char>(event.key));
  const Screen before = sitting_->screen();
  if (answered_ns_ && at_ns - *answered_ns_ < double_press_ns && waits_for_press(before)) return;
  const bool ready_key = key && (event.key == Key::space || event.key == Key::enter);
  switch (sitting_->screen()) {
    case Screen::consent:
    case Screen::depth_consent:
      if (button == 0) act(Act::accept, at_ns);
      if (button == 1) act(Act::decline, at_ns);
      break;
    case Screen::question:
      if (button) sitting_->answer(*button, at_ns);
      break;
    case Screen::ready:
      // Otherwise, the touch would begin in silence.
      if ((ready_key || click) && (presentation_->ready() || sitting_->block().kind == study::BlockKind::rest))
        act(Act::go_on, at_ns);
      return;
    case Screen::feedback:
      if (ready_key || click) act(Act::go_on, at_ns);
      return;
    case Screen::touching:
      if (key && (event.key == Key::right || event.key == Key::down)) return act(Act::next_shape, at_ns);
      if (key && (event.key == Key::left || event.key == Key::up)) return act(Act::other_shape, at_ns);
      if (key && button && sitting_->block().kind == study::BlockKind::free &&
          *button < sitting_->block().shapes.size()) {
        sitting_->choose(*button, at_ns);
        return;
      }
      // An answer that comes too early is no wish for silence.
      if (key && answers_early(button)) return;
      return act(Act::any_key, at_ns);
    case Screen::setup:
    case Screen::rest:
    case Screen::paused:
    case Screen::end:
    case Screen::stopped:
      return;
  }
  // The screen of a question has changed if it was answered. A scripted participant presses once.
  if (sitting_->screen() != before && !run_->rehearse) answered_ns_ = at_ns;
}

void Conductor::experimenter(const WindowEvent& event, std::optional<std::size_t> button) {
  const std::int64_t at_ns = ns_of(event.at_ns);
  if (event.kind == WindowEvent::Kind::press) {
    const ExperimenterView view = experimenter_view();
    if (button && *button < view.buttons.size()) command(view.buttons[*button].command, at_ns);
    return;
  }
  if (event.kind != WindowEvent::Kind::key || !event.down || event.repeat) return;
  if (event.key == Key::space || event.key == Key::enter) command(Command::go_on, at_ns);
  if (event.key == key_of('p')) command(Command::pause, at_ns);
  if (event.key == key_of('q') || event.key == Key::escape) command(Command::stop, at_ns);
}

void Conductor::command(Command command, std::int64_t at_ns) {
  switch (command) {
    case Command::pause:
      return act(Act::pause, at_ns);
    case Command::stop:
      return act(Act::stop, at_ns);
    case Command::go_on:
      break;
  }
  const Screen screen = sitting_->screen();
  if (screen != Screen::setup && screen != Screen::paused) return;
  // After a fault, the first press starts the session again.
  const bool failed = std::exchange(told_fault_, false);
  if (screen == Screen::setup && (failed || !presentation_->ready())) return;
  act(Act::go_on, at_ns);
}

void Conductor::stop() {
  act(Act::stop, now_ns());
}

// ---- what time does -----------------------------------------------------------------------------------------------

std::string Conductor::next_file(const std::string& end) const {
  return record_.folder().file(run_number_, fmt::format("_touch-{:03}{}", touches_, end)).string();
}

/// A touch begins or was broken off.
void Conductor::follow_touch() {
  const bool touching = sitting_->screen() == Screen::touching;
  if (touching == touching_) return;
  touching_ = touching;
  if (touching) {
    ++touches_;
    presentation_->gate().forget();
    presentation_->gate().frames().begin(run_->hold_s);
    if (keeps_depth()) presentation_->record(next_file("_depth"));
    return;
  }
  presentation_->close();
  presentation_->gate().frames().end();
  if (keeps_depth()) presentation_->record("");
}

bool Conductor::keeps_depth() const {
  const std::optional<study::Consent>& consent = sitting_->agenda().consent();
  return consent && consent->depth_frames;
}

/// What the touch under way has lost so far.
study::TouchLosses Conductor::losses() const {
  const GateCounts counts = presentation_->gate().counts();
  const FrameCounts frames = presentation_->gate().frames().counts();
  return {.drives = counts.lost(),
          .skipped_drives = counts.skipped,
          .outdated_frames = frames.outdated,
          .thinned_frames = frames.thinned,
          .left_out_frames = frames.left_out,
          .skin_frames = frames.skin};
}

/// Drives that are on their way count as soon as they are there.
void Conductor::wait_for_arrivals() const {
  const Clock::time_point until = Clock::now() + std::chrono::milliseconds(20);
  while (presentation_->gate().counts().lost() > 0 && Clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

/// Everything that was played is on the disk before the sitting can go on. Returns why the touch does not count; empty
/// if it does.
std::string Conductor::end_touch() {
  presentation_->close();
  wait_for_arrivals();
  presentation_->gate().frames().end();
  last_losses_ = losses();
  const study::Presented presented = sitting_->presented();
  const PlayedTouch played = presentation_->gate().take();
  study::Stimulus stimulus{.model_sha256 = shapes_->shapes[presented.shape].model_sha256,
                           .ceiling = plan_->level.ceiling,
                           .drives_sha256 = played.drives_sha256,
                           .drives = played.counts.drives,
                           .layout = without_folders(plan_->methods[presented.method].layout),
                           .losses = last_losses_};
  if (const auto scene = presentation_->scene(); scene && !played.frames.empty()) {
    const std::string file = next_file("_foci.json");
    const auto foci = session::open_foci_file(
        file, {.layout = scene->layout, .solid_names = scene->solid_names, .slot_s = presentation_->slot_s()});
    for (const PlayedFrame& frame : played.frames)
      foci->plan({.schedule = frame.schedule, .slots = {.from = frame.from, .until = frame.until}});
    if (const array::Schedule& last = played.frames.back().schedule; last.voice_count > 0) {
      // A frame without fingers says when the touch ended.
      const array::Schedule nothing{.slot_s = presentation_->slot_s(), .time_s = last.time_s};
      foci->plan({.schedule = nothing, .slots = {.from = played.end, .until = played.end}});
    }
    foci->commit();
    keep_file(file);
    stimulus.foci_file = std::filesystem::path(file).filename().string();
  }
  finger_->flush(static_cast<double>(now_ns()) * 1e-9);
  sitting_->played(std::move(stimulus));
  if (!played.counts.too_few()) return {};
  return fmt::format(
      "{} of the touch's {} drives did not reach the array, and at most 1 % may get lost: end other "
      "programs, and see whether the array is plugged in and switched on",
      played.counts.lost(), played.counts.sounding);
}

void Conductor::advance() {
  if (over()) {
    masking_->play(false);
    (void)presentation_->end(std::chrono::milliseconds(0));
    return;
  }
  if (setup::Interrupt::signalled()) return stop();
  if (prepares(sitting_->screen()) && sitting_->agenda().current() && !told_fault_) {
    const study::Presented next = sitting_->presented();
    presentation_->prepare(next.method, next.shape);
  }
  presentation_->look();
  const std::int64_t now = now_ns();
  if (!presentation_->fault().empty() && !std::exchange(told_fault_, true)) {
    presentation_->close();
    sitting_->fault(without_folders(presentation_->fault()), now);
    follow_touch();
  }
  if (const std::optional<double> depth = presentation_->deepest_m()) {
    finger_->add(static_cast<double>(now) * 1e-9, study::FingerSample{*depth, *presentation_->lowest()});
  } else {
    finger_->add(static_cast<double>(now) * 1e-9, std::nullopt);
  }
  if (sitting_->screen() == Screen::touching) {
    sitting_->captured(presentation_->deepest_m(), now);
    last_losses_ = losses();
    if (now >= *sitting_->next_ns()) {
      if (const std::string lack = end_touch(); !lack.empty()) sitting_->fault(lack, now);
      touching_ = false;
      if (keeps_depth()) presentation_->record("");
    }
  }
  sitting_->advance(now);
  follow_touch();
  early_ = early_ && sitting_->screen() == Screen::touching;
  masking_->play(masks(sitting_->screen()));
  if (sitting_->presented().sounds) {
    const Clock::time_point end = begin_ + std::chrono::nanoseconds(*sitting_->next_ns());
    presentation_->open(std::min(end, time_of(*clock_) + dead_man));
  } else {
    presentation_->close();
  }
}

double Conductor::wait_s() const {
  constexpr double usual_s = 0.1;  // presses, frames and faults end a wait
  const std::optional<std::int64_t> next = sitting_->next_ns();
  if (!next) return usual_s;
  return std::clamp(static_cast<double>(*next - now_ns()) * 1e-9, 1e-3, usual_s);
}

bool Conductor::over() const {
  return sitting_->screen() == Screen::end || sitting_->screen() == Screen::stopped;
}

// ---- what is shown ------------------------------------------------------------------------------------------------

ParticipantView Conductor::participant_view() const {
  ParticipantView view{.screen = sitting_->screen(), .text = sitting_->text()};
  view.object = sitting_->shows_object();
  view.marker = sitting_->shows_marker() && sitting_->block().kind != study::BlockKind::rest;
  view.shape = sitting_->presented().shape;
  switch (view.screen) {
    case Screen::consent:
    case Screen::depth_consent:
      view.buttons = {plan_->text(study::TextId::accept), plan_->text(study::TextId::decline)};
      break;
    case Screen::question:
      view.buttons = sitting_->choices();
      break;
    case Screen::feedback:
      view.hint = plan_->text(study::TextId::go_on);
      break;
    case Screen::ready: {
      const bool ready = presentation_->ready() || sitting_->block().kind == study::BlockKind::rest;
      view.hint = plan_->text(ready ? study::TextId::go_on : study::TextId::wait);
      break;
    }
    case Screen::touching:
      if (early_) view.hint = plan_->text(study::TextId::not_yet);
      if (sitting_->block().kind == study::BlockKind::free) view.hint = plan_->label(view.shape);
      break;
    default:
      break;
  }
  return view;
}

namespace {

void add_line(ExperimenterView& view, const char* name, std::string value, bool warns = false) {
  view.lines.push_back({name, std::move(value), warns});
}

void tell_limits(ExperimenterView& view) {
  std::string limits;
  for (const study::EarLimit& limit : study::ear_limits())
    limits += fmt::format("{}{:.0f} dB {} ({})", limits.empty() ? "" : "\n", limit.db, limit.who, limit.what);
  for (std::size_t at = 0, line = 0; at < limits.size(); ++line) {
    const std::size_t end = std::min(limits.find('\n', at), limits.size());
    add_line(view, line == 0 ? "limits" : "", limits.substr(at, end - at));
    at = end + 1;
  }
}

}  // namespace

ExperimenterView Conductor::experimenter_view() const {
  static constexpr const char* names[] = {"set-up",         "consent page", "consent to depth images",
                                          "ready to begin", "touch",        "question",
                                          "feedback",       "a break",      "paused",
                                          "the end",        "stopped"};
  ExperimenterView view;
  view.title =
      fmt::format("{} · participant {}{}", plan_->title, *run_->participant, run_->rehearse ? " · rehearsal" : "");
  view.state = names[static_cast<std::size_t>(sitting_->screen())];
  view.may_sound = presentation_->gate().may_sound();
  view.sounds = presentation_->gate().heard();
  tell_step(view);
  tell_array(view);
  tell_finger(view);
  tell_level(view);
  tell_limits(view);
  add_line(view, "masking", masking_->name(), masking_->name() == "off");
  if (!sitting_->reason().empty()) add_line(view, "reason", sitting_->reason(), true);
  offer_commands(view);
  return view;
}

void Conductor::tell_step(ExperimenterView& view) const {
  const study::Agenda& agenda = sitting_->agenda();
  add_line(view, "steps",
           fmt::format("{} of {} complete, {} void{}", agenda.complete(), agenda.steps().size(), agenda.voided(),
                       agenda.stay_void().empty()
                           ? std::string()
                           : fmt::format(", {} stay void", counted(agenda.stay_void().size(), "step"))),
           !agenda.stay_void().empty());
  if (!agenda.current()) return;
  const study::Step& step = agenda.step(*agenda.current());
  const study::BlockKind kind = plan_->blocks[step.block].kind;
  add_line(view, "now", fmt::format("step {}: {}", *agenda.current() + 1, word_of(study::block_words, kind)));
  add_line(view, "method", plan_->methods[step.method].name);
  if (step.shape || kind == study::BlockKind::free)
    add_line(view, "shape", plan_->shapes[sitting_->presented().shape].name);
}

void Conductor::tell_array(ExperimenterView& view) const {
  const bool failed = !presentation_->fault().empty(), gone = presentation_->gate().out_of_reach();
  add_line(view, "array",
           failed                   ? presentation_->fault()
           : gone                   ? run_->link + " is out of reach: see whether it is plugged in and switched on"
           : presentation_->ready() ? fmt::format("{}, {:.0f} frames/s", run_->link, presentation_->rate_hz())
                                    : "is being prepared",
           failed || gone);
  study::TouchLosses overload = last_losses_;
  if (overload.drives <= GateCounts::overtaken) overload.drives = 0;  // they may be on their way
  const std::string lost = to_text(overload);
  add_line(view, "overload", lost.empty() ? "none" : lost + (touching_ ? " in this touch" : " in the last touch"),
           !lost.empty());
}

void Conductor::tell_finger(ExperimenterView& view) const {
  const std::optional<double> depth = presentation_->deepest_m();
  if (!depth) return add_line(view, "finger", "not over the object");
  add_line(view, "finger", fmt::format("{:.0f} mm {} the top", std::abs(*depth) * 1e3, *depth < 0 ? "above" : "below"),
           *depth > plan_->run.deep_m);
}

/// At the participant's ears.
void Conductor::tell_level(ExperimenterView& view) const {
  add_line(view, "level",
           fmt::format("{:.0f} dB {} at the louder ear, limit {:.0f} dB", level_.loudest_db(), level_.word(),
                       plan_->level.limit_db),
           level_.loudest_db() > plan_->level.limit_db);
  const std::string reflections =
      level_.measured ? std::string() : fmt::format("reflections +-{:.0f} dB; ", study::reflections_db);
  add_line(view, "",
           fmt::format("{:.0f} dB equivalent for 8 h; {}ceiling {:g}", level_.equivalent_db(), reflections,
                       plan_->level.ceiling));
  const double sounded_s = study::sounded_s(record_.entries());
  add_line(view, "dose",
           sounded_s > 0 ? fmt::format("{:.0f} s of sound so far: at most {:.0f} dB equivalent for 8 h", sounded_s,
                                       study::equivalent_db(level_.loudest_db(), sounded_s))
                         : "no sound so far");
}

void Conductor::offer_commands(ExperimenterView& view) const {
  const Screen screen = sitting_->screen();
  const bool failed = !presentation_->fault().empty();
  if (screen == Screen::setup || screen == Screen::paused)
    view.buttons.push_back({Command::go_on, failed && screen == Screen::setup ? "try again" : "continue", "space"});
  if (screen != Screen::setup && screen != Screen::paused && !over())
    view.buttons.push_back({Command::pause, "pause", "P"});
  if (!over()) view.buttons.push_back({Command::stop, "stop", "Q"});
}

}  // namespace palpa::viewer
