#include "acoustics/felt/skin.hpp"

#include <cmath>

namespace palpa::acoustics {

double vibration_sensitivity(double hz) {
  if (!(hz > 0)) return 0;
  const double x = hz / best_felt_hz;
  return 2 / (x * x + 1 / (x * x));
}

double flutter_sensitivity(double hz) {
  if (!(hz > 0)) return 0;
  constexpr double low_hz = 5, high_hz = 50;
  const double below = low_hz * low_hz / (hz * hz), above = hz * hz / (high_hz * high_hz);
  return 1 / std::sqrt((1 + below * below) * (1 + above * above));
}

double balance(const Felt& felt) {
  return felt.vibration - flutter_weight * felt.flutter;
}

double felt_as_vibration(const Line& line) {
  return vibration_sensitivity(line.frequency_hz) * line.around;
}

Felt felt(const Spectrum& spectrum) {
  Felt felt;
  if (!(spectrum.variance > 1e-12)) return felt;
  for (const Line& line : spectrum.lines) {
    const double vibration = felt_as_vibration(line);
    const double flutter = flutter_sensitivity(line.frequency_hz) * line.around;
    felt.vibration += vibration * vibration / 2 / spectrum.variance;
    felt.flutter += flutter * flutter / 2 / spectrum.variance;
  }
  return felt;
}

std::size_t strongest_felt(const Spectrum& spectrum) {
  std::size_t best = spectrum.lines.size();
  double most = 0;
  for (std::size_t i = 0; i < spectrum.lines.size(); ++i) {
    const double felt = felt_as_vibration(spectrum.lines[i]);
    if (felt > most * (1 + 1e-9)) {
      most = felt;
      best = i;
    }
  }
  return best;
}

}  // namespace palpa::acoustics
