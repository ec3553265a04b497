// How the gain of a finger follows its solid's stiffness, texture and clicks from frame to frame (docs/design.md).
//
// What is known of a finger is forgotten when its touch ends (watch/touches.hpp).
//
// Gains change from slot to slot if the first slot that plays a frame is known. Otherwise they change with the frame.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "array/course.hpp"
#include "array/schedule.hpp"
#include "base/inplace_vector.hpp"
#include "base/math.hpp"
#include "geometry/solid.hpp"
#include "session/plan/solid_haptics.hpp"
#include "session/watch/touches.hpp"
#include "touch/types.hpp"

namespace palpa::session {

/// A finger clicks at most once in this time.
inline constexpr double between_clicks_s = 0.1;
/// If a finger that presses already has more than this gain, a click is felt only after silence.
inline constexpr double most_resting_gain = 0.5;
inline constexpr double silence_before_click_s = 20e-3;
/// Slower fingers feel less of the vibrations of a texture, and a finger at rest nothing.
inline constexpr double full_texture_speed_m_s = 10e-3;

/// The gain with which a finger at the press depth plays its foci; `usual` is that of solids without an intensity.
double resting_gain(const geometry::Haptics& haptics, double usual);

/// Whether the feel of some solid depends on depths.
bool needs_depths(std::span<const geometry::Solid> solids);

using Stiffness = InplaceVector<geometry::DepthForce, geometry::most_stiffness_rows>;

/// How a solid feels from now on, whatever its author said; what is empty does not change. Values are in the ranges of
/// geometry::Haptics.
struct FeelChange {
  std::optional<geometry::Click> click{};  ///< without a press depth, it is never felt
  std::optional<Stiffness> stiffness{};
  std::optional<array::Texture> texture{};

  bool any() const { return click || stiffness || texture; }
};

/// How a frame's gains follow those of the frame before.
struct Following {
  /// Fingers have the ids of that frame. False: the frame stands alone, without motion and clicks.
  bool follows = false;
  std::optional<std::uint64_t> first_slot{};  ///< that plays the frame, if it is known
  std::optional<std::uint32_t> hands = 1;     ///< see Touches::update
};

/// How often gains can change.
struct GainPace {
  double slot_s = 0;
  bool steady = false;  ///< only from frame to frame, whatever the slot
};
/// A slot lasts at most this share of a vibration's period. Near one half, the slots may all lie between its swings for
/// longer than a click lasts.
inline constexpr double longest_slot = 0.4;
/// Whether gains can follow a vibration of that frequency.
bool carries(const GainPace& pace, double hz);
/// The frequency of the fastest vibration of a texture; 0: it has none.
double fastest_hz(const array::Texture& texture);

/// Keeps what it knows of each finger from frame to frame.
class Feel {
 public:
  /// `resolved` has the solids' gains. Touches end as those of events with the same hold. Clicks and vibrations that
  /// the pace does not carry are not played: such a solid feels as if it had no click or no texture.
  Feel(std::span<const geometry::Solid> solids, std::span<const SolidHaptics> resolved, const GainPace& pace,
       double hold_s);

  /// Textures move with their solids: T_world_rest takes them from their places in the scene to the current ones.
  void set_pose(std::uint32_t solid, const Transform& T_world_rest);
  /// Holds for the frames that follow. Allocates nothing.
  void change(std::uint32_t solid, const FeelChange& change);
  /// See Touches::take_over.
  void take_over(const Feel& other) { touches_.take_over(other.touches_); }

  /// Changes the voices of a frame's fingers, in the order of `touch`. A finger that clicks gets one focus at its
  /// centroid, shifted by `aim`. A texture takes the place of the modulation. Allocates nothing.
  void shape(const touch::Touch& touch, double time_s, const Following& following, const Vec3& aim,
             array::Schedule& schedule);

 private:
  struct Own {
    double gain = 1;
    std::optional<double> press_depth_m{};
    geometry::Click click{.burst_s = 0};
    Stiffness stiffness{};
    std::optional<array::Texture> texture{};
    double grain_m = 0;
    Transform T_rest_world{1};

    bool any() const { return press_depth_m || !stiffness.empty() || texture; }
    bool clicks() const { return click.burst_s > 0; }
    double force(double depth_m) const { return geometry::force_at(stiffness, depth_m); }
    /// Whether silence comes before its clicks.
    bool silence_first() const;
  };
  struct Known {
    std::uint32_t id = 0;
    std::optional<double> seen_s{};  ///< nothing in its first frame
    Vec3 place{0}, velocity{0};      ///< on the solid at rest: m, m/s
    array::Course course{};
    double clicked_s = -std::numeric_limits<double>::infinity();  ///< the last time
    std::optional<std::uint64_t> click_slot{};
  };
  struct Frame {
    double time_s = 0, slot_s = 0;
    std::optional<std::uint64_t> first_slot{};
    Vec3 aim{0};
  };

  void forget_ended();
  Known& known(std::uint32_t id);
  array::Course course_of(const Own& own, const touch::Finger& finger, const Frame& frame, Known& known);
  void click(const Own& own, const touch::Finger& finger, const HeldTouch& held, const Frame& frame, Known& known,
             array::Voice& voice);

  void set(Own& own, const geometry::Click& click) const;
  bool vibrates(const Own& own) const;

  GainPace pace_;
  std::vector<Own> solids_;
  Touches touches_;
  std::vector<Known> known_;  ///< fingers that touch; no id twice
};

}  // namespace palpa::session
