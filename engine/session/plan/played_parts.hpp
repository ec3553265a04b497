// How much of a requested pressure the boards of an array play, whose amplitudes have steps.
#pragma once

#include <cstdint>
#include <vector>

#include "array/layouts/board_play.hpp"
#include "array/requested_play.hpp"
#include "session/links/safe_link.hpp"
#include "session/plan/plan.hpp"

namespace palpa::session {

class PlayedParts {
 public:
  /// `layout` is that of the boards, and must outlive it.
  PlayedParts(const array::Layout& layout, const array::DriveOptions& options, const Safety& safety)
      : safety_(safety), boards_(layout), requested_(layout, boards_, options) {}
  PlayedParts(const PlayedParts&) = delete;
  PlayedParts& operator=(const PlayedParts&) = delete;

  /// The plan's schedule, whose voices reach the part of their pressures that the boards play at the safety's ceiling,
  /// relative to that ceiling. One slot is looked at in each call, in turn, because it takes as long as a drive. Valid
  /// until the next call.
  const array::Schedule& correct(const Plan& plan);

 private:
  Safety safety_;
  array::BoardPlay boards_;
  array::RequestedPlay requested_;
  array::Schedule schedule_;
  std::uint64_t calls_ = 0;
  array::Drive drive_;
  std::vector<array::SlotFocus> foci_;
  std::vector<double> weakest_;  ///< by voice
  std::vector<bool> heard_;
};

}  // namespace palpa::session
