// Fingers side by side, fingers that lie flat, and hands, pressed into a box in front of D415 cameras. Checks whether
// the fingers that are found are the real ones.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "geometry/solid.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/synthetic.hpp"
#include "touch/types.hpp"

namespace palpa::touch::test {

enum class SceneKind {
  pair,       ///< two fingertips that touch, 1 to 8 mm deep
  five,       ///< five in a slight arc, equally deep
  pair_deep,  ///< two fingers through the surface, 10 to 40 mm
  five_deep,
  hand_deep,  ///< assets/hand.glb, four fingers 25 to 45 mm through the surface
  single,     ///< one fingertip, upright or leaning
  flat,       ///< one finger that lies flat
  palm,       ///< assets/hand.glb flat on its palm
  rims,       ///< fingers in front of a wall, and between them a plate that neither touches: its contacts are flying
              ///< pixels
};
inline constexpr SceneKind all_scenes[] = {SceneKind::pair,      SceneKind::five,      SceneKind::pair_deep,
                                           SceneKind::five_deep, SceneKind::hand_deep, SceneKind::single,
                                           SceneKind::flat,      SceneKind::palm,      SceneKind::rims};
const char* name_of(SceneKind kind);

struct FingerScene {
  geometry::Solid solid;
  std::vector<sensing::Camera> cameras;
  std::vector<sensing::DepthFrame> images;
  FingerOptions parameters;
  std::vector<sensing::Posed> skin;
  /// Points on the skin of each finger, which tell which finger a contact belongs to.
  std::vector<std::vector<Vec3>> fingers;
};

/// In front of a ring of cameras at 0.4 to 0.6 m that look up at the box, with the D415's noise.
FingerScene random_scene(std::mt19937& random, SceneKind kind, int cameras);

struct Score {
  int fingers = 0;  ///< with at least min_points contacts
  int found = 0;
  int merged = 0;  ///< found fingers with contacts of several fingers, each at least a tenth of them
  int split = 0;   ///< fingers whose contacts are in several found fingers, each at least a tenth of them
  bool right() const { return merged == 0 && split == 0 && found == fingers; }
};
Score score_of(const FingerScene& scene, const Touch& touch);

}  // namespace palpa::touch::test
