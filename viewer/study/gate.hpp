// The gate between a live session and the array during a study. It lets sound through only until a moment that the
// study's thread renews again and again. If that thread stands still, the array falls silent.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "array/schedule.hpp"
#include "base/files/sha256.hpp"
#include "session/clock.hpp"
#include "session/links/hand_over.hpp"
#include "session/links/link.hpp"
#include "viewer/study/touch_frames.hpp"

namespace palpa::viewer {

/// What sounded from one frame on.
struct PlayedFrame {
  std::uint64_t from = 0, until = 0;  ///< slots, see session::Slots
  array::Schedule schedule;           ///< only its valid voices
};

/// How many drives of one touch went how far.
struct GateCounts {
  std::uint64_t drives = 0;                ///< also those that are silent, for example between a modulation's crests
  std::uint64_t sounding = 0;              ///< of these, those that sound
  std::uint64_t skipped = 0;               ///< that were never sent, because the program was too late
  std::optional<std::uint64_t> arrived{};  ///< that are completely on the device; nothing if the link does not count

  /// Drives that sound and that the device never got.
  std::uint64_t lost() const { return arrived ? sounding - std::min(sounding, *arrived) : 0; }
  /// Whether fewer than 99 % of the drives arrived. Silence overtakes the last drives, so a few do not count.
  bool too_few() const { return lost() > overtaken + sounding / 100; }
  static constexpr std::uint64_t overtaken = 8;
};

/// What went through the gate in one touch.
struct PlayedTouch {
  GateCounts counts;
  /// The digest of these drives: for each transducer, amplitude and phase as 32-bit floats, in layout order. Empty
  /// without drives.
  std::string drives_sha256{};
  std::vector<PlayedFrame> frames{};
  std::uint64_t end = 0;  ///< the slot after the last drive, not before the last frame
};

/// A clock's time, for code that compares it with std::chrono.
inline std::chrono::steady_clock::time_point time_of(const session::Clock& clock) {
  using Clock = std::chrono::steady_clock;
  return Clock::time_point(std::chrono::round<Clock::duration>(std::chrono::duration<double>(clock.now())));
}

/// One thread opens, closes and takes; the links' output threads pass through.
class Gate {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Gate(const session::Clock& clock = session::real_clock()) : clock_(&clock), frames_(clock) {}

  /// All moments are on its clock.
  Clock::time_point now() const { return time_of(*clock_); }
  /// Lets sound through until then. Replaces an earlier moment.
  void open(Clock::time_point until) { until_ = until.time_since_epoch().count(); }
  /// Only silence passes from now on. A drive that is just being sent is the last one that may sound.
  void close() { until_ = closed; }
  bool is_open(Clock::time_point now) const { return now.time_since_epoch().count() < until_; }
  bool is_open() const { return is_open(now()); }

  /// Forgets what has passed so far.
  void forget();
  /// What has passed since forget(). Call it when the gate is closed.
  PlayedTouch take();
  /// How many drives have passed and arrived since forget().
  GateCounts counts() const;
  /// What became of the frames of a touch. Here it learns which of them passed.
  TouchFrames& frames() { return frames_; }
  const TouchFrames& frames() const { return frames_; }
  /// Whether a drive that sounds has passed within the last 100 ms.
  bool sounding(Clock::time_point now) const { return is_recent(last_sound_, now); }
  bool sounding() const { return sounding(now()); }
  /// Whether such a drive has also arrived at the device, at least shortly before may_sound() would say that none does.
  /// For links that do not count: as sounding().
  bool heard() const {
    const Clock::time_point now = this->now();
    return sounding(now) && (!link_counts_ || is_recent(last_arrival_, now - longest_unheard));
  }
  /// An array to which nothing arrives for longer is not there. Boards need much less for a drive or a plan.
  static constexpr std::chrono::milliseconds longest_unheard{100};
  /// Whether the device may play its last sound on, because it is not known to have got the silence after it: nothing
  /// arrives, or its link failed.
  bool may_sound() const { return unsure_ || (played_ && (out_of_reach_ || unheard() > longest_unheard)); }
  /// It may, from now on, until something arrives again or the link is opened again.
  void doubt() { unsure_ = true; }
  /// Whether the link says that its device takes nothing at the moment.
  bool out_of_reach() const { return out_of_reach_; }
  /// For how long drives that sound have passed without any of them arriving at the device. Zero if they arrive, if
  /// nothing sounds, and for links that do not count.
  Clock::duration unheard() const {
    const Clock::time_point now = this->now();
    const Clock::rep since = unheard_since_;
    return since == closed || !sounding(now) ? Clock::duration(0) : now - Clock::time_point(Clock::duration(since));
  }
  /// The capture time of the frame of the newest plan that has come, also to a closed gate, on the source's clock. A
  /// plan reaches the gate later than others hear of its frame.
  double newest_s() const { return newest_s_; }
  /// Another session begins, whose source has another clock.
  void restart() { newest_s_ = never_s; }
  /// How long drives that sound have sounded altogether, each until the drive after it came, also a silent one.
  Clock::duration sounded_for() const;

