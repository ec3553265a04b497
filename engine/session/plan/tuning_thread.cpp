#include "session/plan/tuning_thread.hpp"

#include <algorithm>
#include <chrono>

#include "acoustics/field/asked_field.hpp"
#include "base/system/start_thread.hpp"
#include "session/threads.hpp"
#include "touch/types.hpp"

namespace palpa::session {

TuningThread::TuningThread(const acoustics::ArrayField& field) : field_(field) {
  questions_.each([](Question& question) {
    question.rings.resize(touch::max_fingers);
    for (Ring& ring : question.rings)
      ring.foci.reserve(touch::max_foci);
  });
  answers_.each([](Answers& answers) { answers.reserve(touch::max_fingers); });
  thread_ = start_thread("--tune", [this] { work(); });
}

TuningThread::~TuningThread() {
  ends_ = true;
  questions_.close();
  thread_.join();
}

void TuningThread::begin(acoustics::StrideTuner& strides) {
  if (asked_ && answers_.take()) {
    for (const Answer& answer : answers_.front())
      strides.learn(answer.id, answer.harmonics, answer.time_s);
    known_ += answers_.front().size();
    asked_ = false;
  }
  if (!asked_) questions_.back().count = 0;
}

void TuningThread::look_at(std::uint32_t id, std::span<const Vec3> foci, bool asks, double time_s,
                           const acoustics::StrideTuner& strides) {
  Question& question = questions_.back();
  if (asked_ || question.count == question.rings.size() || !strides.wants(id, time_s)) return;
  Ring& ring = question.rings[question.count++];
  ring.id = id;
  ring.time_s = time_s;
  ring.asks = asks;
  ring.foci.assign(foci.begin(), foci.end());
}

void TuningThread::end() {
  if (asked_ || questions_.back().count == 0) return;
  questions_.publish();
  asked_ = true;
}

void TuningThread::work() {
  take_no_signals();
  give_way();
  const acoustics::AskedField asked(field_);
  const acoustics::FocusField& field = field_;
  try {
    while (!ends_) {
      if (!questions_.take(std::chrono::hours(1))) continue;
      const Question& question = questions_.front();
      Answers& answers = answers_.back();
      answers.clear();
      for (std::size_t i = 0; i < question.count && !ends_; ++i) {
        const Ring& ring = question.rings[i];
        const acoustics::PathField path(ring.asks ? asked : field, ring.foci, &ends_);
        answers.push_back({ring.id, ring.time_s, path.harmonics(static_cast<std::uint32_t>(ring.foci.size()))});
      }
      answers_.publish();
    }
  } catch (const std::exception&) {  // no memory: strides stay as they are, and sound continues
  }
}

}  // namespace palpa::session
