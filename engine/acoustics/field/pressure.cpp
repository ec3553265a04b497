#include "acoustics/field/pressure.hpp"
#include "array/drive.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

namespace palpa::acoustics {

using array::Directivity;
using array::Layout;
using array::Medium;
using array::SlotFocus;
using array::TransducerDrive;

std::complex<double> pressure_at(const Layout& layout, std::span<const TransducerDrive> drive, const Vec3& point,
                                 const Medium& medium, Directivity kind, double absorption_np_m) {
  assert(drive.size() == layout.transducers.size());
  const double turns_per_metre = medium.turns_per_metre();
  const double ka = 2 * std::numbers::pi * turns_per_metre * layout.transducer_radius_m;
  std::complex<double> sum = 0;
  for (std::size_t t = 0; t < drive.size(); ++t) {
    const auto& [position, axis] = layout.transducers[t];
    const Vec3 way = point - position;
    const double distance = glm::length(way);
    const double cosine = distance > 0 ? glm::dot(way, axis) / distance : 1.0;
    const double turns = distance * turns_per_metre;
    const double phase = drive[t].phase + 2 * std::numbers::pi * (turns - std::floor(turns));
    const double loud = drive[t].amplitude * directivity(kind, cosine, ka) * std::exp(-absorption_np_m * distance);
    sum += std::polar(loud / std::max(distance, layout.transducer_radius_m), phase);
  }
  return layout.source_level_pa_m * sum;
}

namespace {

FociPressure judged(std::vector<double> pascals, std::span<const SlotFocus> foci) {
  FociPressure result;
  double weakest = 0, strongest = 0, sum = 0;
  std::size_t counted = 0;
  for (std::size_t j = 0; j < foci.size(); ++j) {
    const double gain = gain_of(foci[j]);
    if (!drivable(foci[j]) || gain <= 0) continue;
    const double even = pascals[j] / gain;
    weakest = counted == 0 ? even : std::min(weakest, even);
    strongest = std::max(strongest, even);
    sum += pascals[j];
    ++counted;
  }
  if (counted > 0) result.mean = sum / static_cast<double>(counted);
  if (counted > 1) result.evenness = strongest > 0 ? weakest / strongest : 0.0;
  result.pascals = std::move(pascals);
  return result;
}

}  // namespace

FociPressure pressure_at_foci(const Layout& layout, std::span<const TransducerDrive> drive,
                              std::span<const SlotFocus> foci, const Medium& medium, Directivity kind) {
  std::vector<double> pascals;
  pascals.reserve(foci.size());
  for (const SlotFocus& focus : foci) {
    const bool sounds = drivable(focus);
    pascals.push_back(sounds ? std::abs(pressure_at(layout, drive, focus.position, medium, kind)) : 0.0);
  }
  return judged(std::move(pascals), foci);
}

FociPressure pressure_at_foci(const Layout& layout, std::span<const TransducerDrive> drive,
                              std::span<const SlotFocus> foci, const array::Transfer& transfer) {
  array::Columns columns;
  std::vector<double> pascals;
  pascals.reserve(foci.size());
  for (const SlotFocus& focus : foci) {
    std::complex<double> sum = 0;
    if (drivable(focus)) {
      const array::FocusSource source{focus.position, 0, 1};
      transfer.fill(std::span(&source, 1), array::Weighting::uniform, columns);
      for (std::size_t t = 0; t < drive.size(); ++t)
        sum += columns.transfer(t) * std::polar<double>(drive[t].amplitude, drive[t].phase);
    }
    pascals.push_back(layout.source_level_pa_m * std::abs(sum));
  }
  return judged(std::move(pascals), foci);
}

}  // namespace palpa::acoustics