 private:
  friend class GateLink;
  static constexpr double never_s = -1e300;
  static constexpr Clock::rep closed = Clock::time_point::min().time_since_epoch().count();

  static bool is_recent(Clock::rep when, Clock::time_point now);
  void note(std::uint64_t slot, std::span<const array::TransducerDrive> drive, Clock::time_point now);
  void note_arrivals(std::uint64_t drives, Clock::time_point now);
  void note_silence(Clock::time_point now);
  void count_sound(bool sounds, Clock::time_point now);
  void note(const PlayedFrame& frame);

  const session::Clock* clock_;
  TouchFrames frames_;
  std::atomic<Clock::rep> until_{closed}, last_sound_{closed}, last_arrival_{closed}, unheard_since_{closed};
  std::atomic<bool> link_counts_{false}, out_of_reach_{false};
  std::atomic<bool> played_{false};  ///< since the link was opened, something that sounds was passed to it
  std::atomic<bool> unsure_{false};  ///< and it is not known whether the silence after it arrived
  std::atomic<double> newest_s_{never_s};
  mutable std::mutex mutex_;
  PlayedTouch touch_;
  Clock::duration sounded_for_{};
  std::optional<Clock::time_point> counted_until_{};  ///< while the last drive sounds
  std::optional<std::uint64_t> last_slot_{};          ///< while drives pass one after the other
  Sha256 digest_;
};

/// Plays to another link what the gate lets through, and silence while it is closed. The gate must outlive it.
class GateLink final : public session::Link {
 public:
  GateLink(std::unique_ptr<session::Link> link, Gate& gate);
  /// A link that is gone sounds no longer.
  ~GateLink() override;

  void plan(const session::PlayedPlan& plan) override;
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override { send(slot, drive, false); }
  void send_planned(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    send(slot, drive, true);
  }
  bool plays_plans() const override { return link_->plays_plans(); }
  const array::Layout* boards() const override { return link_->boards(); }
  bool plays() const override { return link_->plays(); }
  void finish() override;
  std::optional<session::Carried> carried() const override;

 private:
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive, bool planned);
  template <typename Work>
  void pass(Work work);
  void shut(std::uint64_t slot);
  bool see_arrivals(Gate::Clock::time_point now);

  std::unique_ptr<session::Link> link_;
  Gate* gate_;
  session::Passed withheld_;
  std::uint64_t arrived_ = 0;
  bool passing_ = false;  ///< the link's last plan and drive may sound
  bool failed_ = false;   ///< the link, once
  PlayedFrame newest_;    ///< of the last plan
  array::Schedule nothing_;
  array::Drive silence_;
};

/// The same kinds of links, behind the gate.
std::vector<session::LinkKind> behind_gate(std::vector<session::LinkKind> kinds, Gate& gate);

}  // namespace palpa::viewer
