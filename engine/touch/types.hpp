// The results of touching: contacts, fingers, cross-sections and foci. docs/touch.md has the rules for everything that
// the paper leaves open.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "base/words.hpp"
#include "sensing/no_skin.hpp"

namespace palpa::touch {

/// How a cross-section is divided among its foci.
enum class Spacing {
  angle,  ///< Eq. (7): sectors of equal angle, after both axes are scaled to equal variance
  arc,    ///< sectors that cut the cross-section's outline into pieces of equal length
};
inline constexpr Word<Spacing> spacing_words[] = {{"angle", Spacing::angle}, {"arc", Spacing::arc}};

/// The members of Euclidean clusters. `contacts`: the ring of a finger where it enters the solid. `inside`: all skin
/// inside the solid, contacts and deep points, which is the other reading of the paper's III-D; the contacts of a
/// cluster are then one finger.
enum class Cluster { contacts, inside };
inline constexpr Word<Cluster> cluster_words[] = {{"contacts", Cluster::contacts}, {"inside", Cluster::inside}};

/// For fingers that are followed from frame to frame: the orientation of their cross-sections.
enum class Axes {
  steady,      ///< turned as little as possible from the previous frame
  covariance,  ///< the principal axes of each frame by itself, as in the paper
};
inline constexpr Word<Axes> axes_words[] = {{"steady", Axes::steady}, {"covariance", Axes::covariance}};

/// For fingers that are followed: the smoothing that keeps their foci from jumping.
enum class Smoothing {
  one_euro,  ///< foci are filtered in the finger's own frame, and foci of emptying sectors glide (fingers/glide.hpp)
  none,
};
inline constexpr Word<Smoothing> smoothing_words[] = {{"one-euro", Smoothing::one_euro}, {"none", Smoothing::none}};

/// For fingers that are followed through depth frames: whether a decision about a finger holds from frame to frame
/// until the evidence against it is strong.
enum class Hysteresis { on, off };
inline constexpr Word<Hysteresis> hysteresis_words[] = {{"on", Hysteresis::on}, {"off", Hysteresis::off}};

struct FingerOptions {
  double delta_m = 1.5e-3;       ///< thickness of the shell (paper: delta)
  double finger_gap_m = 5e-3;    ///< Euclidean tolerance: contacts no farther apart are in one finger
  std::uint32_t min_points = 5;  ///< clusters with fewer contacts are not fingers
  std::uint32_t foci = 10;       ///< N, 1 to max_foci; a solid may have its own
  Spacing spacing = Spacing::angle;
  /// With depth frames: a cluster wider than this may be several fingers (touch/fingers/split.hpp), patches that are
  /// together no wider may be one finger with hidden skin between them (touch/fingers/bridge.hpp), and flying
  /// pixels are not fingers. 0: every cluster is one finger.
  double finger_width_m = 25e-3;
  Cluster cluster = Cluster::contacts;
  bool deep = false;  ///< also find the deep points: inside a solid, delta or deeper

  /// `inside` needs the deep points even if nobody requests them.
  bool wants_deep() const { return deep || cluster == Cluster::inside; }
};

inline constexpr std::uint32_t max_foci = 64;
inline constexpr std::uint32_t max_fingers = 64;

/// A skin point in the shell of a solid. A point in the shells of several solids is a contact of the first of them.
struct Contact {
  std::uint32_t point = 0;  ///< index of the skin point (its place in the file; with depth frames the pixel's index)
  std::uint32_t solid = 0;  ///< index into the scene's solids
  float depth_m = 0;        ///< Eq. (1), in (0, delta)
  glm::vec3 position{};     ///< metres, world
  /// Only inside a stage, which leaves such contacts out of its result. 1: up to 0.5 mm beyond an edge of the shell,
  /// for a finger that is about to end.
  std::uint32_t beyond = 0;
};

/// Eq. (2)-(4): centroid and axes. Axes are orthonormal and right-handed. In a single frame, they are the principal
/// axes: w3 has y >= 0 (if it is within 1e-6 of the horizontal: z, then x, positive), w1's largest component is
/// positive, w2 = w3 x w1. If a finger is followed with steady axes, w3 is the principal axis with the sign that is
/// nearer to the previous frame. If that is not clear, w3 points along the gradient of depth. w1 and w2 are turned as
/// little as possible, so they are not the principal axes.
struct CrossSection {
  glm::vec3 centroid{};
  std::array<glm::vec3, 3> axes{};     ///< w1, w2, w3
  std::array<float, 3> eigenvalues{};  ///< m^2, never negative: the plane's two principal directions, then w3
  glm::vec2 turn{1, 0};                ///< the first principal direction is turn.x w1 + turn.y w2
  glm::vec3 lean{};  ///< covariance of the contacts' depth with their place, m^2: points to where they are deeper
};

struct Focus {
  /// Eq. (6), metres, world. Meaningless if points == 0, unless the finger's foci are all placed.
  glm::vec3 position{};
  std::uint32_t points = 0;  ///< |C_n|: contacts in the sector
  bool held = false;         ///< the sector is empty, but was not shortly before
};

struct Finger {
  std::uint32_t id = 0;  ///< stays the same from frame to frame if fingers are followed; in a single frame, the index
  std::uint32_t solid = 0;
  std::uint32_t contact_count = 0;
  /// Indices into the touch's contacts, ascending.
  std::vector<std::uint32_t> contacts;
  CrossSection section;
  std::vector<Focus> foci;  ///< N sectors of Eq. (7); one, at the centroid, when `point_like`
  bool placed = false;      ///< every focus has a position smoothed over time, even those of empty sectors
  /// Fewer than 3 contacts, or coincident or collinear ones: no cross-section, but one focus at the centroid,
  /// amplitude-modulated.
  bool point_like = false;
  float depth_m = 0;  ///< depth of its deepest firm skin point, see find_depths
  /// With hysteresis: half of min_points contacts are enough for it in the next frame.
  bool holds = false;
  /// With hysteresis: unit, the mean of its skin's outward normals, which point into the solid; zero if unknown.
  glm::vec3 inward{};
};

/// Reused from frame to frame; the vectors keep their allocations.
struct Touch {
  std::vector<Contact> contacts;  ///< in the order of the skin points: ascending by point
  /// If requested: skin points inside a solid at delta or deeper and in no solid's shell, ascending by point. Their
  /// depth is exact in convex solids, in others at most 2 % too large.
  std::vector<Contact> deep;
  /// Ordered by their smallest contact; only the first `finger_count` are valid.
  std::vector<Finger> fingers;
  std::uint32_t finger_count = 0;
  /// The number of clusters of at least min_points contacts. If there are more than max_fingers, only the largest are
  /// fingers; among equally large ones, those with the smallest first contacts.
  std::uint32_t cluster_count = 0;
  sensing::Dropped dropped;  ///< with depth frames: points near the solids that are no skin
};

}  // namespace palpa::touch
