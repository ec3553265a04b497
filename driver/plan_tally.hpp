// Counts drives for a board that plays plans by its own clock: a drive has got as far as the plan that it belongs to.
#pragma once

#include <cstdint>

#include "driver/board.hpp"

namespace palpa::driver {

class PlanTally {
 public:
  /// Up to `drives` drives may pass before a touch's first plan can be there.
  void allow(std::uint64_t drives) {
    if (began_) return;
    began_ = true;
    allowed_ = drives;
  }
  /// Call when all of a plan is on its way.
  void sent() {
    if (plan_ == Plan::none) plan_ = Plan::sent;
    ++counts_.submitted.plans;
  }
  /// Call when the device has the plan.
  void there() {
    plan_ = Plan::there;
    ++counts_.completed.plans;
  }
  /// Call on silence: a plan must be sent again before it is heard.
  void gone() {
    lost();
    began_ = false;
  }
  /// Call when the device is gone. Forgets the plan, but grants no new allowance of early drives when the device
  /// returns.
  void lost() { plan_ = Plan::none; }

  /// Call for a drive that sounds and that the plan has.
  void play() {
    if (plan_ != Plan::there && allowed_ > 0) {
      --allowed_;
      ++counts_.starting;
      return;
    }
    counts_.submitted.drives += plan_ != Plan::none ? 1 : 0;
    counts_.completed.drives += plan_ == Plan::there ? 1 : 0;
  }
  /// Call for a drive that no plan has and that is sent as it is.
  void drive_sent() { ++counts_.submitted.drives; }
  void drive_there() { ++counts_.completed.drives; }

  BoardCounts counts(bool out_of_reach) const {
    return {counts_.submitted, counts_.completed, counts_.starting, out_of_reach};
  }

 private:
  enum class Plan { none, sent, there };
  BoardCounts counts_;
  Plan plan_ = Plan::none;
  bool began_ = false;
  std::uint64_t allowed_ = 0;
};

}  // namespace palpa::driver
