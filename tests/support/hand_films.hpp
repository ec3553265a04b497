// Films of hands and fingers on a plate in front of the paper's cameras. Where the true skin is, is known.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"
#include "sensing/depth_source.hpp"

namespace palpa::test {

/// The noise of a film's pictures.
enum class FilmNoise {
  none,
  half,  ///< half of a D415's noise; rims have no faults
  full,  ///< a D415's noise, holes and flying pixels
};

/// A hand or fingers that press from above into a plate. The plate's top is y = 0.
struct HandScene {
  std::string name;
  double plate_m = 35e-3;  ///< thickness of the plate
  /// A shape of skin. It stands where its pose puts it until a motion moves it.
  struct Skin {
    const geometry::Mesh* mesh = nullptr;
    Transform T_world_mesh{1.0};
    std::vector<std::uint32_t> digit;  ///< per vertex of the mesh: the digit of the scene that it belongs to
  };
  std::vector<Skin> skin;
  std::uint32_t digits = 0;  ///< fingers, and the palm of each hand
};

/// `count` fingers side by side, `thickness_m` thick, that touch each other. They press `press_m` deep and lean by
/// `tilt_deg` from the vertical; at 90 degrees, they lie flat.
HandScene fingers_scene(int count, double thickness_m, double press_m, double tilt_deg, double plate_m = 35e-3);
/// A hand in a pose of assets::named_hand_pose. It leans by `tilt_deg` from the vertical towards its palm, and comes
/// from +z, turned by `turn_deg` about the vertical.
HandScene hand_scene(const std::string& pose, double press_m, double tilt_deg, double plate_m = 35e-3,
                     double turn_deg = 0);

/// How far each shape of skin is from where it stands, at a time.
using SkinMotion = std::function<Vec3(std::size_t skin, double time_s)>;

struct HandFilm {
  HandScene scene;
  std::vector<sensing::Camera> cameras;
  std::vector<sensing::FrameSet> frames;
  std::vector<std::vector<Vec3>> moved;  ///< per frame and skin

  /// The true skin in a frame: the corner of the skin's triangles that is nearest to `place`.
  struct Truth {
    std::uint32_t digit = 0;
    double apart_m = 0;
  };
  Truth nearest(const Vec3& place, std::size_t frame) const;
  /// For each digit, the least distance of the place from its skin.
  std::vector<double> apart(const Vec3& place, std::size_t frame) const;
};

struct FilmSetting {
  int cameras = 3;  ///< of the paper's rig
  std::size_t frames = 30;
  double rate_hz = 90;
  FilmNoise noise = FilmNoise::half;
  std::uint64_t seed = 1;
  SkinMotion motion = {};  ///< none: nothing moves
};
HandFilm make_film(const HandScene& scene, const FilmSetting& setting);

}  // namespace palpa::test
