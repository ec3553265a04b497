// From the fingers of a frame to what they play: where the method puts their foci, their solid's haptics, tuning,
// order.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acoustics/felt/tune.hpp"
#include "acoustics/field/array_field.hpp"
#include "array/schedule.hpp"
#include "base/math.hpp"
#include "session/plan/solid_haptics.hpp"
#include "touch/foci/method.hpp"
#include "touch/types.hpp"

namespace palpa::session {

class TuningThread;

/// What is chosen by the perimeter that a finger's foci run around (acoustics/felt/tune.hpp).
enum class Tune {
  nothing,
  stride,  ///< the stride, of fingers that are followed from frame to frame
  all,     ///< foci, stride and dwell, for a single frame: another number of foci would move every focus
};

/// How fingers become voices. What the haptics of a finger's solid ask for takes the place of `voice`.
struct ScheduleOptions {
  touch::MethodOptions method;  ///< places the foci
  array::VoiceOptions voice;
  Tune tune = Tune::nothing;
  acoustics::TuneOptions tuning;  ///< of Tune::all; its spectrum's field is not for the user to give
  /// How wide a Gaussian spot stands for a focus; nothing: the array's field where there is an array.
  std::optional<double> spot_m;
};

/// How a finger came to its voice.
struct ScheduledFinger {
  touch::Placement placement;
  double perimeter_m = 0;                 ///< of the path of its foci; 0: they stand still
  std::optional<acoustics::Tuned> tuned;  ///< with Tune::all, of foci that move
};

/// Remembers the strides that it chose from frame to frame.
class Scheduler {
 public:
  /// For touches of these solids, found with these parameters. Throws as resolve_haptics does. Tune::all takes what
  /// `field`, which outlives it, makes of the foci; without it they are spots, as they are of Tune::stride.
  Scheduler(const std::string& scene, std::span<const geometry::Solid> solids, const touch::Parameters& touch,
            const ScheduleOptions& options, const acoustics::FocusField* field = nullptr);
  ~Scheduler();
  Scheduler(Scheduler&&) noexcept;
  Scheduler& operator=(Scheduler&&) noexcept;

  /// How long one drive lasts: see slot_length.
  double slot_s() const { return slot_s_; }
  const std::vector<SolidHaptics>& solids() const { return solids_; }
  /// Whether the method looks at the contacts themselves, see touch::needs_contacts.
  bool needs_contacts() const { return touch::needs_contacts(options_.method); }

  /// Whether some solid asks for a pressure.
  bool needs_pressures() const;

  /// Turns the fingers of a frame captured at `time_s` into the voices of `schedule`, one each, in their order.
  /// Allocates nothing once `schedule` has the room (reserve).
  void make(const touch::Touch& touch, double time_s, array::Schedule& schedule);
  /// From the next make on foci sound so far from where they are seen, metres in the world: an array that stands
  /// elsewhere than one thinks is found by it.
  void aim(const Vec3& offset) { aim_ = offset; }
  /// From the next make on fingers whose foci follow one another have an n-th of them, evenly spread and three at
  /// least; 1: all.
  void thin_foci(std::uint32_t part) { foci_part_ = part; }
  /// From now on a thread computes what `field`, which outlives that, makes of the foci, and strides follow it when it
  /// is ready; nullptr ends the thread. Nothing without Tune::stride.
  void tune_beside(const acoustics::ArrayField* field);
  /// That thread; nullptr without one.
  const TuningThread* tuning() const { return beside_.get(); }
  /// How the newest frame's fingers came to their voices, valid until the next make.
  std::span<const ScheduledFinger> fingers() const { return std::span(fingers_).first(count_); }

  /// What a finger plays, its skin all around, on a solid whose haptics ask for no schedule of their own: order, dwell
  /// and modulation. Its foci have no place.
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
  Vec3 aim_{0};
  std::uint32_t foci_part_ = 1;
  acoustics::StrideTuner strides_;
  std::unique_ptr<TuningThread> beside_;
  std::vector<ScheduledFinger> fingers_;
  std::size_t count_ = 0;
};

}  // namespace palpa::session
