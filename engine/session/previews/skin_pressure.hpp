// What a plan does to rigid skin: the radiation pressure of its drives, averaged over time.
#pragma once

#include <atomic>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/radiation.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/field/incident.hpp"
#include "session/links/plan.hpp"
#include "session/plan/setting.hpp"

namespace palpa::session {

/// The drives of a plan's cycle, one after the other, and the part of the time that each of them sounds, times the mean
/// square of the modulation that they share.
struct Sounds {
  acoustics::Strengths strengths;
  std::vector<double> weights;
};

/// Each slot of the cycle, so that foci count by their dwell and their modulation. A plan whose drives are not listed
/// is looked at for its first most_cycle slots. `plan` has at least one voice, and is of this layout, driven
/// by these options.
Sounds sounds_of(const Plan& plan, const array::Layout& layout, const array::DriveOptions& drive);
inline Sounds sounds_of(const Plan& plan, const SessionSetting& setting) {
  return sounds_of(plan, setting.layout, setting.drive);
}

/// The time average over these sounds at the faces of `body`, which stands in the world as the incident's array. Throws
/// GivenUp (base/parallel.hpp) soon after `give_up` became true.
acoustics::SkinPressure mean_pressure(const Sounds& sounds, const acoustics::Incident& incident,
                                      const acoustics::Air& air, const acoustics::RigidBody& body,
                                      const std::atomic<bool>* give_up = nullptr);

/// The same sounds without anything in their way: how much longer than wide is the place, in the horizontal plane
/// through `centre`, within 15 mm, where the time average of |p|^2 is above half of its largest.
double bare_elongation(const Sounds& sounds, const acoustics::Incident& incident, const Vec3& centre);

}  // namespace palpa::session
