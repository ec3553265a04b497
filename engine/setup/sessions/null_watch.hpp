// Looks at the nulls of a session, whose foci are known only while it runs: it warns as `palpa drive` does.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"
#include "session/answer_thread.hpp"
#include "session/loop/run_observer.hpp"
#include "session/plan/plan.hpp"
#include "session/session.hpp"

namespace palpa::setup {

/// The foci of the slots of a schedule.
using SlotFoci = std::vector<std::vector<array::SlotFocus>>;

/// What is doubtful about nulls, found so far. Each kind of doubt is reported once.
class NullDoubts {
 public:
  /// Both must outlive it. All places are in the world.
  NullDoubts(const array::Layout& layout, const array::DriveOptions& options) : layout_(&layout), options_(&options) {}
  /// Looks at the slot whose foci and nulls the array tells apart least, unless it has seen a worse one. Warns.
  void look(const SlotFoci& slots);

 private:
  enum Kind { crowded, within, quiet, loud, kinds };
  void tell(Kind kind, const std::string& line);

  const array::Layout* layout_;
  const array::DriveOptions* options_;
  double seen_ = -1;  ///< the largest part of the sound that a focus and a null shared
  bool told_[kinds]{};
};

class NullWatch {
 public:
  /// As NullDoubts. Looks `at_once`, or on a thread of its own, which yields to all others.
  NullWatch(const array::Layout& layout, const array::DriveOptions& options, bool at_once);
  /// Looks at the foci of the plan if they are elsewhere than those it looked at before. With a thread, it is quick.
  void planned(const session::Plan& plan);

 private:
  struct Answer {
    std::uint64_t number = 0;
    std::string fault{};
  };

  NullDoubts doubts_;
  SlotFoci slots_;
  std::vector<Vec3> places_, seen_;  ///< of foci, in the order of slots: of this plan, and when it looked last
  std::unique_ptr<session::AnswerThread<SlotFoci, Answer>> thread_;
};

/// Looks at the nulls of each plan, if the session has some, and passes everything on.
class WatchedNulls final : public session::RunObserver {
 public:
  /// Both must outlive it. `at_once` as NullWatch.
  WatchedNulls(const session::SessionSetting& setting, session::RunObserver& next, bool at_once);
  void arrived(std::uint64_t sequence) override { next_.arrived(sequence); }
  void started(const session::SkinFrame& frame) override { next_.started(frame); }
  void planned(const session::FrameReport& report, const session::Plan& plan) override;
  void expired() override { next_.expired(); }
  void sent(bool sounds, const session::HandOver& counts) override { next_.sent(sounds, counts); }
  void recording_rest(std::uint64_t frames) override { next_.recording_rest(frames); }
  void moved(std::uint32_t solid, const Transform& T_world_rest) override { next_.moved(solid, T_world_rest); }
  void events(std::span<const session::Event> events) override { next_.events(events); }

 private:
  session::RunObserver& next_;
  std::optional<NullWatch> watch_;
};

/// Warns of nulls that the boards of the link spoil, at the session's ceiling and the least gain of its solids
/// (coarse_boards_line).
void warn_of_boards(const std::string& link, const session::Session& session);

}  // namespace palpa::setup
