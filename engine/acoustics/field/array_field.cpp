#include "acoustics/field/array_field.hpp"

#include <algorithm>

namespace palpa::acoustics {

using array::Columns;
using array::FocusSource;

ArrayField::ArrayField(const array::Layout& layout, const array::DriveOptions& drive)
    : layout_(layout), weighting_(drive.weighting), farthest_(layout), step_m_(1 / drive.medium.turns_per_metre() / 6) {
  transfer_.set(layout, drive.medium, drive.directivity);
}

namespace {

/// Transducers processed at once: their data stay in the processor's caches, and cancelling takes effect soon.
constexpr std::size_t batch = 64;

/// Adds the pressure of these transducers in the paper's phasors: p = G B.
void add(const Columns& columns, std::size_t every, std::span<double> re, std::span<double> im) {
  const std::size_t places = columns.foci;
  std::vector<double> give_re(places), give_im(places);
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    const std::size_t first = n * places;
    for (std::size_t i = 0; i < places; ++i) {
      give_re[i] = columns.loud[first + i] * columns.cosine[first + i];
      give_im[i] = columns.loud[first + i] * columns.sine[first + i];
    }
    for (std::size_t focus = 0; focus < places; focus += every) {
      const double ask_re = columns.asked[first + focus] * columns.cosine[first + focus];
      const double ask_im = columns.asked[first + focus] * columns.sine[first + focus];
      double* const row_re = &re[focus / every * places];
      double* const row_im = &im[focus / every * places];
      for (std::size_t i = 0; i < places; ++i) {
        row_re[i] += give_re[i] * ask_re + give_im[i] * ask_im;
        row_im[i] += give_im[i] * ask_re - give_re[i] * ask_im;
      }
    }
  }
}

}  // namespace

bool ArrayField::felt(std::span<const Vec3> path, std::size_t every, std::vector<double>& pressures,
                      const std::atomic<bool>* give_up) const {
  std::vector<FocusSource> sources;
  sources.reserve(path.size());
  for (const Vec3& place : path)
    sources.push_back({place, farthest_.distance_from(place), 1});
  const std::size_t foci = (path.size() + every - 1) / every, transducers = layout_.transducers.size();
  pressures.assign(foci * path.size(), 0);
  std::vector<double> imaginary(pressures.size());
  Columns columns;
  for (std::size_t first = 0; first < transducers; first += batch) {
    if (give_up && *give_up) return false;
    transfer_.fill(sources, weighting_, first, std::min(batch, transducers - first), columns);
    add(columns, every, pressures, imaginary);
  }
  for (std::size_t e = 0; e < pressures.size(); ++e)
    pressures[e] = pressures[e] * pressures[e] + imaginary[e] * imaginary[e];
  return true;
}

}  // namespace palpa::acoustics
