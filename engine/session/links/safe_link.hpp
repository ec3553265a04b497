// What keeps people safe, around any link: the silence at the end, a ceiling, a ramp.
//
// Nothing is copied and nothing changed while the ceiling is 1 and there is no ramp. Calls that do not come are not its
// business: a board has its watchdog, and whoever hears foci goes silent by itself.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "session/links/hand_over.hpp"
#include "session/links/link.hpp"
#include "session/links/plan.hpp"

namespace palpa::session {

struct Safety {
  /// 0..1: multiplies the amplitude of every transducer, and the gain and pressure of every finger for links that
  /// forward foci. The sound pressure follows it; the radiation pressure, which is what skin feels, follows its square.
  double ceiling = 1;
  /// How long amplitudes take from nothing to full when sound begins, and back to nothing when a plan without voices
  /// comes: the drive that sounded last fades out, so sound outlasts the hold by as much. At most most_ramp_s; 0: at
  /// once.
  double ramp_s = 0;
};
inline constexpr double most_ramp_s = 0.5;  ///< a program that is told to end has a second for all
/// Throws bad_usage on a ceiling or a ramp out of range.
void check_safety(const Safety& safety);

/// Plays to another link. An all-zero drive is the last that link gets: from finish(), else from the destructor, so
/// also where the link or its caller throws. What comes after finish() is dropped.
class SafeLink final : public Link {
 public:
  /// `link` outlives it. `sent` is called after every drive that it took, with whether it sounds. Throws bad_usage on a
  /// ceiling or a ramp out of range.
  SafeLink(Link& link, std::size_t transducers, const Safety& safety = {}, double slot_s = 1.5e-3,
           std::function<void(bool sounds)> sent = {});
  ~SafeLink() override;
  SafeLink(const SafeLink&) = delete;
  SafeLink& operator=(const SafeLink&) = delete;

  void plan(const PlayedPlan& plan) override;
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override;
  /// The slot after the last that was sent.
  std::uint64_t next_slot() const { return next_slot_; }

  /// How many drives and plans the link was handed, and what became of them there.
  HandOver handed_over() const;

  /// Nothing is touched any more: passes on a plan without voices and sends an all-zero drive for the next slot. With a
  /// ramp sound is only on its way down then.
  void silence();
  /// Whether there is a ramp and sound on it: with a plan without voices every send() takes it further down.
  bool must_fade() const { return up_ > 0; }
  /// Silence at once, without a ramp: a plan without voices, an all-zero drive, then the link's own finish(). All three
  /// are tried whatever fails; the first error is thrown.
  void finish() override;

 private:
  bool plain() const { return safety_.ceiling == 1 && safety_.ramp_s == 0; }
  bool ramped() const { return safety_.ramp_s > 0; }
  double factor(std::uint32_t up) const { return safety_.ceiling * up / ramp_drives_; }
  void pass_on_scaled(std::uint64_t from_slot, double factor);
  void send_ramped(std::uint64_t slot, std::span<const array::TransducerDrive> drive);
  void send_scaled(std::uint64_t slot, std::span<const array::TransducerDrive> drive, double factor);
  void pass_on(const PlayedPlan& plan);
  void pass_on(std::uint64_t slot, std::span<const array::TransducerDrive> drive);
  void hand_over(std::uint64_t slot, std::span<const array::TransducerDrive> drive, bool audible);

  Link& link_;
  Safety safety_;
  std::size_t transducers_;
  double slot_s_;
  std::function<void(bool)> sent_;
  array::Schedule nothing_;  ///< at the time of the last plan
  array::Drive silence_;
  std::uint64_t next_slot_ = 0;
  Passed passed_;  ///< what the link was handed
  bool ended_ = false;

  // Where amplitudes change.
  Plan kept_, scaled_;            ///< the last plan with voices as it came, and as it was passed on
  std::uint64_t until_slot_ = 0;  ///< of the last plan with voices
  array::Drive scaled_drive_;

  // With a ramp.
  bool on_ = false;                ///< sound is to be there
  std::uint32_t ramp_drives_ = 1;  ///< how many drives the ramp takes
  std::uint32_t up_ = 0;           ///< of them
  array::Drive last_;              ///< the last drive while sound was to be there, before it was scaled
  double passed_factor_ = 0;       ///< of the plan that was passed on last
  std::uint64_t passed_slot_ = 0;  ///< from which slot on
};

}  // namespace palpa::session
