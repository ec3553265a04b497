// A link that remembers what it was told.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>

#include "session/link.hpp"

namespace palpa::test {

/// What a link was told, kept beyond its life.
struct Heard {
  std::mutex mutex;
  std::uint64_t drives = 0, sounding = 0;
  bool last_sounds = false, finished = false;

  bool sounded() {
    const std::lock_guard lock(mutex);
    return sounding > 0;
  }
};

class HeardLink final : public session::Link {
 public:
  explicit HeardLink(std::shared_ptr<Heard> heard) : heard_(std::move(heard)) {}
  void plan(const session::ToldPlan&) override {}
  void send(std::uint64_t, std::span<const array::TransducerDrive> drive) override {
    const std::lock_guard lock(heard_->mutex);
    ++heard_->drives;
    heard_->last_sounds = false;
    for (const array::TransducerDrive& one : drive)
      heard_->last_sounds = heard_->last_sounds || one.amplitude > 0;
    heard_->sounding += heard_->last_sounds ? 1 : 0;
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
