// A sensation on an array: a source of plans for the live loop. They are made a little ahead, and each ends with the
// last slot that it knows, so the array falls silent if no other comes.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/math.hpp"
#include "sensation/played.hpp"
#include "session/clock.hpp"
#include "session/links/link.hpp"
#include "session/loop/output.hpp"
#include "session/loop/run_observer.hpp"
#include "session/sensation_control.hpp"
#include "session/watch/stats.hpp"

namespace palpa::session {

struct SensationSetting {
  OutputSetting output;           ///< its layout is posed in the world; its hold is that of the hand
  Transform T_world_array{1.0};   ///< from the sensation's frame
  std::optional<Vec3> at_m{};     ///< the place, instead of the sensation's own height
  HandPlace* hand = nullptr;      ///< the hand on which it plays
  bool upright = false;           ///< on a hand: keeps the array's axes
  bool listed = false;            ///< plans list their drives, for a link that plays plans
  bool ends = true;               ///< the run ends where the sensation ends; otherwise, it pauses there
  std::optional<double> end_s{};  ///< the time of its end; otherwise, only a stop ends it
  std::uint64_t seed = 0;
};

/// The point where it sounds: on the hand, at the given place, or at its own. In the array's frame.
Vec3 placed(const sensation::Point& point, const SensationSetting& setting, const std::optional<Transform>& hand);

/// Warns once of places that cannot be driven, or are of no use.
class PlaceWatch {
 public:
  explicit PlaceWatch(const array::Layout& layout) : layout_(layout) {}
  /// Whether a place in the world can be driven; otherwise, it is silent.
  bool sounds(const Vec3& place_m);
  /// Looks at those that do, since the look before.
  void look();

 private:
  const array::Layout& layout_;
  Box box_;
  bool far_ = false, odd_ = false;
};

/// With fewer, a turn of a brush or a modulation is coarse; with less than two, another frequency would play.
inline constexpr double few_places = 4, least_places = 2;
/// Infinite for 0 Hz.
inline double places_in_a_turn(double hz, double slot_s) {
  return 1 / (slot_s * hz);
}

/// A plan lists so many drives, if it lists them: as many foci as AUTD3 devices take in a message.
inline constexpr std::uint32_t listed_slots = 72;

/// Plays in run_loop until the sensation or its time ends, `stop` becomes true or something fails; the last drive that
/// `link` gets is all-zero, whatever happens. Errors of any thread are thrown here, after silence. Points that cannot
/// be driven, or are out of the array's reach, are warned of once; so is a sensation that has become faster than
/// sensation::most_hz, or has less than least_places in a turn, and is silent as long as it is.
OutputStats run_sensation(sensation::Sensation& sensation, SensationControl& control, Link& link,
                          const SensationSetting& setting, std::atomic<bool>& stop, RunObserver& observer = no_observer,
                          const Clock& clock = real_clock());

/// The same as drives alone, slot by slot from 0, as fast as `link` takes them: those of points_of_slots().
OutputStats record_sensation(std::span<const sensation::Point> points, Link& link, const SensationSetting& setting,
                             const std::atomic<bool>& stop);

/// The points of the slots from time 0 on, until a stop or the setting's end. Without an end, the first `most`. Warns
/// as run_sensation() does of places, and those that cannot be driven are silent.
std::vector<sensation::Point> points_of_slots(sensation::Sensation& sensation, const SensationSetting& setting,
                                              std::uint64_t most);

}  // namespace palpa::session
