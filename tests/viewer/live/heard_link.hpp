// A link that records what it is given, and the options of a live run that plays to it.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "base/error.hpp"
#include "session/links/hand_over.hpp"
#include "session/links/link.hpp"
#include "support/shared_data.hpp"
#include "viewer/live/live_line.hpp"

namespace palpa::test {

/// Everything that a link was given; it outlives the link.
struct HeardSound {
  std::atomic<std::uint64_t> drives{0}, sounding{0}, plans{0};
  std::atomic<int> opened{0};
  std::atomic<bool> breaks{false};    ///< set by a test: the link fails
  std::atomic<bool> swallows{false};  ///< set by a test: drives no longer arrive
  std::atomic<bool> halves{false};    ///< set by a test: every second drive does not arrive
  std::atomic<bool> gone{false};      ///< set by a test: the device is out of reach, as the link knows
  std::atomic<bool> unsure{false};    ///< set by a test: it is not known whether the last silence arrived
  std::atomic<std::uint64_t> arrived{0};
  std::atomic<bool> board{false};  ///< set by a test: links that are opened from now on are boards
  std::atomic<bool> last_sounds{false}, finished{false};
  std::atomic<float> loudest{0};  ///< amplitude in the last drive that sounds

  bool sounded() const { return sounding > 0; }
};

class HeardLink final : public session::Link {
 public:
  /// `layout`: of the boards, if the link is a board.
  explicit HeardLink(std::shared_ptr<HeardSound> heard, const array::Layout* layout = nullptr)
      : heard_(std::move(heard)), layout_(layout) {
    ++heard_->opened;
  }
  const array::Layout* boards() const override { return layout_; }
  bool plays() const override { return false; }
  void plan(const session::PlayedPlan&) override { ++heard_->plans; }
  void send(std::uint64_t, std::span<const array::TransducerDrive> drive) override {
    if (heard_->breaks) throw failure("heard: broken");
    float loudest = 0;
    for (const array::TransducerDrive& one : drive)
      loudest = std::max(loudest, one.amplitude);
    const bool sounds = loudest > 0;
    if (sounds) heard_->loudest = loudest;
    ++heard_->drives;
    heard_->last_sounds = sounds;
    heard_->sounding += sounds ? 1 : 0;
    const bool lost = heard_->swallows || (heard_->halves && heard_->drives % 2 == 0);
    heard_->arrived += sounds && !lost ? 1 : 0;
  }
  void finish() override {
    heard_->finished = true;
    if (heard_->unsure) throw failure("heard: it is not known whether the last silence reached the board");
  }
  std::optional<session::Carried> carried() const override {
    return session::Carried{.guard = {},
                            .submitted = {.drives = heard_->sounding},
                            .completed = {.drives = heard_->arrived},
                            .out_of_reach = heard_->gone};
  }

 private:
  std::shared_ptr<HeardSound> heard_;
  const array::Layout* layout_;
};

/// "heard".
inline session::LinkKind heard_link(const std::shared_ptr<HeardSound>& heard) {
  return {"heard", "", [heard](const std::string&, const session::LinkSetting& setting) {
            return std::make_unique<HeardLink>(heard, heard->board ? &setting.layout : nullptr);
          }};
}

/// A synthetic finger in a cube, computed on the processor and played to "heard" for that many frames; 0: without an
/// end. Slow frames are still heard, but a run that ends by itself plays its last frame no longer than necessary.
inline setup::LiveOptions heard_options(std::uint64_t frames = 0) {
  setup::LiveOptions options = viewer::live_options({{"--scene", {source_file("assets/cube.glb").string()}},
                                                     {"--source", {"synthetic"}},
                                                     {"--layout", {"autd3"}},
                                                     {"--backend", {"cpu"}},
                                                     {"--noise-free", {}},
                                                     {"--hold", {frames > 0 ? "50ms" : "5s"}},
                                                     {"--link", {"heard"}}});
  options.frames = frames;
  return options;
}

}  // namespace palpa::test
