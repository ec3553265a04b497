// A participant's sitting as a state machine: consent, instructions, touches, questions, breaks, pauses. It knows no
// window, no array, no file and no clock of its own. Its user passes on keys, depths, faults and the time, shows
// screen(), and plays what presented() says. The array sounds only while presented().sounds is true.
//
// Each entry is written before the next thing can happen. If it cannot be written, the sitting has stopped, nothing is
// presented, and the error is thrown.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "study/files/journal.hpp"
#include "study/plan/plan.hpp"
#include "study/sitting/agenda.hpp"

namespace palpa::study {

enum class Screen {
  setup,          ///< the experimenter prepares: tracker, array, headphones, level. After each start of the program
  consent,        ///< accept or decline
  depth_consent,  ///< accept or decline that depth images are kept
  ready,          ///< before a step: go_on begins it
  touching,
  question,  ///< choices()
  feedback,  ///< whether the answer was right: go_on
  rest,      ///< a break
  paused,    ///< go_on (the experimenter's) continues
  end,       ///< all is complete, or the participant declined
  stopped,   ///< ended before the end; the same command continues
};

/// What the participant and the experimenter do.
enum class Act {
  go_on,        ///< the participant's "ready", or the experimenter's "continue" on setup and paused
  accept,       ///< consent
  decline,      ///< consent
  next_shape,   ///< free exploration
  other_shape,  ///< free exploration: the shape before
  any_key,      ///< any other key of the participant: silence if anything sounds
  pause,        ///< the experimenter
  stop,         ///< the experimenter ends the program
};

/// What the array presents.
struct Presented {
  bool sounds = false;
  /// Indices into the plan's. While it is silent: what sounds next.
  std::uint32_t method = 0, shape = 0;
  bool operator==(const Presented&) const = default;
};

/// Whether a touch lacked its stimulus: more than a tenth of its frames with skin over the object were thinned,
/// outdated or left out. The answer to such a touch says nothing.
bool lacks_stimulus(const TouchLosses& losses);

class Sitting {
 public:
  /// Continues after the entries that `agenda` has taken, and writes the start, and the end if no step is left. Times
  /// are nanoseconds of a clock that does not go back, counted from this start. `write` puts an entry on the disk, or
  /// throws.
  Sitting(const StudyPlan& plan, Agenda agenda, Entry start, std::function<void(const Entry&)> write);

  void act(Act act, std::int64_t now_ns);
  /// The choice of that number, from 0. Ignored unless a question is shown.
  void answer(std::size_t choice, std::int64_t now_ns);
  /// In the free exploration, the shape of that number among the block's, from 0. Ignored otherwise.
  void choose(std::size_t shape, std::int64_t now_ns);
  /// The depth of the deepest captured point below the top of the object, metres; nothing if none was captured.
  void captured(const std::optional<double>& deepest_m, std::int64_t now_ns);
  /// A camera, the array or a disk failed: silence, and a pause that says why. The step under way is void. It is
  /// repeated at most most_repeats times, as one that lacked its stimulus.
  void fault(const std::string& what, std::int64_t now_ns);
  /// Must be called at least ten times a second while next_ns() is near, and with every frame.
  void advance(std::int64_t now_ns);
  /// Adds what was played to the entry of the touch that ends next. If the touch lacked its stimulus, its step is void
  /// and nothing is asked, except in the free exploration.
  void played(Stimulus stimulus) { stimulus_ = std::move(stimulus); }
  /// Writes the predicted or measured level, on setup.
  void level(double level_db, double dose_db, const std::string& signature, std::int64_t now_ns);

  Screen screen() const { return screen_; }
  Presented presented() const;
  /// When advance() changes something next, if nothing else happens.
  std::optional<std::int64_t> next_ns() const;

  /// The text for the participant: an instruction, a question, the consent page.
  std::string text() const;
  /// The answers that can be chosen, on the screen question.
  std::vector<std::string> choices() const;
  /// Whether the question at the end of the current step has that choice. It may not have been asked yet.
  bool has_choice(std::size_t choice) const;
  bool shows_object() const;  ///< the object is visible, not only its marker
  bool shows_marker() const;
  /// Why it is paused or stopped, or why the last touch is void, for the experimenter.
  const std::string& reason() const { return reason_; }
  const Agenda& agenda() const { return agenda_; }
  const PlanBlock& block() const;  ///< of the current step; there must be one

  /// If the clock stood still for longer during a touch, the touch took longer than planned, and is void.
  static constexpr std::int64_t longest_gap_ns = 1'000'000'000;

 private:
  void record(const Entry& entry);
  void act_here(Act act, std::int64_t now_ns);
  void turn_shape(Act act, std::int64_t now_ns);
  void take_consent(Act act, std::int64_t now_ns);
  void ask_or_go_on();
  void next_step();
  void end();
  void begin_step(std::int64_t now_ns);
  void begin_touch(std::int64_t now_ns);
  void end_touch(std::int64_t now_ns);
  void complete(Entry entry);
  void break_off(std::string why, bool by_machine, std::int64_t now_ns);
  void pause(const std::string& why, bool by_machine, std::int64_t now_ns);
  void count_deep(std::int64_t now_ns);
  std::int64_t forward(std::int64_t now_ns);
  const Step& step() const { return agenda_.step(*agenda_.current()); }
  std::string right_answer() const;
  std::string answer_word(std::size_t choice) const;
  bool asks_now() const;
  std::vector<std::string> coming_choices() const;

  const StudyPlan& plan_;
  Agenda agenda_;
  std::function<void(const Entry&)> write_;
  Screen screen_ = Screen::setup;
  std::string reason_;
  std::int64_t now_ns_ = 0, until_ns_ = 0, deep_since_ns_ = 0, gap_ns_ = 0;
  double deep_s_ = 0;
  bool sounding_ = false;  ///< a touch is under way
  bool deep_ = false;
  bool was_right_ = false;
  std::uint32_t chosen_ = 0;  ///< shape of the free exploration
  std::optional<Stimulus> stimulus_{};
};

}  // namespace palpa::study
