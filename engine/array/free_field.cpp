#include "array/free_field.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "array/turns.hpp"

namespace palpa::array {

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
  for (std::size_t entry = 0; entry < entries; ++entry)
    wave_of_turns(turns[entry], columns.cosine[entry], columns.sine[entry]);
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    for (std::size_t j = 0; j < foci.size(); ++j) {
      double& asked = columns.asked[n * foci.size() + j];
      asked = weighting == Weighting::uniform || foci[j].reach == 0 ? 1.0 : asked / foci[j].reach;
    }
  }
}

}  // namespace palpa::array
