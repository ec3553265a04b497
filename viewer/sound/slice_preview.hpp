// The field in a plane, computed in the background by the engine's field pass on its own device. While plane or drive
// change, the field is coarse, so that it keeps up with a hand. When both have stopped changing, it becomes finer.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "gpu/device.hpp"
#include "session/answer_thread.hpp"
#include "viewer/sound/field_slice.hpp"
#include "viewer/sound/sounding.hpp"

namespace palpa::viewer {

struct SliceQuestion {
  std::shared_ptr<const array::Layout> layout;
  acoustics::Air air;
  array::Directivity directivity = array::Directivity::t4010a1;
  SliceState slice;
  array::Drive drive;
  std::uint32_t along = 0;  ///< samples along the longer side
};

struct SliceAnswer {
  std::uint64_t number = 0;
  std::string fault;
  SliceField field;
  double seconds = 0;  ///< the time that it took
};

class SlicePreview {
 public:
  /// The device is also made in the background. Work is abandoned only between two answers: after half a second at
  /// most.
  explicit SlicePreview(gpu::DeviceOptions device);

  /// Asks again if plane or drive have changed since the last question. If they have stopped changing, asks for a finer
  /// field. Puts answers into the picture. Never waits.
  Change look(const Sounding& now, const SliceState& slice, Picture& picture, double now_s);
  /// Call this if the picture is a new one, in which everything must be shown again.
  void forget();
  /// Whether the picture will change by itself.
  bool busy() const { return busy_; }
  /// Why there is no result; else empty.
  const std::string& fault() const { return fault_; }

  static constexpr std::uint32_t coarsest = 24, finest = 192;

 private:
  std::uint32_t quick_along() const;

  std::optional<SliceQuestion> asked_;
  std::uint64_t shown_ = 0;
  double per_sample_s_ = 0;  ///< of the newest answer; 0: not known
  double moved_s_ = 0;       ///< when plane or drive last changed
  double shown_s_ = -1;      ///< when something was put into the picture last
  bool current_ = false;     ///< what is shown answers the last question
  double rest_until_s_ = 0;  ///< while a drive keeps changing, the processor stays free for half of the time
  bool busy_ = false;
  std::string fault_;
  session::AnswerThread<SliceQuestion, SliceAnswer> answers_;
};

}  // namespace palpa::viewer
