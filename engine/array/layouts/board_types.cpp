#include "array/layouts/board_types.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

namespace palpa::array {
namespace {

/// A few roundings of a float: a step times a factor of 1 must remain that step.
constexpr float rounding = 1 + 5e-7f;

// AUTD3: 18 x 14 places at 10.16 mm, three of them occupied by screws and the connector; index along x first.
constexpr int autd3_columns = 18;
constexpr int autd3_rows = 14;
constexpr double autd3_pitch = 0.01016;

bool autd3_missing(int x, int y) {
  return y == 1 && (x == 1 || x == 2 || x == 16);
}

void add_autd3(std::vector<Vec3>& places) {
  for (int y = 0; y < autd3_rows; ++y) {
    for (int x = 0; x < autd3_columns; ++x) {
      if (autd3_missing(x, y)) continue;
      places.emplace_back((x - 0.5 * (autd3_columns - 1)) * autd3_pitch, (y - 0.5 * (autd3_rows - 1)) * autd3_pitch,
                          0.0);
    }
  }
}

// The 16 x 16 boards: 10.5 mm, seen from the side on which they emit sound.
constexpr int square_side = 16;
constexpr double square_pitch = 0.0105;
constexpr double square_width = square_side * square_pitch;

Vec3 square_place(int right, int up) {
  return {(right - 7.5) * square_pitch, (up - 7.5) * square_pitch, 0.0};
}

/// Down a column, then the next one to the right.
void add_openmpd(std::vector<Vec3>& places) {
  for (int column = 0; column < square_side; ++column) {
    for (int row = 0; row < square_side; ++row)
      places.push_back(square_place(column, square_side - 1 - row));
  }
}

/// Along a row, from the bottom. On the side with the components, row 0 is at the top.
void add_sonicsurface(std::vector<Vec3>& places) {
  for (int row = 0; row < square_side; ++row) {
    for (int column = 0; column < square_side; ++column)
      places.push_back(square_place(column, row));
  }
}

/// The amplitude of a pulse that lasts this part of half a period.
double pulse_amplitude(double part) {
  return part < 1 ? std::sin(part * std::numbers::pi / 2) : 1;
}

/// 64 pulse widths, which a board is sent as they are.
const AmplitudeSteps* openmpd_amplitudes() {
  static const AmplitudeSteps steps([] {
    std::vector<AmplitudeSteps::Step> widths;
    for (int width = 0; width <= 64; ++width)
      widths.push_back({pulse_amplitude(width / 64.0), static_cast<std::uint8_t>(width)});
    return widths;
  }());
  return &steps;
}

/// Of 256 pulse widths, those that an intensity of 0 to 255 selects: round(256 asin(intensity / 255) 2 / pi). A board
/// is sent the least intensity of each.
const AmplitudeSteps* autd3_amplitudes() {
  static const AmplitudeSteps steps([] {
    std::vector<AmplitudeSteps::Step> widths;
    for (int intensity = 0; intensity <= 255; ++intensity) {
      const double width = std::round(512 / std::numbers::pi * std::asin(intensity / 255.0));
      if (const double level = pulse_amplitude(width / 256); widths.empty() || level > widths.back().level)
        widths.push_back({level, static_cast<std::uint8_t>(intensity)});
    }
    return widths;
  }());
  return &steps;
}

/// A lattice in the plane: whatever share of the transducers is on, they are evenly spread.
std::uint32_t sonicsurface_turn(std::uint32_t transducer) {
  constexpr std::uint32_t count = square_side * square_side;
  static const auto turns = [] {
    constexpr double along_row = 0.7548776662466927, along_column = 0.5698402909980532;
    std::array<double, count> value{};
    for (std::uint32_t t = 0; t < count; ++t) {
      const double place = along_row * (t % square_side) + along_column * (t / square_side);
      value[t] = place - std::floor(place);
    }
    std::array<std::uint32_t, count> order{}, turn{};
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::sort(order, {}, [&](std::uint32_t t) { return value[t]; });
    for (std::uint32_t i = 0; i < count; ++i)
      turn[order[i]] = i;
    return turn;
  }();
  return turns[transducer % count];
}

/// The units' silencer: phases change during the slot, and amplitudes in 0.25 ms.
Changes autd3_changes(const ChangeSetting& setting) {
  constexpr std::uint32_t most_phase_steps = 255, most_amplitude_steps = 10;
  return {.phase_steps = std::min(setting.periods(), most_phase_steps),
          .amplitude_steps = std::min(setting.periods(), most_amplitude_steps),
          .silence_jumps = false};
}

/// 0.25 ms, or longer, so that the 254 samples of a message hold a cycle: one of these lengths that divides the
/// cycle best, since it is played as a whole number of samples.
double autd3_modulation_slot(double hz) {
  constexpr double usual_periods = 10, most_periods = 65535, most_samples = 254;
  const double least = std::ceil(board_frequency_hz / (most_samples * hz));
  if (least <= usual_periods) return usual_periods / board_frequency_hz;
  double best = std::min(least, most_periods), best_miss = 1;
  for (double periods = best; periods <= std::min(1.125 * least, most_periods); ++periods) {
    const double samples = board_frequency_hz / (periods * hz);
    const double miss = std::abs(samples - std::round(samples)) / samples;
    if (miss > best_miss - 1e-9) continue;
    best_miss = miss;
    best = periods;
  }
  return best / board_frequency_hz;
}

/// Frames of 0.1 ms, or of half a slot if that is shorter, during the slot except for its last frame.
Changes openmpd_changes(const ChangeSetting& setting) {
  constexpr std::uint32_t usual_periods = 4;
  constexpr double most_steps = 14;                      // silence waits for them
  constexpr double bus_frames_per_s = 40e6 / (2 * 256);  // of all its boards
  const std::uint32_t periods = std::clamp(setting.periods() / 2, 1U, usual_periods);
  const double room = std::max(setting.periods() / periods, 2U) - 1;
  const double carried = std::floor(bus_frames_per_s / static_cast<double>(setting.boards_of_bus) * setting.slot_s);
  const auto steps = static_cast<std::uint32_t>(std::max(1.0, std::min({room, carried, most_steps})));
  return {.step_periods = periods, .phase_steps = steps, .amplitude_steps = steps};
}

/// A phase is a byte, and so are the beginning and the end of a frame; the boards' actual speed at 230400 baud.
double sonicsurface_moving_slot_s(std::size_t boards) {
  constexpr double byte_s = 10 / 227556.0;
  constexpr std::size_t phases = 256;
  return byte_s * static_cast<double>(boards == 1 ? phases + 2 : boards * (phases + 2) + 1);
}

constexpr BoardType types[] = {
    {.name = "autd3",
     .title = "AUTD3",
     .width_m = 0.192,
     .height_m = 0.1514,
     .pitch_m = autd3_pitch,
     .add_places = add_autd3,
     .phase_steps = 256,
     .null_depth = 0.00224,
     .amplitudes = autd3_amplitudes,
     .changes = autd3_changes,
     .modulation_slot_s = autd3_modulation_slot,
     .link_words = "a server's host and port, or autd3-udp with a network interface"},
    {.name = "openmpd",
     .title = "OpenMPD",
     .width_m = square_width,
     .height_m = square_width,
     .pitch_m = square_pitch,
     .add_places = add_openmpd,
     .phase_steps = 128,
     .null_depth = 0.004,
     .amplitudes = openmpd_amplitudes,
     .few_amplitudes = 0.25,
     .follower_lag = 0.762,
     .changes = openmpd_changes,
     .may_jump = true,
     .still_slot_s = 0.3e-3,
     .link_words = "serial numbers"},
    {.name = "sonicsurface",
     .title = "SonicSurface",
     .width_m = square_width,
     .height_m = square_width,
     .pitch_m = square_pitch,
     .add_places = add_sonicsurface,
     .phase_steps = 32,
     .null_depth = 0.0126,
     .turn = sonicsurface_turn,
     .follower_lag = 16.5 / 32,
     .moving_slot_s = sonicsurface_moving_slot_s,
     .link_words = "a serial port"},
};

}  // namespace

AmplitudeSteps::AmplitudeSteps(const std::vector<Step>& steps) {
  for (const Step& step : steps) {
    levels_.push_back(static_cast<float>(step.level));
    codes_.push_back(step.code);
  }
  assert(levels_.size() > 1 && levels_.size() <= 256 && levels_.front() == 0 && levels_.back() == 1);
  std::size_t number = 0;
  for (std::size_t i = 0; i <= entries; ++i) {
    while (number + 1 < levels_.size() && levels_[number + 1] * entries <= static_cast<float>(i))
      ++number;
    below_[i] = static_cast<std::uint8_t>(number);
  }
}

std::size_t AmplitudeSteps::below(float amplitude) const {
  if (!(amplitude > 0)) return 0;
  const float wanted = std::min(amplitude * rounding, 1.0f);
  std::size_t number = below_[static_cast<std::size_t>(wanted * entries)];
  while (number + 1 < levels_.size() && levels_[number + 1] <= wanted)
    ++number;
  return number;
}

std::size_t AmplitudeSteps::nearest(float amplitude, std::size_t most) const {
  const std::size_t number = below(amplitude);
  if (number >= most) return most;
  return amplitude - levels_[number] > levels_[number + 1] - amplitude ? number + 1 : number;
}

std::span<const BoardType> board_types() {
  return types;
}

const BoardType* find_board_type(std::string_view name) {
  const auto* const found = std::ranges::find(types, name, &BoardType::name);
  return found == std::end(types) ? nullptr : found;
}

std::string known_board_types() {
  std::string names;
  for (const BoardType& type : types) {
    if (!names.empty()) names += ", ";
    names += type.name;
  }
  return names;
}

}  // namespace palpa::array
