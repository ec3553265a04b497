// Which focus sounds when. Plain values: no clock, no thread.
//
// Time is counted in slots of `slot_s` from slot 0, the first of the loop. The counter never restarts: a new frame
// brings a new Schedule, and the count continues. At 90 Hz a frame lasts 7.4 slots, so a restart at every frame would
// never play the tail of the order.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "array/course.hpp"
#include "array/drive_options.hpp"
#include "base/math.hpp"
#include "base/words.hpp"

namespace palpa::array {

/// The paper's order of the foci: 0, stride, 2 stride, ... modulo `count`. Throws bad_usage if count is 0 or shares a
/// divisor with the stride, because such an order leaves foci out. One focus has the order 0 for any stride.
std::vector<std::uint32_t> fill_order(std::uint32_t count, std::uint32_t stride);
/// The same into a vector whose storage is reused.
void fill_order(std::uint32_t count, std::uint32_t stride, std::vector<std::uint32_t>& order);

/// The quantity that a modulation makes a sine. Skin feels the radiation pressure, the square of the amplitude.
enum class Modulation {
  pressure_sine,   ///< the pressure: its amplitude is the square root of a raised sine
  amplitude_sine,  ///< the amplitude itself: its pressure also has a line at twice the frequency
};

inline constexpr Word<Modulation> modulation_words[] = {{"pressure-sine", Modulation::pressure_sine},
                                                        {"amplitude-sine", Modulation::amplitude_sine}};

/// One finger's part of a schedule.
struct Voice {
  std::uint32_t id = 0;              ///< the finger's, stable for as long as it is followed
  std::uint32_t solid = 0;           ///< the touched object: index into the scene's solids
  std::vector<Vec3> foci;            ///< metres; all have a position
  Vec3 velocity{0};                  ///< m/s: the foci move on together, see Advance
  std::vector<std::uint32_t> order;  ///< indices into `foci`, as they play
  std::uint32_t foci_per_slot = 1;   ///< number of entries of `order` that sound together; `multi-focus`: all of them
  double dwell_s = 1.5e-3;           ///< how long each lasts
  double modulation_hz = 0;          ///< see modulation_gain; 0: none
  Modulation modulation = Modulation::pressure_sine;
  double gain = 1;  ///< intensity, 0..1: an amplitude that the modulation multiplies
  Course course;    ///< multiplies the gain, too
  /// Requested peak pressure at each focus, at the crest of the modulation and a gain of 1: above 0.
  std::optional<double> pressure_pa;
  /// The part of the request, times the gain, that is played; loudness.hpp fills both values. `reached_pa` is the
  /// pressure at the weakest focus. It is nullopt if no voice of the schedule has a request.
  double target_pa = 0;
  std::optional<double> reached_pa;

  /// The request, times the gain; 0 without one.
  double asked_pa() const { return pressure_pa.value_or(0) * gain; }
};

/// How foci with a velocity move on from slot to slot. Each slot has a time, relative to the one at which the foci are
/// at their places. The times ascend during the first `cycles` cycles; then those of the last of these cycles repeat.
struct Advance {
  std::uint64_t first_slot = 0;  ///< a slot before it has the time of the slot at the same place in the first cycle
  std::uint32_t cycle = 0;       ///< slots; 0: the foci stand still
  std::uint32_t cycles = 2;
  double first_s = 0;  ///< the time of the middle of `first_slot`
  double most_s = 0;   ///< later slots have this time

  bool moves() const { return cycle > 0; }
  /// The slots with different times, counted from `first_slot`.
  std::uint32_t listed() const { return cycle * cycles; }
  /// Which of them a slot is like.
  std::uint32_t number_of(std::uint64_t slot) const;
  double time_of(std::uint64_t slot, double slot_s) const;
};

struct Schedule {
  double slot_s = 1.5e-3;     ///< the tick: how long one drive lasts; at most any voice's dwell
  std::vector<Voice> voices;  ///< only the first `voice_count` are valid; the others keep their storage for reuse
  std::uint32_t voice_count = 0;
  double time_s = 0;  ///< capture time of the frame it was made from
  Advance advance;
  /// Each entry of an order belongs to the slot that plays it next, and to no other: a link that forwards foci sends
  /// them slot by slot.
  bool once = false;
  /// The names of the solids, if they are not those that the schedule's receiver knows: the scene was read again.
  std::shared_ptr<const std::vector<std::string>> solid_names{};

  /// The next free voice, with its vectors' storage from earlier use.
  Voice& add_voice();
  void clear() {
    voice_count = 0;
    advance = {};
    once = false;
  }
};

/// Reserves memory for `voices` voices of `foci` foci each.
void reserve(Schedule& schedule, std::uint32_t voices, std::uint32_t foci);

/// No array comes near this limit. Linear acoustics ends far below, at linear_pressure_pa: beyond that, the energy goes
/// into harmonics.
inline constexpr double most_pressure_pa = 1e5;
inline constexpr double linear_pressure_pa = 1e4;

/// How the foci of any finger play.
struct VoiceOptions {
  /// Coprime to the number of foci; nullopt: the default for that number (geometry::default_stride).
  std::optional<std::uint32_t> stride;
  double dwell_s = 1.5e-3;
  double gain = 1;  ///< intensity, 0..1
  /// Peak at each focus at a gain of 1, above 0 to most_pressure_pa; nullopt: whatever the array's drives give.
  std::optional<double> pressure_pa;
  double modulation_hz = 200;  ///< of fingers whose foci stand still; others are not modulated
  Modulation modulation = Modulation::pressure_sine;
};

/// Replaces `out` by the foci of slot `slot`, at their places in it, voice after voice: the entry floor(slot slot_s /
/// dwell) modulo its number of steps of each voice's order, with the voice's gain times its modulation and its course
/// (modulate). Counts in whole nanoseconds, so that rounding delays no step; exact for 10^13 slots of 1.5 ms. Empty
/// without voices. The caller decides how long a schedule may play.
void foci_of_slot(const Schedule& schedule, std::uint64_t slot, std::vector<SlotFocus>& out);

/// Amplitude of a finger modulated at `hz`, `time_s` after the start of slot 0: s = (1 + sin(2 pi hz t)) / 2 or its
/// square root, and 1 if hz is 0. It is constant during a slot and sampled at the slot's midpoint: at 1.5 ms, 200 Hz
/// has 3.3 samples per period.
double modulation_gain(Modulation modulation, double hz, double time_s);

/// A requested pressure never falls below this share of its crest. It thus stays a controlled pressure instead of
/// whatever is heard of others.
inline constexpr double least_modulation = 0.01;

/// Whether all voices have the same modulation and course, which are then one scalar over the whole drive. True without
/// voices.
bool shared_modulation(const Schedule& schedule);

/// Whether some voice has a course that changes its gain from slot to slot.
bool changes(const Schedule& schedule);
/// The newest first_slot of these courses; 0 if there is no such course.
std::uint64_t first_changing_slot(const Schedule& schedule);

/// Number of slots after which foci and gains repeat, apart from places that advance. 0 if they do not (changes()), and
/// if that exceeds `most` or 2^32 - 1. 1 without voices.
std::uint64_t cycle_length(const Schedule& schedule, std::uint64_t most);

}  // namespace palpa::array
