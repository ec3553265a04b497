// The result of `palpa simulate`: the radiation pressure on a finger that touches a scene, and its output.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acoustics/bodies/radiation.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/felt/spectrum.hpp"
#include "array/drive_options.hpp"
#include "base/files/json_rows.hpp"
#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"
#include "session/plan/scheduler.hpp"
#include "setup/sessions/touch_run.hpp"
#include "setup/tasks/simulate_spread.hpp"
#include "touch/methods/method.hpp"

namespace palpa::setup {

/// Metres in the world, Pa, N and Nm; pressures are time averages over the schedule.
struct SimulateResult {
  touch::Method method{};
  double penetration_m = 0;
  double top_m = 0;                       ///< y of the solids' highest point
  geometry::Mesh body;                    ///< the finger in its place
  Vec3 tip{0};                            ///< the origin of its file in that place
  std::vector<std::optional<Vec3>> foci;  ///< empty for an empty sector
  std::vector<Vec3> aimed;                ///< with --transfer finger: where the non-empty foci sound, on the skin
  acoustics::SkinPressure pressure;       ///< by face of the body
  acoustics::Spot langevin, squared;      ///< spots of both pressures
  acoustics::Load load;                   ///< load of the radiation pressure, about the tip
  acoustics::RigidBody::Effort effort;    ///< how the equations were solved
  std::optional<Vec3> far_force;          ///< the force by momentum in the air (acoustics/bodies/far_force.hpp)
  /// If requested: the elongation of the same sound's spot without the finger.
  std::optional<double> bare_elongation;
  std::optional<SimulateSpread> spread;  ///< with --spread
  array::DrivenBy by;                    ///< how drives are computed
  /// With --spectrum or --tune: one for each touching patch of skin.
  std::vector<session::ScheduledFinger> fingers;
  std::vector<std::string> touched;          ///< the solid of each of `fingers`
  std::vector<acoustics::Spectrum> spectra;  ///< with --spectrum: one for each of `fingers`
  std::optional<std::string> unreached;      ///< a sentence about a requested pressure that is not reached
  StepTimes times;

  /// Whether linear acoustics overstates the result (array::linear_pressure_pa).
  bool beyond_linear() const;
};

/// The members of that result's JSON, in their order.
const JsonRows<SimulateResult>& simulate_rows();
/// The output of `palpa simulate --json` (docs/acoustics.md). Only `timing_ms` differs between runs.
std::string to_json(const SimulateResult& result);
/// face,x,y,z,area,langevin,squared for every face of the body: its index, centroid in m, area in m2, pressures in Pa.
std::string to_csv(const SimulateResult& result);
/// The body and both pressures for ParaView. Throws failure() naming the file.
void write_vtu(const std::string& file, const SimulateResult& result);

}  // namespace palpa::setup
