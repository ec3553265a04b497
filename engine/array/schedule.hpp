// Which focus sounds when. Pure values: no clock, no thread.
//
// Time is counted in slots of `slot_s` from slot 0, which is the loop's first and never comes again: a new frame brings
// a new Schedule, and the counter runs on into it. At 90 Hz a frame lasts 7.4 slots; starting every frame at the head
// of the order would never play its tail.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "array/drive.hpp"
#include "base/math.hpp"
#include "base/words.hpp"

namespace palpa::array {

/// The paper's order of the foci: 0, stride, 2 stride, ... modulo `count`. Throws bad_usage where count is 0 or shares
/// a divisor with the stride, since such an order leaves foci out. One focus has the order 0 whatever the stride.
std::vector<std::uint32_t> fill_order(std::uint32_t count, std::uint32_t stride);
/// The same into a vector whose storage is kept.
void fill_order(std::uint32_t count, std::uint32_t stride, std::vector<std::uint32_t>& order);

/// What a modulation makes a sine of. Skin feels the radiation pressure, which is the square of the amplitude.
enum class Modulation {
  pressure_sine,   ///< the pressure: its amplitude is the square root of a raised sine
  amplitude_sine,  ///< the amplitude itself: its pressure also has a line at twice the frequency
};

inline constexpr Word<Modulation> modulation_words[] = {{"pressure-sine", Modulation::pressure_sine},
                                                        {"amplitude-sine", Modulation::amplitude_sine}};

/// One finger's part of a schedule.
struct Voice {
  std::uint32_t id = 0;              ///< the finger's, stable for as long as it is followed
  std::uint32_t solid = 0;           ///< what it touches: index into the scene's solids
  std::vector<Vec3> foci;            ///< metres; one per sector, none of them empty
  std::vector<std::uint32_t> order;  ///< indices into `foci`, as they play
  std::uint32_t foci_per_slot = 1;   ///< that many entries of `order` sound together; `multi-focus`: all of them
  double dwell_s = 1.5e-3;           ///< how long each lasts
  double modulation_hz = 0;          ///< see modulation_gain; 0: none
  Modulation modulation = Modulation::pressure_sine;
  double gain = 1;  ///< intensity, 0..1: an amplitude that the modulation multiplies
  /// Asked for at each focus, peak, at the modulation's crest and a gain of 1; 0: nobody asks.
  double pressure_pa = 0;
  /// What of it, times the gain, is to sound; loudness.hpp fills both. `reached_pa` is what sounds at the focus that
  /// has the least, and nothing where no voice of the schedule asks.
  double target_pa = 0;
  std::optional<double> reached_pa;
};

struct Schedule {
  double slot_s = 1.5e-3;     ///< the tick: how long one drive lasts; not longer than any voice's dwell
  std::vector<Voice> voices;  ///< only the first `voice_count` are valid; the others keep their storage for later
  std::uint32_t voice_count = 0;
  double time_s = 0;  ///< capture time of the frame that it was made from

  /// The next free voice, its vectors' storage kept from earlier use.
  Voice& add_voice();
  void clear() { voice_count = 0; }
};

/// No array comes near it. Linear acoustics ends far below, at linear_pressure_pa: harmonics take what is more.
inline constexpr double most_pressure_pa = 1e5;
inline constexpr double linear_pressure_pa = 1e4;

/// How the foci of a finger are to play, whatever finger it is.
struct VoiceOptions {
  /// Coprime to the number of foci; nothing: the usual one of that number (geometry::usual_stride).
  std::optional<std::uint32_t> stride;
  double dwell_s = 1.5e-3;
  double gain = 1;  ///< intensity, 0..1
  /// Peak at each focus at a gain of 1, above 0 to most_pressure_pa; nothing: as loud as the array's drives come out.
  std::optional<double> pressure_pa;
  double modulation_hz = 200;  ///< of fingers whose foci stand still; the others are not modulated
  Modulation modulation = Modulation::pressure_sine;
};

/// Replaces `out` by the foci of slot `slot`, voice after voice: the entry floor(slot slot_s / dwell) modulo its number
/// of steps of each voice's order, with the voice's gain times its modulation. Counts in whole nanoseconds, so that no
/// rounding makes a step late; exact for 10^13 slots of 1.5 ms. Nothing for no voices; how long a schedule
/// may play is for the caller to say.
void foci_of_slot(const Schedule& schedule, std::uint64_t slot, std::vector<SlotFocus>& out);

/// Amplitude of a finger modulated at `hz`, `time_s` after the beginning of slot 0: s = (1 + sin(2 pi hz t)) / 2 or its
/// square root, and 1 where hz is 0. It holds for a slot's whole length and is sampled at its midpoint: at 1.5 ms,
/// 200 Hz has 3.3 samples per period.
double modulation_gain(Modulation modulation, double hz, double time_s);

/// A pressure that is asked for never falls below that part of its crest: then it is a pressure still, and not whatever
/// is heard of others.
inline constexpr double least_modulation = 0.01;

/// Whether all voices have the same modulation: then it is one scalar over the whole drive. True for no voices.
bool shared_modulation(const Schedule& schedule);

/// Number of slots after which foci and gains repeat, or 0 if that is more than `most` or than 2^32 - 1. 1 for no
/// voices.
std::uint64_t cycle_length(const Schedule& schedule, std::uint64_t most);

}  // namespace palpa::array
