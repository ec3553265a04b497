// What is still to be done in a sitting. A function of the participant's order and of the entries of the journal: it
// knows no files and no clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/files/journal.hpp"
#include "study/plan/order.hpp"

namespace palpa::study {

/// The participant's answers to the consent pages.
struct Consent {
  bool accepted = false, depth_frames = false;
};

class Agenda {
 public:
  explicit Agenda(std::vector<Step> steps);

  /// Takes the next entry. A step that was begun and is interrupted, by another start or by a `broken` entry, is void:
  /// it moves to the end of its round. After the last of its repeats (most_repeats), it stays void, and the next step
  /// follows. Returns what is wrong if the entry cannot follow the entries before; empty if it
  /// can.
  std::string take(const Entry& entry);

  /// The index of the step that is under way or comes next; nothing if all are complete, the participant declined, or
  /// the sitting is finished.
  std::optional<std::uint32_t> current() const;
  const Step& step(std::uint32_t index) const { return steps_[index]; }
  const std::vector<Step>& steps() const { return steps_; }
  bool open() const { return open_; }          ///< whether the current step was begun
  bool finished() const { return finished_; }  ///< nothing can follow any more
  std::size_t complete() const { return complete_; }
  std::size_t voided() const { return voided_; }
  /// The steps that stay void, in the order in which they were given up.
  const std::vector<std::uint32_t>& stay_void() const { return stay_void_; }
  /// Whether the current step stays void if it is broken off by a machine once more.
  bool last_repeat() const { return !left_.empty() && by_machine_[left_.front()] == most_repeats; }
  std::uint32_t starts() const { return starts_; }
  const std::optional<Consent>& consent() const { return consent_; }

 private:
  void put_back();

  std::vector<Step> steps_;
  std::deque<std::uint32_t> left_;
  std::vector<std::uint32_t> by_machine_;  ///< how often each step was broken off by a machine
  std::vector<std::uint32_t> stay_void_;
  std::optional<Consent> consent_;
  bool open_ = false, finished_ = false;
  std::size_t complete_ = 0, voided_ = 0;
  std::uint32_t starts_ = 0;
};

/// The agenda after all entries. Throws bad_input naming the line of an entry that cannot follow those before it: the
/// journal is of another plan or was edited. `name` is for messages.
Agenda agenda_after(std::vector<Step> steps, std::span<const Entry> entries, const std::string& name);

/// How far a participant is, as JSON.
std::string to_json(const Agenda& agenda, std::uint32_t participant);

}  // namespace palpa::study
