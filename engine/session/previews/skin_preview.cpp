#include "session/previews/skin_preview.hpp"

#include <glm/matrix.hpp>
#include <utility>

#include "acoustics/bodies/body_mesh.hpp"
#include "acoustics/field/incident.hpp"
#include "base/error.hpp"
#include "session/previews/skin_pressure.hpp"

namespace palpa::session {

SkinAnswer answer(const SkinQuestion& question, acoustics::BodyCache& bodies, const std::atomic<bool>* give_up) {
  SkinAnswer answer;
  answer.faces.langevin.assign(question.finger.triangles.size(), 0);
  answer.faces.squared = answer.faces.langevin;
  if (question.plan.schedule.voice_count > 0 && !question.layout.transducers.empty()) {
    if (question.plan.drives.size() != question.plan.listed() * question.layout.transducers.size())
      throw failure("the plan belongs to another array than the one whose sound is computed");
    const array::Layout layout = array::transformed(question.layout, glm::inverse(question.T_world_finger));
    acoustics::check_clear_of(question.name, question.finger, layout);
    const auto body = bodies.of(question.finger, question.air.wave_number(), give_up);
    const acoustics::Incident incident(layout, question.air, question.drive.directivity);
    const Sounds sounds = sounds_of(question.plan, question.layout, question.drive);
    answer.faces = mean_pressure(sounds, incident, question.air, *body, give_up);
  }
  answer.vertices = acoustics::at_vertices(question.finger, answer.faces.langevin);
  return answer;
}

SkinPreview::SkinPreview(Work work)
    : answers_([this, work = std::move(work)](const SkinQuestion& question, const std::atomic<bool>& give_up) {
        return work(question, bodies_, &give_up);
      }) {}

}  // namespace palpa::session
