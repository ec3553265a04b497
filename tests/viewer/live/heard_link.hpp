// A link that remembers what it was told.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "session/links/link.hpp"

namespace palpa::test {

/// What a link was told, kept beyond its life.
struct Heard {
  std::atomic<std::uint64_t> drives{0}, sounding{0};
  std::atomic<bool> last_sounds{false}, finished{false};

  bool sounded() const { return sounding > 0; }
};

class HeardLink final : public session::Link {
 public:
  explicit HeardLink(std::shared_ptr<Heard> heard) : heard_(std::move(heard)) {}
  void plan(const session::ToldPlan&) override {}
  void send(std::uint64_t, std::span<const array::TransducerDrive> drive) override {
    const bool sounds = std::ranges::any_of(drive, [](const array::TransducerDrive& one) { return one.amplitude > 0; });
    ++heard_->drives;
    heard_->last_sounds = sounds;
    heard_->sounding += sounds ? 1 : 0;
  }
  void finish() override { heard_->finished = true; }

 private:
  std::shared_ptr<Heard> heard_;
};

/// "heard".
inline session::LinkKind heard_link(const std::shared_ptr<Heard>& heard) {
  return {"heard", "",
          [heard](const std::string&, const session::LinkSetting&) { return std::make_unique<HeardLink>(heard); }};
}

}  // namespace palpa::test
