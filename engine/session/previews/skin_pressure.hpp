// The effect of a plan on rigid skin: the radiation pressure of its drives, averaged over time.
#pragma once

#include <atomic>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/far_force.hpp"
#include "acoustics/bodies/radiation.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/field/incident.hpp"
#include "session/plan/plan.hpp"
#include "session/plan/setting.hpp"

namespace palpa::session {

/// The drives of a plan's cycle, in order. The weight of a drive is the part of the time that it sounds, times the mean
/// square of the shared modulation and course.
struct Sounds {
  acoustics::Strengths strengths;
  std::vector<double> weights;
};

/// Each slot of the cycle, so that foci are weighted by their dwell and modulation. If a plan's drives are not listed,
/// most_cycle slots are used: the first ones, or if gains change, those from their first slot on. `plan` must have at
/// least one voice and be made for this layout with these options.
Sounds sounds_of(const Plan& plan, const array::Layout& layout, const array::DriveOptions& drive);
inline Sounds sounds_of(const Plan& plan, const SessionSetting& setting) {
  return sounds_of(plan, setting.layout, setting.drive);
}

/// The time average over these sounds at the faces of `body`, which is in the world, like the incident's array. Throws
/// GivenUp (base/system/parallel.hpp) soon after `give_up` became true.
acoustics::SkinPressure mean_pressure(const Sounds& sounds, const acoustics::Incident& incident,
                                      const acoustics::Air& air, const acoustics::RigidBody& body,
                                      const std::atomic<bool>* give_up = nullptr);

/// The force from the momentum in the air (acoustics/bodies/far_force.hpp).
struct FarSound {
  const acoustics::FarForce& force;
  const acoustics::Incident& lossless;  ///< the same array in air without absorption
  Vec3 mean{0};                         ///< the time average, N: output
  double took_ms = 0;                   ///< output
};
/// The same, which also fills `far`.
acoustics::SkinPressure mean_pressure(const Sounds& sounds, const acoustics::Incident& incident,
                                      const acoustics::Air& air, const acoustics::RigidBody& body, FarSound* far,
                                      const std::atomic<bool>* give_up = nullptr);

/// The elongation (length over width) of the spot of the same sounds without any body. The spot is the region where the
/// time average of |p|^2 is above half of its largest value, in the horizontal plane through `centre`, within 15 mm.
double bare_elongation(const Sounds& sounds, const acoustics::Incident& incident, const Vec3& centre);

}  // namespace palpa::session
