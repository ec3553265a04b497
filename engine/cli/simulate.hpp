// One touch as rigid skin has it, and the paper's figure of several: what both share.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_cache.hpp"
#include "acoustics/bodies/radiation.hpp"
#include "acoustics/felt/spectrum.hpp"
#include "array/schedule.hpp"
#include "base/json_writer.hpp"
#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"
#include "geometry/solid.hpp"
#include "session/plan/scheduler.hpp"
#include "setup/options.hpp"
#include "setup/touch_run.hpp"
#include "touch/foci/method.hpp"

namespace palpa::cli {

/// What the skin points of the touch are: the finger's vertices, or what the rig's cameras see of it.
enum class Skin { vertices, cameras };

struct SimulateCommand {
  setup::CommonOptions common;
  std::string scene, finger;
  Skin skin = Skin::vertices;
  bool noise_free = false;
  std::optional<std::uint32_t> gltf_scene;
  bool figure6 = false;
  double penetration_m = 3e-3;
  bool force = false;
  std::string csv, vtu, png;
  setup::SolidOptions solids;
  setup::TouchOptions touch;
  setup::FeltOptions in_time;
  setup::RigOptions rig;
  setup::DriveOptionsGroup drive;
  setup::AirOptions air;
};

/// A finger's mesh, and what it does to sound where it stands.
class Finger {
 public:
  /// Throws as setup::load_body does.
  Finger(const SimulateCommand& o, const acoustics::Air& air);

  const geometry::Mesh& as_given() const { return given_; }
  const geometry::Mesh& body() const { return body_; }  ///< as_given() welded
  /// The body, moved along y by that. Kept until another place is asked for.
  std::shared_ptr<const acoustics::RigidBody> standing(double dy);

 private:
  geometry::Mesh given_, body_;
  double wave_number_;
  acoustics::BodyCache standing_;
};

struct Felt {
  touch::Method method{};
  geometry::Mesh body;  ///< in the world
  Vec3 tip{0};
  std::vector<std::optional<Vec3>> foci;  ///< none for an empty sector
  std::vector<Vec3> aimed;                ///< with --transfer finger: where those that are there sound, on the skin
  acoustics::SkinPressure pressure;
  acoustics::Spot langevin, squared;
  acoustics::Load load;  ///< about the tip
  double bare_elongation = 1;
  std::vector<session::ScheduledFinger> fingers;  ///< that touch, one for each patch of skin in the shell
  std::vector<std::string> touched;               ///< the solid of each
  std::vector<acoustics::Spectrum> spectra;       ///< with --spectrum of each
  std::optional<std::string> unreached;           ///< what is not reached of the pressures that are asked for
  setup::StageTimes times;

  /// What is felt would be less, and so would what is heard.
  bool beyond_linear() const { return pressure.loudest_pa > array::linear_pressure_pa; }
};

/// The finger, `o.penetration_m` into these solids, of which `scene` is the file, by this method. `fault` names what is
/// touched where nothing is.
Felt feel(const SimulateCommand& o, Finger& finger, const std::string& scene, std::vector<geometry::Solid> solids,
          touch::Method method);

/// The members of a touch's object.
void add_felt(JsonWriter& json, const SimulateCommand& o, const Felt& felt);

/// The paper's objects, one after the other, by every method: table, --json, --png.
void run_figure6(const SimulateCommand& o);

}  // namespace palpa::cli
