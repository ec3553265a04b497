#include "array/free_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace palpa::array {
namespace {

/// Rounds to the nearest whole number, within 2^51; written so that compilers vectorise loops over it.
double nearest(double x) {
  constexpr double shift = 6755399441055744.0;  // 1.5 * 2^52
  return (x + shift) - shift;
}

/// sin(2 pi x) for x in -1/4..1/4: Taylor's series, with a remainder below 1e-15.
double sine_of_turns(double x) {
  constexpr double turn = 2 * std::numbers::pi;
  constexpr std::array<double, 10> inverse_factorials{1.0,
                                                      -1.0 / 6,
                                                      1.0 / 120,
                                                      -1.0 / 5040,
                                                      1.0 / 362880,
                                                      -1.0 / 39916800,
                                                      1.0 / 6227020800,
                                                      -1.0 / 1307674368000,
                                                      1.0 / 355687428096000,
                                                      -1.0 / 121645100408832000};
  const double y = x * turn;
  const double square = y * y;
  double series = inverse_factorials[9];
  for (int i = 8; i >= 0; --i)
    series = series * square + inverse_factorials[i];
  return y * series;
}

}  // namespace

void FreeField::set(const Layout& layout, const Medium& medium, Directivity kind) {
  layout_ = &layout;
  turns_per_metre_ = medium.turns_per_metre();
  const double ka = 2 * std::numbers::pi * turns_per_metre_ * layout.transducer_radius_m;
  if (!table_.empty() && kind_ == kind && ka_ == ka) return;
  table_ = directivity_table(kind, ka);
  kind_ = kind;
  ka_ = ka;
}

void FreeField::fill(std::span<const FocusSource> foci, Weighting weighting, Columns& columns) const {
  fill(foci, weighting, 0, layout_->transducers.size(), columns);
}

void FreeField::fill(std::span<const FocusSource> foci, Weighting weighting, std::size_t first, std::size_t count,
                     Columns& columns) const {
  const Layout& layout = *layout_;
  const double turns_per_metre = turns_per_metre_, radius = layout.transducer_radius_m;
  columns.foci = foci.size();
  columns.transducers = count;
  const std::size_t entries = columns.foci * columns.transducers;
  for (std::vector<double>* values : {&columns.cosine, &columns.sine, &columns.loud, &columns.asked})
    values->resize(entries);

  double* const turns = columns.cosine.data();
  double* const slant = columns.sine.data();
  double* const distance = columns.asked.data();
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    const auto& [position, axis] = layout.transducers[first + n];
    for (std::size_t j = 0; j < foci.size(); ++j) {
      const std::size_t entry = n * foci.size() + j;
      const Vec3 way = foci[j].position - position;
      const double d = std::sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
      distance[entry] = d;
      // At the transducer itself there is no angle; treated as on its axis.
      slant[entry] = d > 0 ? (way.x * axis.x + way.y * axis.y + way.z * axis.z) / d : 1.0;
      turns[entry] = d * turns_per_metre;
    }
  }
  constexpr auto last = static_cast<double>(directivity_steps);
  for (std::size_t entry = 0; entry < entries; ++entry) {
    const double at = std::clamp((slant[entry] + 1) * (0.5 * last), 0.0, last);
    const std::size_t i = std::min(static_cast<std::size_t>(at), directivity_steps - 1);
    const double between = at - static_cast<double>(i);
    const double falls_to = table_[i] + (table_[i + 1] - table_[i]) * between;
    columns.loud[entry] = falls_to / std::max(distance[entry], radius);
  }
  for (std::size_t entry = 0; entry < entries; ++entry) {
    const double part = turns[entry] - nearest(turns[entry]);
    const double size = std::abs(part);
    // Uses the quarter turn on either side of the steep part of each curve.
    columns.cosine[entry] = sine_of_turns(0.25 - size);
    columns.sine[entry] = std::copysign(sine_of_turns(0.25 - std::abs(0.25 - size)), part);
  }
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    for (std::size_t j = 0; j < foci.size(); ++j) {
      double& asked = columns.asked[n * foci.size() + j];
      asked = weighting == Weighting::uniform || foci[j].reach == 0 ? 1.0 : asked / foci[j].reach;
    }
  }
}

}  // namespace palpa::array
