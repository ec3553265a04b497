#include "array/nulls/nulls.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "array/field/free_field.hpp"
#include "array/solvers/loud_phases.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t judges = 256;          // transducers that choose places
constexpr std::size_t most_candidates = 97;  // per ball, a centre and its surface

/// The centre, then places spread over the sphere, more on one that is large in wavelengths.
std::vector<Vec3> candidates_of(const Null& null, double turns_per_metre) {
  std::vector<Vec3> places{null.position};
  if (!(null.radius_m > 0)) return places;
  const double kr = 2 * std::numbers::pi * turns_per_metre * null.radius_m;
  const double degrees = 5 + 1.3 * kr;  // of spherical harmonics whose sound in the ball is above the smallest rest
  const auto count = std::min(most_candidates - 1, static_cast<std::size_t>(std::ceil(degrees * degrees)));
  const double golden = std::numbers::pi * (1 + std::sqrt(5.0));
  for (std::size_t i = 0; i < count; ++i) {
    const double part = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double z = 1 - 2 * part, across = std::sqrt(1 - z * z), angle = golden * (static_cast<double>(i) + 0.5);
    places.push_back(null.position + null.radius_m * Vec3(across * std::cos(angle), across * std::sin(angle), z));
  }
  return places;
}

/// The sound of the transducers at places.
void hear_at(const FreeField& field, std::span<const Vec3> places, SplitRows& sounds) {
  std::vector<FocusSource> sources;
  sources.reserve(places.size());
  for (const Vec3& place : places)
    sources.push_back({place, 1, 1});
  Columns columns;
  field.fill(sources, Weighting::uniform, columns);
  split_sounds(columns, sounds);
}

struct Chosen {
  Vec3 place;
  double rest;
  std::size_t null;
};

/// Cholesky's factors of the products of the rows, with the largest rest next, until all rests are small.
void choose(const SplitRows& sounds, std::span<const Vec3> places, std::size_t null, std::vector<Chosen>& chosen) {
  const std::size_t count = places.size();
  const double centre = inner_product(sounds, 0, sounds, 0).real();
  if (!(centre > 0)) return;
  std::vector<std::vector<Complex>> factors;
  std::vector<double> rests(count);
  for (std::size_t i = 0; i < count; ++i)
    rests[i] = inner_product(sounds, i, sounds, i).real() / centre;
  for (std::size_t step = 0; step < count; ++step) {
    const auto next = step == 0 ? 0 : static_cast<std::size_t>(std::ranges::max_element(rests) - rests.begin());
    if (!(rests[next] >= null_deepest_rest * null_deepest_rest)) return;
    const double root = std::sqrt(rests[next]);
    chosen.push_back({places[next], step == 0 ? 1 : std::min(root, 1.0), null});
    std::vector<Complex>& factor = factors.emplace_back(count);
    for (std::size_t i = 0; i < count; ++i) {
      Complex left = inner_product(sounds, i, sounds, next) / centre;
      for (std::size_t k = 0; k + 1 < factors.size(); ++k)
        left -= factors[k][i] * std::conj(factors[k][next]);
      factor[i] = left / root;
      rests[i] -= std::norm(factor[i]);
    }
    rests[next] = 0;
  }
}

}  // namespace

Nulls::Nulls(const Layout& layout, const Medium& medium, Directivity directivity, std::span<const Null> nulls)
    : nulls_(nulls.begin(), nulls.end()) {
  const Layout part = spread_over(layout, judges);
  FreeField field;
  field.set(part, medium, directivity);
  std::vector<Chosen> chosen;
  SplitRows sounds;
  for (std::size_t i = 0; i < nulls_.size(); ++i) {
    const std::vector<Vec3> places = candidates_of(nulls_[i], medium.turns_per_metre());
    hear_at(field, places, sounds);
    choose(sounds, places, i, chosen);
  }
  std::ranges::stable_sort(chosen, std::greater{}, &Chosen::rest);
  const std::size_t room = most_null_entries / std::max<std::size_t>(1, layout.transducers.size());
  if (const std::size_t most = std::max(nulls_.size(), std::min(room, most_null_rows)); chosen.size() > most)
    chosen.erase(chosen.begin() + static_cast<std::ptrdiff_t>(most), chosen.end());

  std::vector<Vec3> places, centres;
  places.reserve(chosen.size());
  for (const Chosen& one : chosen) {
    places.push_back(one.place);
    if (one.place == nulls_[one.null].position) centres.push_back(one.place);
  }
  field.set(layout, medium, directivity);
  hear_at(field, centres, centres_);
  hear_at(field, places, sounds);
  std::vector<double> loud(nulls_.size(), 0);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const double own = std::sqrt(inner_product(sounds, i, sounds, i).real());
    if (loud[chosen[i].null] == 0) loud[chosen[i].null] = own;  // its centre comes first
  }
  // Each row loses what the rows before it have, twice, because the first time leaves rounding.
  rows_.reset(chosen.size(), layout.transducers.size());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const double own = std::sqrt(inner_product(sounds, i, sounds, i).real());
    if (!(own > 0)) continue;
    for (int time = 0; time < 2; ++time) {
      for (std::size_t k = 0; k < kept; ++k)
        add_row(-inner_product(sounds, i, rows_, k), rows_, k, sounds, i);
    }
    const double left = std::sqrt(inner_product(sounds, i, sounds, i).real());
    if (!(left > null_deepest_rest * own)) continue;  // the rows before explain it
    add_row(1 / left, sounds, i, rows_, kept);
    rests_.push_back(chosen[i].rest);
    loudness_.push_back(loud[chosen[i].null]);
    ++kept;
  }
  rows_.rows = kept;
  rows_.re.resize(kept * rows_.stride);
  rows_.im.resize(kept * rows_.stride);
}

std::size_t Nulls::rows_to(double rest) const {
  return static_cast<std::size_t>(std::ranges::count_if(rests_, [&](double one) { return one >= rest; }));
}

}  // namespace palpa::array
