// The computation of `palpa scatter`: the sound of a wave around a rigid body and on its skin, and its force on the
// body. It uses boundary elements (acoustics/bodies/rigid_body.hpp). Lengths are in metres; with an array's drive,
// everything is in its layout's own frame. Pressures are in Pa, complex and peak, with the time factor e^-iwt. Force
// and torque are those of the radiation pressure (acoustics/bodies/radiation.hpp).
#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/radiation.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "array/field/directivity.hpp"
#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"
#include "geometry/mesh/mesh.hpp"
#include "setup/options/options.hpp"
#include "setup/options/places.hpp"
#include "setup/sessions/touch_run.hpp"

namespace palpa::setup {

/// The body and the sound, as names and files, as on the command line.
struct ScatterTask {
  std::string mesh;          ///< file of the rigid body, a closed mesh
  bool force = false;        ///< allow a mesh that is too coarse for the wavelength or for the source
  std::string plane_wave;    ///< "x,y,z", its direction of travel: 1 Pa, phase 0 at the origin;
  std::string point_source;  ///< or "x,y,z", its position: e^{ikr} / r Pa;
  std::string layout;        ///< or an array, a built-in name or a file,
  std::string drive_file;    ///< and its drive, in the format of drive_csv (drive_file.hpp)
  std::optional<array::Directivity> directivity;  ///< of that array, default t4010a1
  PlaceOptions place;                             ///< additional places for the total pressure; default none
  MediumOptions medium;
  AirOptions air{.absorption = false};
};
/// Throws bad_usage, naming the command's options, if some are missing or exclude each other.
void check(const ScatterTask& task);

/// A wave of 1 Pa, phase 0 at the origin, that travels along `direction`, of any length above 0.
struct PlaneWave {
  Vec3 direction{0};
};
/// e^{ikr} / r Pa at the distance of r metres.
struct PointSource {
  Vec3 position{0};
};
/// An array's drive, one entry per transducer.
struct ArraySound {
  array::Layout layout;
  array::Drive drive;
  array::Directivity directivity = array::Directivity::t4010a1;
};
using IncidentSound = std::variant<PlaneWave, PointSource, ArraySound>;

struct ScatterResult {
  geometry::Mesh body;                       ///< welded and facing outwards; its triangles are in the order given
  std::vector<acoustics::FaceSound> faces;   ///< total sound at each face's centroid
  std::vector<Vec3> points;                  ///< additional places for the total pressure,
  std::vector<std::complex<double>> totals;  ///< and its values; not a number inside the body
  acoustics::Load load;                      ///< N, and Nm about the frame's origin
  acoustics::RigidBody::Effort effort;       ///< how the equations were solved
  std::optional<Vec3> far_force;             ///< the force by momentum in the air, N (acoustics/bodies/far_force.hpp)
  double loudest_pa = 0;                     ///< largest |p| of any face
  acoustics::Air air;
  bool from_array = false;  ///< the sound is an array's, so its pressures are absolute
  StepTimes times;          ///< operator, incident, solution, pressure, far_force and, with points, places

  /// Whether an array's sound has more pressure on the body than linear acoustics holds for
  /// (array::linear_pressure_pa).
  bool beyond_linear() const;
};
/// The output of `palpa scatter --json` (docs/acoustics.md).
std::string to_json(const ScatterResult& result);

/// The sound around a closed mesh, which messages call `name`. Throws as body_of (setup/files/body.hpp),
/// acoustics::check_source and acoustics::check_clear_of do, which get `force`. Throws bad_usage for a direction
/// without length, for a drive with another number of transducers, for points that are not numbers or farther than 100
/// m away, and for a plane wave or a point source in absorbing air.
ScatterResult scatter(const std::string& name, const geometry::Mesh& mesh, const IncidentSound& sound,
                      const acoustics::Air& air, std::vector<Vec3> points = {}, bool force = false);

/// The same from files. `all_read` is called after all input is read and before the long computation begins. Also
/// throws as check, load_body, array::load_layout, load_drive and load_places do.
ScatterResult scatter(const ScatterTask& task, const std::function<void()>& all_read = {});

}  // namespace palpa::setup
