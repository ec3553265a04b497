// What `palpa simulate` computes: a rigid finger is pressed into a scene, the array focuses on its skin as it does
// live, and linear sound, scattered by the finger, presses on it (acoustics/bodies/radiation.hpp has the equations).
// What it finds is simulate_result.hpp's.
//
//   setup::SimulateOptions options{.penetration_m = 2e-3};
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
#include "geometry/mesh/mesh.hpp"
#include "geometry/solid.hpp"
#include "setup/options.hpp"
#include "setup/tasks/simulate_result.hpp"

namespace palpa::setup {

/// What the skin points of the touch are: the finger's vertices, or what the rig's cameras see of it.
enum class Skin { vertices, cameras };

/// Of SimulateOptions::penetration_m, either way.
inline constexpr double most_penetration_m = 10;

/// The defaults are the command line's.
struct SimulateOptions {
  ComputeOptions compute;       ///< its seed is that of the cameras' noise
  double penetration_m = 3e-3;  ///< how far below the solids' top the finger's lowest point is
  Skin skin = Skin::vertices;
  bool noise_free = false;       ///< cameras without the sensor's noise
  bool bare_elongation = false;  ///< asks for SimulateResult::bare_elongation
  TouchOptions touch;
  FeltOptions in_time;
  RigOptions rig;  ///< its array sounds
  DriveOptionsGroup drive;
  AirOptions air;
};
/// Throws bad_usage where the options do not go together, and warns of what is unusual.
void check(const SimulateOptions& options);

/// A finger's mesh, and what it does to sound where it stands. For one thread at a time.
class FingerBody {
 public:
  /// The triangles of `file`, tip at the origin, body along +y, metres. Throws as load_body does.
  FingerBody(const std::string& file, const acoustics::Air& air, bool force = false);
  /// The same of a mesh; `name` stands for its file in messages. `force`: it may be too coarse for the wavelength.
  FingerBody(std::string name, geometry::Mesh mesh, const acoustics::Air& air, bool force = false);

  const std::string& name() const { return name_; }
  const geometry::Mesh& as_given() const { return given_; }
  const geometry::Mesh& body() const { return body_; }  ///< as_given() welded
  /// The body, moved along y by that. Kept until another place is asked for.
  std::shared_ptr<const acoustics::RigidBody> standing(double dy);

 private:
  std::string name_;
  geometry::Mesh given_, body_;
  double wave_number_;
  acoustics::BodyCache standing_;
};

/// The finger, moved along y until it is `penetration_m` into these solids, of which `scene` is the file. `options`
/// have passed check(), and the finger was made for their air. A finger that stays where it was costs its equations
/// only once. Throws bad_input, naming `scene`, where nothing is touched, and where the finger stands in the array;
/// else as load_posed_rig, drive_options and touch_once do. Warns of what is unusual.
SimulateResult simulate(const SimulateOptions& options, FingerBody& finger, const std::string& scene,
                        std::vector<geometry::Solid> solids);

}  // namespace palpa::setup
