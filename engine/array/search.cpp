#include "array/search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "array/greedy.hpp"
#include "array/gs_pat_step.hpp"
#include "array/hearing.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// The columns of `count` transducers that are spread over the array.
void take_part(const Columns& columns, std::size_t count, Columns& part) {
  const std::size_t foci = columns.foci;
  part.foci = foci;
  part.transducers = std::min(count, columns.transducers);
  for (std::vector<double>* values : {&part.cosine, &part.sine, &part.loud, &part.asked})
    values->resize(part.transducers * foci);
  const std::size_t stride = greedy_stride(static_cast<std::uint32_t>(columns.transducers));
  for (std::size_t i = 0, n = 0; i < part.transducers; ++i, n = (n + stride) % columns.transducers) {
    for (std::size_t j = 0; j < foci; ++j) {
      part.cosine[i * foci + j] = columns.cosine[n * foci + j];
      part.sine[i * foci + j] = columns.sine[n * foci + j];
      part.loud[i * foci + j] = columns.loud[n * foci + j];
      part.asked[i * foci + j] = columns.asked[n * foci + j];
    }
  }
}

double weakest_of(std::span<const Complex> pressure, std::span<const double> claims) {
  double least = -1;
  for (std::size_t j = 0; j < claims.size(); ++j) {
    if (claims[j] <= 0) continue;
    const double heard = magnitude(pressure[j]) / claims[j];
    least = least < 0 ? heard : std::min(least, heard);
  }
  return std::max(least, 0.0);
}

/// Weighted Gerchberg-Saxton on the part from `scratch.factors`. Fills `best`; returns the weakest focus then.
double run_start(std::span<const double> claims, std::uint32_t steps, std::span<Complex> best, SearchScratch& scratch) {
  double merit = -1;
  for (std::uint32_t step = 0; step <= steps; ++step) {
    hear_bounded(scratch.part, Constraint::uniform, scratch.factors, scratch.pressure);
    if (const double weakest = weakest_of(scratch.pressure, claims); weakest > merit) {
      merit = weakest;
      std::ranges::copy(scratch.factors, best.begin());
    }
    if (step < steps) gs_pat_step(scratch.pressure, claims, {0, static_cast<double>(claims.size())}, scratch.factors);
  }
  return merit;
}

/// Climbs from the factors of a start. Returns the weakest focus.
double run_climb(std::span<const double> claims, const ClimbEffort& effort, std::span<const Complex> start,
                 SearchScratch& scratch) {
  const std::size_t foci = claims.size();
  for (std::size_t n = 0; n < scratch.part.transducers; ++n) {
    Complex sum = 0;
    for (std::size_t j = 0; j < foci; ++j)
      sum += start[j] * scratch.part.ask(n * foci + j);
    scratch.does[n] = bounded(sum, Constraint::uniform);
  }
  for (std::size_t j = 0; j < foci; ++j)
    scratch.shares[j] = magnitude(start[j]) * claims[j];
  return climb(scratch.part, claims, effort, scratch.shares, scratch.does, scratch.climb);
}

}  // namespace

void reserve(SearchScratch& scratch, std::size_t transducers, std::size_t foci) {
  const std::size_t part = std::min<std::size_t>(transducers, loudest_search.transducers);
  const std::size_t starts = loudest_search.starts;
  for (std::vector<double>* values :
       {&scratch.part.cosine, &scratch.part.sine, &scratch.part.loud, &scratch.part.asked})
    values->reserve(part * foci);
  scratch.starts.reserve(starts * foci);
  scratch.merits.reserve(starts);
  scratch.shares.reserve(foci);
  scratch.does.reserve(part);
  for (std::vector<Complex>* values : {&scratch.factors, &scratch.pressure})
    values->reserve(foci);
  reserve(scratch.climb, part, foci);
}

void search_phases(const FocusMatrix& matrix, const Columns& columns, std::span<const double> claims,
                   const SearchEffort& effort, std::span<Complex> factors, SearchScratch& scratch) {
  const std::size_t foci = columns.foci;
  assert(claims.size() == foci && factors.size() == foci);
  if (columns.transducers == 0) return;
  take_part(columns, effort.transducers, scratch.part);
  scratch.starts.resize(effort.starts * foci);
  scratch.merits.resize(effort.starts);
  for (std::vector<Complex>* values : {&scratch.factors, &scratch.pressure})
    values->resize(foci);
  scratch.does.resize(scratch.part.transducers);
  scratch.shares.resize(foci);
  for (std::uint32_t i = 0; i < effort.starts; ++i) {
    if (i == 0)
      std::ranges::copy(factors, scratch.factors.begin());
    else
      gs_pat_start(matrix, columns, i, claims, scratch.factors);
    scratch.merits[i] = run_start(claims, effort.steps, std::span(scratch.starts).subspan(i * foci, foci), scratch);
  }
  double best = -1;
  for (std::uint32_t climbs = 0; climbs < std::min(effort.finalists, effort.starts); ++climbs) {
    const auto next = static_cast<std::size_t>(std::ranges::max_element(scratch.merits) - scratch.merits.begin());
    const std::span start = std::span(scratch.starts).subspan(next * foci, foci);
    const double weakest = run_climb(claims, effort.climb, start, scratch);
    scratch.merits[next] = -1;
    if (weakest <= best) continue;
    best = weakest;
    std::ranges::copy(start, factors.begin());
  }
}

}  // namespace palpa::array
