#include "study/sitting/sitting.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"

namespace palpa::study {
namespace {

std::int64_t ns_of(double seconds) {
  return static_cast<std::int64_t>(std::llround(seconds * 1e9));
}

std::string lack_of(const TouchLosses& losses) {
  return fmt::format(
      "the touch lacked its stimulus: of {} frames with skin over the object, {} were thinned, {} outdated and {} left "
      "out, and at most a tenth may be: end other programs",
      losses.skin_frames, losses.thinned_frames, losses.outdated_frames, losses.left_out_frames);
}

}  // namespace

bool lacks_stimulus(const TouchLosses& losses) {
  return 10 * (losses.thinned_frames + losses.outdated_frames + losses.left_out_frames) > losses.skin_frames;
}

Sitting::Sitting(const StudyPlan& plan, Agenda agenda, Entry start, std::function<void(const Entry&)> write)
    : plan_(plan), agenda_(std::move(agenda)), write_(std::move(write)) {
  start.kind = EntryKind::start;
  start.at_ns = 0;
  record(start);
  if (!agenda_.current()) end();
}

/// Whatever goes wrong here, nothing sounds any more.
void Sitting::record(const Entry& entry) {
  try {
    write_(entry);
    const std::string fault = agenda_.take(entry);
    if (!fault.empty()) throw failure("an entry cannot stand in the journal, please report this: " + fault);
  } catch (const std::exception& error) {
    sounding_ = false;
    screen_ = Screen::stopped;
    reason_ = error.what();
    throw;
  }
}

/// A clock that goes back is taken to stand still. One that jumps during a touch makes it longer than planned.
std::int64_t Sitting::forward(std::int64_t now_ns) {
  if (screen_ == Screen::touching) gap_ns_ = std::max(gap_ns_, now_ns - now_ns_);
  return now_ns_ = std::max(now_ns_, now_ns);
}

const PlanBlock& Sitting::block() const {
  return plan_.blocks[step().block];
}

Presented Sitting::presented() const {
  if (!agenda_.current()) return {};
  Presented presented{.sounds = sounding_ && !deep_, .method = step().method};
  presented.shape = step().shape.value_or(0);
  if (agenda_.open() && block().kind == BlockKind::free) presented.shape = chosen_;
  return presented;
}

std::optional<std::int64_t> Sitting::next_ns() const {
  if (screen_ == Screen::touching || screen_ == Screen::rest) return until_ns_;
  return std::nullopt;
}

bool Sitting::shows_object() const {
  return screen_ == Screen::touching && block().kind == BlockKind::familiarise;
}

bool Sitting::shows_marker() const {
  return screen_ == Screen::touching || screen_ == Screen::ready;
}

// ---- steps --------------------------------------------------------------------------------------------------------

/// After a step is complete or void, and after the start.
void Sitting::next_step() {
  sounding_ = false;
  if (agenda_.current()) {
    screen_ = Screen::ready;
    return;
  }
  end();
}

/// The program may have been killed between the last step and this entry.
void Sitting::end() {
  if (!agenda_.finished()) record({.kind = EntryKind::finish, .at_ns = now_ns_});
  screen_ = Screen::end;
}

void Sitting::begin_step(std::int64_t now_ns) {
  reason_.clear();
  record({.kind = EntryKind::begin, .at_ns = now_ns, .step = agenda_.current()});
  chosen_ = step().shape.value_or(0);
  if (block().kind == BlockKind::rest) {
    screen_ = Screen::rest;
    until_ns_ = now_ns + ns_of(block().touch_s);
    return;
  }
  begin_touch(now_ns);
}

void Sitting::begin_touch(std::int64_t now_ns) {
  until_ns_ = now_ns + ns_of(block().touch_s);
  deep_s_ = 0;
  deep_since_ns_ = now_ns;
  gap_ns_ = 0;
  stimulus_.reset();
  screen_ = Screen::touching;
  sounding_ = true;
}

void Sitting::count_deep(std::int64_t now_ns) {
  if (sounding_ && deep_) deep_s_ += static_cast<double>(now_ns - deep_since_ns_) * 1e-9;
  deep_since_ns_ = now_ns;
}

void Sitting::end_touch(std::int64_t now_ns) {
  count_deep(now_ns);
  sounding_ = false;  // before anything is written: a disk may be slow
  const std::optional<TouchLosses> losses = stimulus_ ? stimulus_->losses : std::nullopt;
  record({.kind = EntryKind::touched,
          .at_ns = now_ns,
          .step = agenda_.current(),
          .deep_s = deep_s_,
          .stimulus = std::exchange(stimulus_, std::nullopt)});
  if (losses && lacks_stimulus(*losses) && block().kind != BlockKind::free) {
    break_off(lack_of(*losses), true, now_ns);
    next_step();
  } else if (asks_now()) {
    screen_ = Screen::question;
  } else {
    complete({.kind = EntryKind::done, .at_ns = now_ns});
  }
}

void Sitting::complete(Entry entry) {
  entry.step = agenda_.current();
  record(entry);
  next_step();
}

void Sitting::break_off(std::string why, bool by_machine, std::int64_t now_ns) {
  sounding_ = false;
  reason_ = why;
  if (!agenda_.open()) return;
  if (by_machine && agenda_.last_repeat()) why += "; it was repeated often enough and stays void";
  record(
      {.kind = EntryKind::broken, .at_ns = now_ns, .step = agenda_.current(), .by_machine = by_machine, .text = why});
  reason_ = why;
}

void Sitting::pause(const std::string& why, bool by_machine, std::int64_t now_ns) {
  break_off(why, by_machine, now_ns);
  record({.kind = EntryKind::pause, .at_ns = now_ns, .text = why});
  screen_ = Screen::paused;
}

// ---- what happens -------------------------------------------------------------------------------------------------

void Sitting::act(Act act, std::int64_t now_ns) {
  const std::int64_t now = forward(now_ns);
  if (screen_ == Screen::end || screen_ == Screen::stopped) return;
  if (act == Act::stop) {
    break_off("stopped by the experimenter", false, now);
    record({.kind = EntryKind::stop, .at_ns = now});
    screen_ = Screen::stopped;
    return;
  }
  if (act == Act::pause) {
    if (screen_ != Screen::setup && screen_ != Screen::paused) pause("paused by the experimenter", false, now);
    return;
  }
  const bool free = screen_ == Screen::touching && block().kind == BlockKind::free;
  if (free && (act == Act::next_shape || act == Act::other_shape)) {
    turn_shape(act, now);
  } else {
    act_here(act, now);
  }
}

/// In the free exploration.
void Sitting::turn_shape(Act act, std::int64_t now_ns) {
  const std::vector<std::uint32_t>& shapes = block().shapes;
  const auto at = static_cast<std::size_t>(std::ranges::find(shapes, chosen_) - shapes.begin());
  const std::size_t by = act == Act::next_shape ? 1 : shapes.size() - 1;
  choose((at + by) % shapes.size(), now_ns);
}

/// What it means depends on the screen that is shown.
void Sitting::act_here(Act act, std::int64_t now_ns) {
  switch (screen_) {
    case Screen::touching:
      return pause("silenced by a key of the participant", false, now_ns);
    case Screen::setup:
      if (act == Act::go_on) ask_or_go_on();
      return;
    case Screen::consent:
    case Screen::depth_consent:
      return take_consent(act, now_ns);
    case Screen::ready:
      if (act == Act::go_on) begin_step(now_ns);
      return;
    case Screen::feedback:
      if (act == Act::go_on) next_step();
      return;
    case Screen::paused:
      if (act != Act::go_on) return;
      record({.kind = EntryKind::resume, .at_ns = now_ns});
      reason_.clear();
      return ask_or_go_on();
    case Screen::question:
    case Screen::rest:
    case Screen::end:
    case Screen::stopped:
      return;
  }
}

/// The answer on a page that asks for consent: to the study first, then to keeping depth images.
void Sitting::take_consent(Act act, std::int64_t now_ns) {
  if (act != Act::accept && act != Act::decline) return;
  const bool accepts = act == Act::accept;
  if (screen_ == Screen::depth_consent) {
    record({.kind = EntryKind::consent, .at_ns = now_ns, .accepted = true, .depth_frames = accepts});
    return next_step();
  }
  if (accepts && plan_.run.ask_depth_frames) {
    screen_ = Screen::depth_consent;
    return;
  }
  record({.kind = EntryKind::consent, .at_ns = now_ns, .accepted = accepts});
  if (accepts) {
    next_step();
  } else {
    end();
  }
}

void Sitting::ask_or_go_on() {
  if (agenda_.consent()) return next_step();
  screen_ = Screen::consent;
}

void Sitting::answer(std::size_t choice, std::int64_t now_ns) {
  const std::int64_t now = forward(now_ns);
  if (screen_ != Screen::question || choice >= choices().size()) return;
  const std::string word = answer_word(choice);
  const bool feedback = block().feedback;
  was_right_ = word == right_answer();
  complete({.kind = EntryKind::answer, .at_ns = now, .text = word});
  if (feedback && screen_ == Screen::ready) screen_ = Screen::feedback;
}

void Sitting::choose(std::size_t shape, std::int64_t now_ns) {
  const std::int64_t now = forward(now_ns);
  if (screen_ != Screen::touching || block().kind != BlockKind::free || shape >= block().shapes.size()) return;
  if (block().shapes[shape] == chosen_) return;
  chosen_ = block().shapes[shape];
  record({.kind = EntryKind::choose, .at_ns = now, .step = agenda_.current(), .text = plan_.shapes[chosen_].name});
}

void Sitting::captured(const std::optional<double>& deepest_m, std::int64_t now_ns) {
  const std::int64_t now = forward(now_ns);
  count_deep(now);
  deep_ = deepest_m && !(*deepest_m <= plan_.run.deep_m);  // a depth that is no number is not shallow
}

void Sitting::fault(const std::string& what, std::int64_t now_ns) {
  const std::int64_t now = forward(now_ns);
  sounding_ = false;
  if (screen_ == Screen::end || screen_ == Screen::stopped || screen_ == Screen::paused) return;
  if (screen_ == Screen::setup) {
    reason_ = what;
    return;
  }
  pause(what, true, now);
}

void Sitting::advance(std::int64_t now_ns) {
  const std::int64_t now = forward(now_ns);
  if (screen_ == Screen::touching && gap_ns_ > longest_gap_ns) {
    pause(fmt::format("the program stood still for {:.1f} s", static_cast<double>(gap_ns_) * 1e-9), true, now);
    return;
  }
  if (!next_ns() || now < until_ns_) return;
  if (screen_ == Screen::touching) {
    end_touch(now);
  } else if (screen_ == Screen::rest) {
    complete({.kind = EntryKind::done, .at_ns = now});
  }
}

void Sitting::level(double level_db, double dose_db, const std::string& signature, std::int64_t now_ns) {
  record({.kind = EntryKind::level,
          .at_ns = forward(now_ns),
          .text = signature,
          .level_db = level_db,
          .dose_db = dose_db});
}

// ---- what is shown ------------------------------------------------------------------------------------------------

std::string Sitting::text() const {
  switch (screen_) {
    case Screen::setup:
      return plan_.text(TextId::welcome);
    case Screen::consent:
      return plan_.text(TextId::consent);
    case Screen::depth_consent:
      return plan_.text(TextId::depth_consent);
    case Screen::ready:
    case Screen::rest:
    case Screen::touching:
      return instruction_of(plan_, block());
    case Screen::question:
      return plan_.text(block().kind == BlockKind::familiarise ? TextId::felt : TextId::which_shape);
    case Screen::feedback:
      return plan_.text(was_right_ ? TextId::right_answer : TextId::wrong_answer);
    case Screen::paused:
    case Screen::stopped:
      return plan_.text(TextId::paused);
    case Screen::end:
      return plan_.text(TextId::end);
  }
  return {};
}

/// Whether the current step ends with a question. After a familiarisation, it is whether anything was felt.
bool Sitting::asks_now() const {
  return asks(block().kind) || (block().kind == BlockKind::familiarise && !plan_.text(TextId::felt).empty());
}

std::vector<std::string> Sitting::choices() const {
  return screen_ == Screen::question ? coming_choices() : std::vector<std::string>();
}

bool Sitting::has_choice(std::size_t choice) const {
  return agenda_.current() && asks_now() && choice < coming_choices().size();
}

std::vector<std::string> Sitting::coming_choices() const {
  if (block().kind == BlockKind::familiarise) return {plan_.text(TextId::accept), plan_.text(TextId::decline)};
  std::vector<std::string> choices;
  for (std::size_t shape = 0; shape < plan_.shapes.size(); ++shape)
    choices.push_back(plan_.label(shape));
  return choices;
}

/// The choice as logs have it, in every language.
std::string Sitting::answer_word(std::size_t choice) const {
  if (block().kind == BlockKind::familiarise) return choice == 0 ? "yes" : "no";
  return plan_.shapes[choice].name;
}

std::string Sitting::right_answer() const {
  return plan_.shapes[step().shape.value_or(0)].name;
}

}  // namespace palpa::study
