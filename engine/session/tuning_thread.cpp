#include "session/tuning_thread.hpp"

#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>

#include "touch/types.hpp"

namespace palpa::session {
namespace {

/// Makes the calling thread give way to all others: no real-time policy, which it has from who started it, and nicer by
/// ten. What is refused stays as it is.
void give_way() {
  const sched_param none{};
  // Who runs when nobody else wants to is to stay so.
  const bool idle = sched_getscheduler(0) == SCHED_IDLE;
  if (!idle && sched_setscheduler(0, SCHED_BATCH, &none) != 0) sched_setscheduler(0, SCHED_IDLE, &none);
  // Process 0 is the calling thread alone. -1 is a niceness, too.
  errno = 0;
  const int nice = getpriority(PRIO_PROCESS, 0);
  if (errno == 0) setpriority(PRIO_PROCESS, 0, std::min(nice + 10, 19));
}

}  // namespace

TuningThread::TuningThread(const acoustics::ArrayField& field) : field_(field) {
  questions_.each([](Question& question) {
    question.rings.resize(touch::max_fingers);
    for (Ring& ring : question.rings)
      ring.foci.reserve(touch::max_foci);
  });
  answers_.each([](Answers& answers) { answers.reserve(touch::max_fingers); });
  thread_ = std::thread([this] { work(); });
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

void TuningThread::look_at(std::uint32_t id, std::span<const Vec3> foci, double time_s,
                           const acoustics::StrideTuner& strides) {
  Question& question = questions_.back();
  if (asked_ || question.count == question.rings.size() || !strides.wants(id, time_s)) return;
  Ring& ring = question.rings[question.count++];
  ring.id = id;
  ring.time_s = time_s;
  ring.foci.assign(foci.begin(), foci.end());
}

void TuningThread::end() {
  if (asked_ || questions_.back().count == 0) return;
  questions_.publish();
  asked_ = true;
}

void TuningThread::work() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, nullptr);
  give_way();
  try {
    while (!ends_) {
      if (!questions_.take(std::chrono::hours(1))) continue;
      const Question& question = questions_.front();
      Answers& answers = answers_.back();
      answers.clear();
      for (std::size_t i = 0; i < question.count && !ends_; ++i) {
        const Ring& ring = question.rings[i];
        const acoustics::PathField path(field_, ring.foci, &ends_);
        answers.push_back({ring.id, ring.time_s, path.harmonics(static_cast<std::uint32_t>(ring.foci.size()))});
      }
      answers_.publish();
    }
  } catch (const std::exception&) {  // no memory: strides stay as they are, and what sounds goes on
  }
}

}  // namespace palpa::session
