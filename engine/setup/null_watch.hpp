// Looks at the nulls of a run, whose foci are known only while it runs: `palpa run` warns as `palpa drive` does.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"
#include "session/answer_thread.hpp"
#include "session/plan/plan.hpp"

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

}  // namespace palpa::setup
