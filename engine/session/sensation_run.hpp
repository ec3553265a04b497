// A sensation on an array: its plans are made a little ahead on the calling thread, and play on the output thread, as
// those of run_loop do. Each plan ends with the last slot that it knows, so the array falls silent if no other comes.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "base/math.hpp"
#include "sensation/played.hpp"
#include "session/clock.hpp"
#include "session/links/link.hpp"
#include "session/loop/output.hpp"
#include "session/loop/run_observer.hpp"
#include "session/watch/stats.hpp"

namespace palpa::session {

/// The place of a hand on which a sensation plays. One thread writes, others read.
class Anchor {
 public:
  struct Seen {
    std::optional<Transform> T_array_hand;  ///< empty: there is no hand
    double captured_s = 0;                  ///< on the run's clock
    std::uint64_t number = 0;               ///< of the change
  };
  void see(const Transform& T_array_hand, double captured_s);
  void lose();
  Seen now() const;

 private:
  mutable std::mutex mutex_;
  Seen seen_;
};

/// A point of a run as it sounded.
struct SoundedPoint {
  Vec3 place_m{0};  ///< in the array's frame
  double gain = 0;
  double pattern_s = 0;
  bool stop = false;
};

/// Starts, pauses and moves a run in its time, from any thread.
class Transport {
 public:
  explicit Transport(bool plays = true) { now_.plays = plays; }

  /// From now on, or `in_s` later, with silence until then: from the time `from_s` of the sensation.
  void play(double from_s, double in_s = 0);
  /// Silence; the time stands.
  void pause();
  /// Whether it plays on the hand, if the run has one; otherwise at its own place.
  void follow(bool follows);
  /// Whether it plays, and has neither ended nor been paused.
  bool plays() const;
  /// The newest points that have sounded, at most `most`, oldest first. Empty while it does not play.
  std::vector<SoundedPoint> newest(std::size_t most) const;

  struct State {
    bool plays = true, follows = true;
    double from_s = 0, in_s = 0;
    std::uint64_t number = 0;  ///< of the change of `plays`, `from_s` and `in_s`
  };
  // For the run.
  State now() const;
  /// It ended by itself, unless it was started again after the change `number`.
  void ended(std::uint64_t number);
  void sounded(const SoundedPoint& point);

 private:
  mutable std::mutex mutex_;
  State now_;
  std::deque<SoundedPoint> newest_;
};

struct SensationSetting {
  OutputSetting output;           ///< its layout is posed in the world; its hold is that of the hand
  Transform T_world_array{1.0};   ///< from the sensation's frame
  std::optional<Vec3> at_m{};     ///< the place, instead of the sensation's own height
  Anchor* anchor = nullptr;       ///< the hand on which it plays
  bool upright = false;           ///< on a hand: keeps the array's axes
  bool listed = false;            ///< plans list their drives, for a link that plays plans
  bool ends = true;               ///< the run ends where the sensation ends; otherwise, it pauses there
  std::optional<double> end_s{};  ///< the time of its end; otherwise, only a stop ends it
  std::uint64_t seed = 0;
};

/// The point where it sounds: on the hand, at the given place, or at its own. In the array's frame.
Vec3 placed(const sensation::Point& point, const SensationSetting& setting, const std::optional<Transform>& hand);

/// A plan lists so many drives, if it lists them: as many foci as AUTD3 devices take in a message.
inline constexpr std::uint32_t listed_slots = 72;

/// Plays until the sensation or its time ends, `stop` becomes true or something fails; the last drive that `link` gets
/// is all-zero, whatever happens. Errors of either thread are thrown here, after silence. Points that cannot be driven,
/// or are out of the array's reach, are warned of once.
OutputStats run_sensation(sensation::Sensation& sensation, Transport& transport, Link& link,
                          const SensationSetting& setting, std::atomic<bool>& stop, RunObserver& observer = no_observer,
                          const Clock& clock = real_clock());

/// The same as drives alone, slot by slot from 0, as fast as `link` takes them: `slots` of them.
OutputStats record_sensation(sensation::Sensation& sensation, Link& link, const SensationSetting& setting,
                             std::uint64_t slots, const std::atomic<bool>& stop);

/// The points of the slots of `slot_s` from time 0 on, until a stop or `end_s`. Without an end, the first `most`.
std::vector<sensation::Point> points_of_slots(sensation::Sensation& sensation, double slot_s,
                                              std::optional<double> end_s, std::uint64_t most, std::uint64_t seed);
/// The number of slots until a time.
std::uint64_t slots_until(double end_s, double slot_s);

}  // namespace palpa::session
