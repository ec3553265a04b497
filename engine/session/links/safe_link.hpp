// The safety layer around any link: silence at the end, a ceiling, a ramp; and for boards, the amplitudes that they
// have.
//
// While the ceiling is 1 and cannot change, there is no ramp, and the link is no board, nothing is copied or changed.
// If no calls come at all, this layer can do nothing. The guard then silences a board; a receiver of foci falls silent
// by itself.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "array/layouts/board_play.hpp"
#include "array/requested_play.hpp"
#include "session/links/hand_over.hpp"
#include "session/links/link.hpp"
#include "session/links/slots.hpp"

namespace palpa::session {

struct Safety {
  /// 0..1: multiplies the amplitude of every transducer, and the gain and pressure of every finger for links that
  /// forward foci. The sound pressure is proportional to it. The radiation pressure, which is what skin feels, is
  /// proportional to its square.
  double ceiling = 1;
  /// The time in which amplitudes rise from zero to full when sound begins, and fall back to zero when a plan without
  /// voices comes. The last sounding drive fades out, so sound outlasts the hold by this time. At most most_ramp_s; 0:
  /// at once.
  double ramp_s = 0;
  /// If it is set, this is the ceiling instead. Any thread may change it while a SafeLink plays. The next plan and the
  /// next drive follow it. Values outside 0..1 count as the nearest one of them, and NaN as 0.
  const std::atomic<double>* ceiling_now = nullptr;
  /// If it is set, it multiplies the ceiling, in the same way. It can only lower it.
  const std::atomic<double>* gain_now = nullptr;
};
inline constexpr double most_ramp_s = 0.5;  ///< a program has one second to end after a signal
/// The ceiling that holds now, with the gain.
double ceiling_of(const Safety& safety);
/// Throws bad_usage if the ceiling or the ramp is out of range.
void check_safety(const Safety& safety);

/// Plays to another link. A board's drives are rounded as array::BoardPlay does, or if fingers request a pressure, as
/// array::RequestedPlay does. What counts as sounding is therefore what sounds: a drive below the board's least
/// amplitude is silent. If a board plays a plan of one drive by its own clock and modulation, the drive of each slot is
/// the plan's. Boards that do not play plans get plans without drives. Warns if a plan with fingers is silent because
/// of the board's steps, once until one sounds; and once in a run if most of its drives are. The last drive that the
/// link gets is all-zero: from finish(), or else from the destructor, so even if the link or its caller throws. Calls
/// after finish() are dropped.
class SafeLink final : public Link {
 public:
  /// `link` must outlive it. `sent` is called after every drive that the link took; its argument says whether the drive
  /// sounds. `drive` are the options of the drives, for requested pressures. Throws bad_usage if the ceiling or the
  /// ramp is out of range.
  SafeLink(Link& link, std::size_t transducers, const Safety& safety = {}, double slot_s = 1.5e-3,
           std::function<void(bool sounds, const HandOver& counts)> sent = {}, const array::DriveOptions& drive = {});
  ~SafeLink() override;
  SafeLink(const SafeLink&) = delete;
  SafeLink& operator=(const SafeLink&) = delete;

  void plan(const PlayedPlan& plan) override;
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override { send(slot, drive, false); }
  void send_planned(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    send(slot, drive, true);
  }
  /// Whether the last drive that the link got sounds.
  bool sounded() const { return sounded_; }
  /// The slot after the last one sent.
  std::uint64_t next_slot() const { return next_slot_; }

  /// The number of drives and plans that the link got, and the link's own counts of them.
  HandOver handed_over() const;

  /// For when nothing is touched any more: passes on a plan without voices and sends an all-zero drive for the next
  /// slot. With a ramp, sound only begins to fall.
  void silence();
  /// Whether there is a ramp and sound is not yet down to zero. With a plan without voices, every send() lowers it
  /// further.
  bool must_fade() const { return up_ > 0; }
  /// Silence at once, without a ramp: a plan without voices, an all-zero drive, then the link's own finish(). All three
  /// are tried even if one fails; the first error is thrown.
  void finish() override;

 private:
  bool plain() const { return safety_.ceiling == 1 && !changes() && safety_.ramp_s == 0 && !boards_; }
  bool changes() const { return safety_.ceiling_now != nullptr || safety_.gain_now != nullptr; }
  double ceiling() const { return ceiling_of(safety_); }
  bool ramped() const { return safety_.ramp_s > 0; }
  double factor(std::uint32_t up) const { return ceiling() * up / ramp_drives_; }
  void pass_on_scaled(std::uint64_t from_slot, double factor);
  void round(std::span<array::TransducerDrive> drive, std::uint64_t slot, double factor);
  void round_plan(double factor);
  void find_loudest(const PlayedPlan& plan);
  void warn_if_faint(double factor);
  void count_rounded(bool asked, bool audible, double factor);
  void warn_if_mostly_silent();
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive, bool planned);
  void send_ramped(std::uint64_t slot, std::span<const array::TransducerDrive> drive, bool planned);
  void send_scaled(std::uint64_t slot, std::span<const array::TransducerDrive> drive, std::uint64_t made_for,
                   double factor, bool planned);
  void pass_on(const PlayedPlan& plan);
  void pass_on(std::uint64_t slot, std::span<const array::TransducerDrive> drive, bool planned);
  void hand_over(std::uint64_t slot, std::span<const array::TransducerDrive> drive, bool audible, bool planned);

  Link& link_;
  Safety safety_;
  double slot_s_;
  std::function<void(bool, const HandOver&)> sent_;
  array::Schedule nothing_;  ///< a schedule without voices, at the time of the last plan
  array::Drive silence_;
  std::uint64_t next_slot_ = 0;
  Passed passed_;  ///< drives and plans that the link got
  bool ended_ = false, sounded_ = false;

  /// What a plan has besides its slots.
  struct Sound {
    array::Schedule schedule;
    Cycle cycle;
    array::Drive drives;
    std::vector<Vec3> foci;
  };

  // Only for boards.
  std::optional<array::BoardPlay> boards_;
  std::optional<array::RequestedPlay> requested_;
  std::vector<array::SlotFocus> foci_;
  array::Drive loudest_drive_;  ///< of the last plan, if it lists drives
  std::uint64_t loudest_slot_ = 0;
  float loudest_ = 0;  ///< its amplitude, or the largest gain
  bool plays_plans_ = false;
  bool asks_ = false;                          ///< fingers of the last plan request a pressure
  bool faint_ = false;                         ///< the last plan with fingers was silent, because of the boards' steps
  std::uint64_t asked_ = 0, rounded_off_ = 0;  ///< drives that should sound, and those that the steps left silent
  bool told_mostly_silent_ = false;

  // Only if amplitudes change.
  Sound kept_, scaled_;           ///< of the last plan with voices: as it came, and as it was passed on
  std::uint64_t until_slot_ = 0;  ///< end of the last plan with voices
  array::Drive scaled_drive_;

  // Only with a ramp.
  bool on_ = false;                ///< there should be sound
  std::uint32_t ramp_drives_ = 1;  ///< length of the ramp in drives
  std::uint32_t up_ = 0;           ///< current position on the ramp, in drives
  array::Drive last_;              ///< the last drive while there should be sound, before scaling
  std::uint64_t last_slot_ = 0;    ///< its slot
  double passed_factor_ = 0;       ///< factor of the plan that was passed on last
  std::uint64_t passed_slot_ = 0;  ///< first slot of that plan
};

}  // namespace palpa::session
