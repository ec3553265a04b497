// A sitting without a person, an array or waiting: a scripted participant goes through a whole plan. It shows an
// experimenter whether the plan is right, and what its data will look like.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "study/plan/plan.hpp"
#include "study/sitting/agenda.hpp"
#include "study/sitting/sitting.hpp"

namespace palpa::study {

/// A participant who follows every instruction, and whose answers are drawn at random.
class ScriptedParticipant {
 public:
  /// `accuracy`: the share of right answers in trials and practice. Another `number` of the participant or another
  /// seed gives other answers.
  ScriptedParticipant(double accuracy, std::uint32_t number, std::uint64_t seed);

  /// Does the next thing that the screen asks for, at the earliest moment, and moves the time there.
  void go_on(const StudyPlan& plan, Sitting& sitting, std::int64_t& now_ns) const;
  /// The number of the choice that the participant makes on the screen question.
  std::size_t answer(const StudyPlan& plan, const Sitting& sitting) const;

 private:
  double accuracy_;
  std::uint64_t seed_;
};

/// Goes from `agenda` to the end of the sitting, or until `stop` becomes true. `write` gets each entry. Returns whether
/// the sitting has ended.
bool rehearse(const StudyPlan& plan, const Agenda& agenda, const Entry& start, const ScriptedParticipant& participant,
              const std::function<void(const Entry&)>& write, const std::atomic<bool>* stop = nullptr);

}  // namespace palpa::study
