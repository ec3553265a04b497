// What `palpa simulate` finds: the radiation pressure on a finger that touches a scene, and how it is written.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acoustics/bodies/radiation.hpp"
#include "acoustics/felt/spectrum.hpp"
#include "base/json_writer.hpp"
#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"
#include "session/plan/scheduler.hpp"
#include "setup/touch_run.hpp"
#include "touch/foci/method.hpp"

namespace palpa::setup {

/// Metres in the world, Pa, N and Nm; pressures are time averages over the schedule.
struct SimulateResult {
  touch::Method method{};
  double penetration_m = 0;
  double top_m = 0;                       ///< y of the solids' highest point
  geometry::Mesh body;                    ///< the finger where it stands
  Vec3 tip{0};                            ///< where the origin of its file is then
  std::vector<std::optional<Vec3>> foci;  ///< nothing for an empty sector
  std::vector<Vec3> aimed;                ///< with --transfer finger: where those that are there sound, on the skin
  acoustics::SkinPressure pressure;       ///< by face of the body
  acoustics::Spot langevin, squared;      ///< of either
  acoustics::Load load;                   ///< of the radiation pressure, about the tip
  /// Where it was asked for: the elongation of the same sound's spot without the finger in it.
  std::optional<double> bare_elongation;
  /// With --spectrum or --tune: one for each patch of skin that touches.
  std::vector<session::ScheduledFinger> fingers;
  std::vector<std::string> touched;          ///< the solid of each of these
  std::vector<acoustics::Spectrum> spectra;  ///< with --spectrum: of each
  std::optional<std::string> unreached;      ///< a sentence about a pressure that was asked for and is not reached
  StepTimes times;

  /// Whether linear acoustics overstates what is felt and heard: array::linear_pressure_pa.
  bool beyond_linear() const;
};

/// As `palpa simulate --json` writes it (docs/files.md). Only `timing_ms` differs between runs.
std::string to_json(const SimulateResult& result);
/// The members of that object alone.
void add_members(JsonWriter& json, const SimulateResult& result);
/// face,x,y,z,area,langevin,squared of every face of the body: its centroid, m2, Pa.
std::string to_csv(const SimulateResult& result);
/// The body and both pressures for ParaView. Throws failure() naming the file.
void write_vtu(const std::string& file, const SimulateResult& result);

}  // namespace palpa::setup
