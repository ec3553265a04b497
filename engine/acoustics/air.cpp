#include "acoustics/air.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"

namespace palpa::acoustics {
namespace {

constexpr double zero_celsius = 273.15;
constexpr double gas_constant = 287.05;  // of dry air, J/(kg K)

/// Throws bad_usage outside the range, and for NaN.
void check(double value, double low, double high, const char* what, const char* unit) {
  if (value >= low && value <= high) return;
  throw bad_usage(fmt::format("{} of {} {} is out of range: give {} to {}", what, value, unit, low, high));
}

double absorption_np_m(const Weather& weather, double hz) {
  const double kelvin = weather.celsius + zero_celsius;
  const double warm = kelvin / 293.15;                // divided by the reference temperature
  const double dense = weather.pressure_pa / 101325;  // divided by the reference pressure
  const double triple_point = 273.16;
  const double saturation = std::pow(10, -6.8346 * std::pow(triple_point / kelvin, 1.261) + 4.6151);
  const double water = weather.humidity_percent * saturation / dense;  // molar concentration, percent
  const double oxygen_hz = dense * (24 + 4.04e4 * water * (0.02 + water) / (0.391 + water));
  const double nitrogen_hz = dense / std::sqrt(warm) * (9 + 280 * water * std::exp(-4.170 * (1 / std::cbrt(warm) - 1)));
  const double square = hz * hz;
  const double relaxing = 0.01275 * std::exp(-2239.1 / kelvin) / (oxygen_hz + square / oxygen_hz) +
                          0.1068 * std::exp(-3352.0 / kelvin) / (nitrogen_hz + square / nitrogen_hz);
  return square * (1.84e-11 * std::sqrt(warm) / dense + std::pow(warm, -2.5) * relaxing);
}

}  // namespace

double Air::wave_number() const {
  return 2 * std::numbers::pi * medium.turns_per_metre();
}
double Air::stiffness_pa() const {
  return density_kg_m3 * medium.sound_speed * medium.sound_speed;
}

Air air_of(const Weather& weather, double hz, const std::optional<double>& sound_speed) {
  check(weather.humidity_percent, 0, 100, "a humidity", "percent");
  check(weather.pressure_pa, least_air_pressure_pa, most_air_pressure_pa, "an air pressure", "Pa");
  check(hz, array::least_frequency, array::most_frequency, "a frequency", "Hz");
  if (sound_speed) check(*sound_speed, array::least_sound_speed, array::most_sound_speed, "a sound speed", "m/s");
  const double by_temperature = array::sound_speed_at(weather.celsius);  // throws for invalid temperatures
  Air air;
  air.medium = {sound_speed.value_or(by_temperature), hz};
  air.density_kg_m3 = weather.pressure_pa / (gas_constant * (weather.celsius + zero_celsius));
  air.absorption_np_m = absorption_np_m(weather, hz);
  return air;
}

Air without_absorption(Air air) {
  air.absorption_np_m = 0;
  return air;
}

}  // namespace palpa::acoustics
