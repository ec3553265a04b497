#include "viewer/live/watched_link.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

namespace palpa::viewer {
namespace {

class WatchedLink final : public session::Link {
 public:
  WatchedLink(std::unique_ptr<session::Link> link, LinkWatch& watch) : link_(std::move(link)), watch_(&watch) {
    watch_->drives = watch_->silent = 0;
    watch_->sounding = false;
    watch_->open = true;
  }
  ~WatchedLink() override {
    link_.reset();
    watch_->open = watch_->sounding = false;
  }
  WatchedLink(const WatchedLink&) = delete;
  WatchedLink& operator=(const WatchedLink&) = delete;

  void plan(const session::ToldPlan& told) override { link_->plan(told); }
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    link_->send(slot, drive);
    const bool sounds = std::ranges::any_of(drive, [](const array::TransducerDrive& one) { return one.amplitude > 0; });
    watch_->sounding = sounds;
    ++watch_->drives;
    watch_->silent += sounds ? 0 : 1;
  }
  void finish() override { link_->finish(); }

 private:
  std::unique_ptr<session::Link> link_;
  LinkWatch* watch_;
};

}  // namespace

std::vector<session::LinkKind> watched(std::span<const session::LinkKind> kinds, LinkWatch& watch) {
  std::vector<session::LinkKind> out(kinds.begin(), kinds.end());
  for (session::LinkKind& kind : out) {
    kind.open = [open = std::move(kind.open), &watch](const std::string& argument,
                                                      const session::LinkSetting& setting) {
      return std::make_unique<WatchedLink>(open(argument, setting), watch);
    };
  }
  return out;
}

}  // namespace palpa::viewer
