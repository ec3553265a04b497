#include "study/sitting/rehearsal.hpp"

#include <algorithm>

#include "base/random.hpp"

namespace palpa::study {

ScriptedParticipant::ScriptedParticipant(double accuracy, std::uint32_t number, std::uint64_t seed)
    : accuracy_(accuracy), seed_(Random(seed ^ number * 0xbf58476d1ce4e5b9u).next()) {}

/// A function of the step, not of what was drawn before: a sitting that was interrupted has the same answers.
std::size_t ScriptedParticipant::answer(const StudyPlan& plan, const Sitting& sitting) const {
  const std::uint32_t index = *sitting.agenda().current();
  const Step& step = sitting.agenda().step(index);
  Random random(Random(seed_ ^ (std::uint64_t{index} + 1) * 0x9e3779b97f4a7c15u).next());
  if (!asks(plan.blocks[step.block].kind)) return 0;  // something was felt
  const std::size_t choices = sitting.choices().size(), shape = *step.shape;
  const bool right = random.uniform() < accuracy_;
  return right ? shape : (shape + 1 + random.below(choices - 1)) % choices;
}

void ScriptedParticipant::go_on(const StudyPlan& plan, Sitting& sitting, std::int64_t& now_ns) const {
  constexpr std::int64_t moment_ns = 100'000'000;  // before each key
  switch (sitting.screen()) {
    case Screen::setup:
    case Screen::ready:
    case Screen::feedback:
    case Screen::paused:
      sitting.act(Act::go_on, now_ns += moment_ns);
      break;
    case Screen::consent:
    case Screen::depth_consent:
      sitting.act(Act::accept, now_ns += moment_ns);
      break;
    case Screen::touching:
    case Screen::rest:
      // In steps, as a window would.
      sitting.advance(now_ns = std::min(*sitting.next_ns(), now_ns + Sitting::longest_gap_ns));
      break;
    case Screen::question: {
      now_ns += 10 * moment_ns;
      sitting.answer(answer(plan, sitting), now_ns);
      break;
    }
    case Screen::end:
    case Screen::stopped:
      break;
  }
}

bool rehearse(const StudyPlan& plan, const Agenda& agenda, const Entry& start, const ScriptedParticipant& participant,
              const std::function<void(const Entry&)>& write, const std::atomic<bool>* stop) {
  Sitting sitting(plan, agenda, start, write);
  std::int64_t now_ns = 0;
  while (sitting.screen() != Screen::end && sitting.screen() != Screen::stopped) {
    if (stop != nullptr && *stop) {
      sitting.act(Act::stop, now_ns);
      return false;
    }
    participant.go_on(plan, sitting, now_ns);
  }
  return sitting.screen() == Screen::end;
}

}  // namespace palpa::study
