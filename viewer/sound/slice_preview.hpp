// The field in a plane, computed beside whoever draws it, by the engine's field pass on a device of its own: coarse
// while plane or drive change, so that it keeps up with a hand, and finer once they rest.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "gpu/device.hpp"
#include "session/previews/beside.hpp"
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
  double seconds = 0;  ///< that it took
};

class SlicePreview {
 public:
  /// The device is made beside, too. Where it gives up is between two answers: half a second at most.
  explicit SlicePreview(gpu::DeviceOptions device);

  /// Asks where plane or drive are others than asked last, or finer where they have rested, and puts into the picture
  /// what has been answered. Waits for nothing.
  Change look(const Sounding& now, const SliceState& slice, Picture& picture, double now_s);
  /// The picture is another: all of it is to be shown again.
  void forget();
  /// Whether the picture will change by itself.
  bool busy() const { return busy_; }
  /// Why there is nothing; else empty.
  const std::string& fault() const { return fault_; }

  static constexpr std::uint32_t coarsest = 24, finest = 192;

 private:
  std::uint32_t quick_along() const;

  std::optional<SliceQuestion> asked_;
  std::uint64_t shown_ = 0;
  double per_sample_s_ = 0;  ///< of the newest answer; 0: nobody knows
  double moved_s_ = 0;       ///< when plane or drive were others last
  double shown_s_ = -1;      ///< when something was put into the picture last
  bool current_ = false;     ///< that is of what was asked last
  double rest_until_s_ = 0;  ///< a drive that keeps changing leaves the processor half of its time
  bool busy_ = false;
  std::string fault_;
  session::Beside<SliceQuestion, SliceAnswer> beside_;
};

}  // namespace palpa::viewer
