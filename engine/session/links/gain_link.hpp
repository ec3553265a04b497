// A link whose loudness another thread may change while it plays.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "array/drive.hpp"
#include "session/links/hand_over.hpp"
#include "session/links/link.hpp"

namespace palpa::session {

/// Plays to another link. Every transducer's amplitude is multiplied by the gain, and so are the gain and the pressures
/// of every finger, for links that forward foci. At a gain of 1, nothing is copied or changed. A change is heard with
/// the next drive. On a board that plays plans by its own clock, it is heard with the next frame.
class GainLink final : public Link {
 public:
  /// `gain`, 0 to 1, must outlive it.
  GainLink(std::unique_ptr<Link> link, const std::atomic<double>& gain);

  void plan(const PlayedPlan& plan) override;
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override;
  void finish() override { link_->finish(); }
  std::optional<Carried> carried() const override { return link_->carried(); }

 private:
  std::unique_ptr<Link> link_;
  const std::atomic<double>& gain_;
  array::Schedule schedule_;
  array::Drive drives_;
};

}  // namespace palpa::session
