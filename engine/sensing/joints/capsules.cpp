#include "sensing/joints/capsules.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace palpa::sensing {
namespace {

constexpr double pi = std::numbers::pi;
/// Points nearer to a capsule's surface than this are not inside it, in spite of rounding.
constexpr double rounding_m = 1e-9;

Box box_of(const Capsule& capsule) {
  Box box;
  for (const double sign : {-1.0, 1.0}) {
    box.add(capsule.a + Vec3(sign * capsule.radius_a_m));
    box.add(capsule.b + Vec3(sign * capsule.radius_b_m));
  }
  return box;
}

std::size_t steps_along(double length_m, std::size_t least) {
  return std::max(least, static_cast<std::size_t>(std::lround(length_m / skin_pitch_m)));
}

class Sampler {
 public:
  Sampler(std::span<const Capsule> capsules, const Box& box, std::vector<SkinPoint>& out)
      : capsules_(capsules), box_(box), out_(out) {}

  bool has_room() const { return out_.size() <= most_hand_points; }

  /// A spiral with equal areas between its points (Swinbank and Purser 2006).
  void add_ball(const Vec3& centre, double radius_m) {
    if (!begin({centre - radius_m, centre + radius_m})) return;
    constexpr double golden_angle = 2 * pi * (2 - std::numbers::phi);
    const auto count = std::max<std::size_t>(
        4, static_cast<std::size_t>(std::lround(4 * pi * radius_m * radius_m / (skin_pitch_m * skin_pitch_m))));
    for (std::size_t i = 0; i < count; ++i) {
      const double height = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
      const double across = std::sqrt(1 - height * height), angle = golden_angle * static_cast<double>(i);
      add(centre + radius_m * Vec3(across * std::cos(angle), height, across * std::sin(angle)));
    }
  }

  /// The cone that touches both balls: rings of points.
  void add_side(const Capsule& capsule) {
    const Vec3 way = capsule.b - capsule.a;
    const double length_m = glm::length(way), narrower_m = capsule.radius_a_m - capsule.radius_b_m;
    if (!(length_m > std::abs(narrower_m)) || !begin(box_of(capsule))) return;
    const Vec3 along = way / length_m;
    const Vec3 least = std::abs(along.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    const Vec3 right = glm::normalize(glm::cross(along, least)), up = glm::cross(along, right);
    // The surface's normal leans towards the thinner end.
    const double lean = narrower_m / length_m, outwards = std::sqrt(1 - lean * lean);
    const std::size_t rings = steps_along(length_m * outwards, 1);
    for (std::size_t i = 0; i < rings; ++i) {
      const double part = (static_cast<double>(i) + 0.5) / static_cast<double>(rings);
      const double radius_m = capsule.radius_a_m - part * narrower_m;
      const Vec3 centre = capsule.a + part * way + radius_m * lean * along;
      const std::size_t count = steps_along(2 * pi * radius_m * outwards, 3);
      // Each ring is turned against the one before.
      const double first = 0.5 * static_cast<double>(i % 2);
      for (std::size_t k = 0; k < count; ++k) {
        const double angle = 2 * pi * (static_cast<double>(k) + first) / static_cast<double>(count);
        add(centre + radius_m * outwards * (std::cos(angle) * right + std::sin(angle) * up));
      }
    }
  }

 private:
  /// Whether a surface within `around` can have points. Finds the capsules that may cover them.
  bool begin(const Box& around) {
    if (!around.overlaps(box_)) return false;
    near_.clear();
    for (const Capsule& capsule : capsules_) {
      if (box_of(capsule).overlaps(around)) near_.push_back(&capsule);
    }
    return true;
  }
  void add(const Vec3& point) {
    if (!box_.contains(point) || !has_room()) return;
    for (const Capsule* capsule : near_) {
      if (distance_to(*capsule, point) < -rounding_m) return;
    }
    out_.push_back({glm::vec3(point), static_cast<std::uint32_t>(out_.size())});
  }

  std::span<const Capsule> capsules_;
  const Box& box_;
  std::vector<SkinPoint>& out_;
  std::vector<const Capsule*> near_;
};

}  // namespace

void append_capsules(const TrackedHand& hand, const Transform& T_world_joints, std::vector<Capsule>& out) {
  for (const auto& [first, tip] : finger_joints) {
    for (std::size_t j = first; j < tip; ++j) {
      out.push_back({transform_point(T_world_joints, hand.joints[j]),
                     transform_point(T_world_joints, hand.joints[j + 1]), hand.radii_m[j], hand.radii_m[j + 1]});
    }
  }
}

double distance_to(const Capsule& capsule, const Vec3& point) {
  const Vec3 way = capsule.b - capsule.a, from = point - capsule.a;
  const double length_m = glm::length(way), narrower_m = capsule.radius_a_m - capsule.radius_b_m;
  if (!(length_m > std::abs(narrower_m))) {  // one ball is within the other
    return narrower_m > 0 ? glm::length(from) - capsule.radius_a_m
                          : glm::distance(point, capsule.b) - capsule.radius_b_m;
  }
  // The hull is made of balls along the axis. The distance from it is the least of those from the balls, which is that
  // from the ball whose surface has its normal through the point.
  const double lean = narrower_m / length_m;
  const double along_m = glm::dot(from, way) / length_m;
  const double across_m = std::sqrt(std::max(0.0, glm::dot(from, from) - along_m * along_m));
  const double ball_m = std::clamp(along_m - across_m * lean / std::sqrt(1 - lean * lean), 0.0, length_m);
  return std::hypot(across_m, along_m - ball_m) - (capsule.radius_a_m - ball_m * lean);
}

bool sample_skin(std::span<const Capsule> capsules, const Box& box, std::vector<SkinPoint>& out) {
  out.clear();
  Sampler sampler(capsules, box, out);
  for (std::size_t i = 0; i < capsules.size(); ++i) {
    const Capsule& capsule = capsules[i];
    const bool continues = i > 0 && capsules[i - 1].b == capsule.a && capsules[i - 1].radius_b_m == capsule.radius_a_m;
    if (!continues) sampler.add_ball(capsule.a, capsule.radius_a_m);
    sampler.add_side(capsule);
    sampler.add_ball(capsule.b, capsule.radius_b_m);
  }
  if (sampler.has_room()) return true;
  out.clear();
  return false;
}

}  // namespace palpa::sensing
