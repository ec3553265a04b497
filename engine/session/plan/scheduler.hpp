// From the fingers of a frame to their voices: the method's foci, the solid's haptics, tuning and order.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acoustics/felt/tune.hpp"
#include "acoustics/field/array_field.hpp"
#include "array/schedule.hpp"
#include "base/math.hpp"
#include "session/plan/feel.hpp"
#include "session/plan/solid_haptics.hpp"
#include "touch/methods/method.hpp"
#include "touch/types.hpp"

namespace palpa::session {

class TuningThread;

/// The values that are chosen by the perimeter of a finger's path of foci (acoustics/felt/tune.hpp).
enum class Tune {
  nothing,
  stride,  ///< the stride, for fingers that are followed from frame to frame
  all,     ///< foci, stride and dwell, for a single frame: another number of foci would move every focus
};

/// A method of the caller's: places the foci of a finger of that touch, at least one and at most touch::max_foci, as
/// the functions in touch/methods/method.hpp do. It is called on the thread that computes, and must not throw.
using OwnMethod = std::function<void(const touch::Touch& touch, const touch::Finger& finger, touch::Placement& out)>;

/// How fingers become voices. The haptics of a finger's solid override `voice`.
struct ScheduleOptions {
  /// Places the foci if own_method is empty. Otherwise it only says whether foci stand still or sound together: give
  /// single_focus if own_method places a single focus.
  touch::MethodOptions method;
  OwnMethod own_method{};
  array::VoiceOptions voice;
  Tune tune = Tune::nothing;
  acoustics::TuneOptions tuning;  ///< for Tune::all; callers must not set the field of its spectrum
  /// Width of a Gaussian spot that represents a focus. Empty: the array's field is used if there is an array.
  std::optional<double> spot_m;
  /// Gains do not change from slot to slot, and nothing clicks: for a link that is too slow.
  bool steady = false;
};

/// How a finger got its voice.
struct ScheduledFinger {
  touch::Placement placement;
  double perimeter_m = 0;                 ///< length of the path of its foci; 0: they stand still
  std::optional<acoustics::Tuned> tuned;  ///< with Tune::all, if foci move
};

/// Keeps the chosen strides from frame to frame.
class Scheduler {
 public:
  /// For touches of these solids, found with these parameters. Throws as resolve_haptics does. Tune::all uses the
  /// foci's sound from `field`, which must outlive this object. Without `field`, and for Tune::stride, foci are spots.
  /// `hold_s` is the session's.
  Scheduler(const std::string& scene, std::span<const geometry::Solid> solids, const touch::FingerOptions& touch,
            const ScheduleOptions& options, const acoustics::FocusField* field = nullptr, double hold_s = 0.1);
  ~Scheduler();
  Scheduler(Scheduler&&) noexcept;
  Scheduler& operator=(Scheduler&&) noexcept;

  /// Duration of one drive, see slot_length.
  double slot_s() const { return slot_s_; }
  const std::vector<SolidHaptics>& solids() const { return solids_; }

  /// Whether any solid requests a pressure.
  bool needs_pressures() const;

  /// Turns the fingers of a frame captured at `time_s` into the voices of `schedule`, one per finger, in the same
  /// order. Allocates nothing once `schedule` has enough memory (reserve).
  void make(const touch::Touch& touch, double time_s, array::Schedule& schedule, const Following& following = {});
  /// From the next make() on; see Feel::set_pose.
  void set_pose(std::uint32_t solid, const Transform& T_world_rest) { feel_.set_pose(solid, T_world_rest); }
  /// From the next make() on; see Feel::change.
  void change_feel(std::uint32_t solid, const FeelChange& change) { feel_.change(solid, change); }
  /// See Touches::take_over.
  void take_over(const Scheduler& other) { feel_.take_over(other.feel_); }
  /// From the next make() on, foci sound at this offset from where they are seen, metres in the world. This helps to
  /// find the real place of an array that stands elsewhere than assumed.
  void aim(const Vec3& offset) { aim_ = offset; }
  /// From the next make() on, fingers whose foci sound one after the other have only 1/n of them, evenly spread, but at
  /// least three. 1: all.
  void thin_foci(std::uint32_t part) { foci_part_ = part; }
  /// From now on, a thread computes the foci's sound from `field`, and strides use it when it is ready. `field` must
  /// outlive the thread; nullptr ends the thread. Does nothing without Tune::stride.
  void tune_beside(const acoustics::ArrayField* field);
  /// The thread of tune_beside(); nullptr if there is none.
  const TuningThread* tuning() const { return beside_.get(); }
  /// How the newest frame's fingers got their voices. Valid until the next make().
  std::span<const ScheduledFinger> fingers() const { return std::span(fingers_).first(count_); }

  /// The voice of a finger with skin all around, on a solid whose haptics have no schedule of their own: order, dwell
  /// and modulation. Its foci have no position.
  array::Voice common_voice() const;

 private:
  static constexpr std::uint32_t fewest_foci = 3;
  void thin(touch::Placement& placement, array::VoiceOptions& voice) const;
  void tune(const touch::Touch& touch, const touch::Finger& finger, double time_s, std::span<const Vec3> foci,
            array::VoiceOptions& voice, ScheduledFinger& out);

  std::vector<SolidHaptics> solids_;
  std::uint32_t foci_;
  ScheduleOptions options_;
  double slot_s_;
  Feel feel_;
  Vec3 aim_{0};
  std::uint32_t foci_part_ = 1;
  acoustics::StrideTuner strides_;
  std::unique_ptr<TuningThread> beside_;
  std::vector<ScheduledFinger> fingers_;
  std::size_t count_ = 0;
};

}  // namespace palpa::session
