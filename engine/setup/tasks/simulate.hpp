// The computation of `palpa simulate`: a rigid finger is pressed into a scene, and the array focuses on its skin as in
// a live run. The result is the radiation pressure of linear sound, scattered by the finger, on the finger
// (acoustics/bodies/radiation.hpp has the equations). simulate_result.hpp defines the result.
//
//   setup::SimulateTask options{.penetration_m = 2e-3};
//   setup::check(options);
//   setup::FingerBody finger("finger.ply", setup::air(options.drive.medium, options.air));
//   setup::SimulateResult result = setup::simulate(options, finger, "cube.glb", setup::load_solids("cube.glb"));
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_cache.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "base/words.hpp"
#include "geometry/mesh/mesh.hpp"
#include "geometry/solid.hpp"
#include "setup/options/options.hpp"
#include "setup/options/spread.hpp"
#include "setup/tasks/simulate_result.hpp"

namespace palpa::setup {

/// The skin points of the touch: the finger's vertices, or the points that the rig's cameras see.
enum class Skin { vertices, cameras };
inline constexpr Word<Skin> skin_words[] = {{"vertices", Skin::vertices}, {"cameras", Skin::cameras}};

/// Limit of SimulateTask::penetration_m, in both directions.
inline constexpr double most_penetration_m = 10;

/// The defaults are the command line's.
struct SimulateTask {
  ComputeOptions compute;       ///< its seed is used for the cameras' noise and for random arrays
  double penetration_m = 3e-3;  ///< depth of the finger's lowest point below the solids' top
  Skin skin = Skin::vertices;
  bool noise_free = false;       ///< cameras without the sensor's noise
  bool bare_elongation = false;  ///< requests SimulateResult::bare_elongation
  TouchOptions touch;
  FeltOptions in_time;
  RigOptions rig;  ///< gives the array
  FocusingOptions drive;
  AirOptions air;
  SpreadOptions spread;
};
/// Adds the options that it has, except for those of the finger and its skin.
void add_task_options(CLI::App& app, SimulateTask& options);
/// Throws bad_usage if the options do not fit together; warns of unusual values.
void check(const SimulateTask& options);

/// A finger's mesh, and its scattering at its current place. For one thread at a time.
class FingerBody {
 public:
  /// The triangles of `file`, tip at the origin, body along +y, metres. Throws as load_body does.
  FingerBody(const std::string& file, const acoustics::Air& air, bool force = false);
  /// The same for a mesh; messages call it `name`. `force`: it may be too coarse for the wavelength.
  FingerBody(std::string name, geometry::Mesh mesh, const acoustics::Air& air, bool force = false);

  const std::string& name() const { return name_; }
  const geometry::Mesh& as_given() const { return given_; }
  const geometry::Mesh& body() const { return body_; }  ///< as_given() welded
  /// The body, moved along y by `dy`. Kept until another place is requested.
  std::shared_ptr<const acoustics::RigidBody> standing(double dy);

 private:
  std::string name_;
  geometry::Mesh given_, body_;
  double wave_number_;
  acoustics::BodyCache standing_;
};

/// Simulates the finger, moved along y until it is `penetration_m` deep in these solids, whose file is `scene`.
/// `options` must have passed check(), and the finger must be made for their air. The equations are reused while the
/// finger stays in the same place. Throws bad_input, naming `scene`, if nothing is touched and if the finger intersects
/// the array; otherwise as load_posed_rig, drive_options and touch_once do. Warns of unusual values.
SimulateResult simulate(const SimulateTask& options, FingerBody& finger, const std::string& scene,
                        std::vector<geometry::Solid> solids);

}  // namespace palpa::setup
