#include "session/skin_preview.hpp"

#include <exception>
#include <glm/matrix.hpp>
#include <utility>

#include "acoustics/incident.hpp"
#include "base/error.hpp"
#include "base/parallel.hpp"
#include "session/give_way.hpp"
#include "session/skin_pressure.hpp"

namespace palpa::session {

SkinAnswer answer(const SkinQuestion& question, acoustics::BodyCache& bodies, const std::atomic<bool>* give_up) {
  SkinAnswer answer;
  answer.faces.langevin.assign(question.finger.triangles.size(), 0);
  answer.faces.squared = answer.faces.langevin;
  if (question.plan.schedule.voice_count > 0 && !question.layout.transducers.empty()) {
    if (question.plan.drives.size() != question.plan.cycle * question.layout.transducers.size())
      throw failure("the plan is of another array than the one whose sound is asked for");
    const auto body = bodies.of(question.finger, question.air.wave_number(), give_up);
    const array::Layout layout = array::transformed(question.layout, glm::inverse(question.T_world_finger));
    const acoustics::Incident incident(layout, question.air, question.drive.directivity);
    const Sounds sounds = sounds_of(question.plan, question.layout, question.drive);
    answer.faces = mean_pressure(sounds, incident, question.air, *body, give_up);
  }
  answer.vertices = acoustics::at_vertices(question.finger, answer.faces.langevin);
  return answer;
}

SkinPreview::SkinPreview() : thread_([this] { work(); }) {}

SkinPreview::~SkinPreview() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

std::uint64_t SkinPreview::ask(SkinQuestion question) {
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(question);
    number = ++asked_;
  }
  wake_.notify_one();
  return number;
}

std::shared_ptr<const SkinAnswer> SkinPreview::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

bool SkinPreview::stale() const {
  const std::lock_guard lock(mutex_);
  return newest_->number != asked_;
}

void SkinPreview::work() {
  take_no_signals();
  give_way();
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return ends_ || waiting_; });
    if (ends_) return;
    const SkinQuestion question = std::move(*waiting_);
    waiting_.reset();
    const std::uint64_t number = asked_;
    lock.unlock();
    auto next = std::make_shared<SkinAnswer>();
    try {
      *next = answer(question, bodies_, &ends_);
    } catch (const GivenUp&) {
      return;
    } catch (const std::exception& error) {
      next->fault = error.what();
    }
    next->number = number;
    lock.lock();
    newest_ = std::move(next);
  }
}

}  // namespace palpa::session
