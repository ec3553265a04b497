#include "array/field/free_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "array/field/turns.hpp"
#include "base/lanes.hpp"

namespace palpa::array {
namespace {

/// What is to be filled in.
struct Wanted {
  const Layout& layout;
  std::span<const FocusSource> foci;
  Weighting weighting;
  std::size_t first;  ///< transducer
  double turns_per_metre;
  const std::vector<double>& table;
};

[[gnu::always_inline]] inline void fill_all(const Wanted& wanted, Columns& columns) {
  const std::size_t foci = columns.foci, entries = foci * columns.transducers;
  double* const cosine = columns.cosine.data();
  double* const sine = columns.sine.data();
  double* const loud = columns.loud.data();
  double* const distance = columns.asked.data();
  double* const turns = cosine;
  double* const slant = sine;
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    const auto [position, axis] = wanted.layout.transducers[wanted.first + n];
    for (std::size_t j = 0; j < foci; ++j) {
      const std::size_t entry = n * foci + j;
      const Vec3 way = wanted.foci[j].position - position;
      const double d = std::sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
      distance[entry] = d;
      // At the transducer itself there is no angle; treated as on its axis.
      slant[entry] = d > 0 ? (way.x * axis.x + way.y * axis.y + way.z * axis.z) / d : 1.0;
      turns[entry] = d * wanted.turns_per_metre;
    }
  }
  constexpr auto last = static_cast<double>(directivity_steps);
  const double radius = wanted.layout.transducer_radius_m;
  const double* const table = wanted.table.data();
  for (std::size_t entry = 0; entry < entries; ++entry) {
    const double at = std::min(std::max(0.0, (slant[entry] + 1) * (0.5 * last)), last);
    const std::int32_t i = std::min(static_cast<std::int32_t>(at), static_cast<std::int32_t>(directivity_steps) - 1);
    const double between = at - static_cast<double>(i);
    const double falls_to = table[i] + (table[i + 1] - table[i]) * between;
    loud[entry] = falls_to / std::max(distance[entry], radius);
  }
  for (std::size_t entry = 0; entry < entries; ++entry)
    wave_of_turns(turns[entry], cosine[entry], sine[entry]);
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    for (std::size_t j = 0; j < foci; ++j) {
      double& asked = columns.asked[n * foci + j];
      const double farthest = wanted.foci[j].farthest;
      asked = wanted.weighting == Weighting::uniform || farthest == 0 ? 1.0 : asked / farthest;
    }
  }
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
  columns.foci = foci.size();
  columns.transducers = count;
  for (std::vector<double>* values : {&columns.cosine, &columns.sine, &columns.loud, &columns.asked})
    values->resize(foci.size() * count);
  const Wanted wanted{*layout_, foci, weighting, first, turns_per_metre_, table_};
  in_lanes([&](auto) PALPA_INLINED { fill_all(wanted, columns); });
}

}  // namespace palpa::array
