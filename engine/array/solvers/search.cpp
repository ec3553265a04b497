#include "array/solvers/search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "array/solvers/greedy.hpp"
#include "array/solvers/gs_pat_step.hpp"
#include "array/solvers/hearing.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// Climbs from the factors of a start. Returns the weakest focus.
double run_climb(std::span<const double> claims, const ClimbEffort& effort, std::span<const Complex> start,
                 SearchScratch& scratch) {
  const std::size_t foci = claims.size();
  for (std::size_t n = 0; n < scratch.part.transducers; ++n) {
    Complex sum = 0;
    for (std::size_t j = 0; j < foci; ++j)
      sum += start[j] * scratch.part.ask(n * foci + j);
    scratch.drive[n] = bounded(sum, Constraint::uniform);
  }
  for (std::size_t j = 0; j < foci; ++j)
    scratch.shares[j] = magnitude(start[j]) * claims[j];
  return climb(scratch.part, claims, effort, scratch.shares, scratch.drive, scratch.climb);
}

}  // namespace

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

Layout spread_over(const Layout& layout, std::size_t count) {
  Layout part = layout;
  part.boards.clear();
  part.transducers.clear();
  const std::size_t all = layout.transducers.size();
  const std::size_t stride = greedy_stride(static_cast<std::uint32_t>(all));
  for (std::size_t i = 0, n = 0; i < std::min(count, all); ++i, n = (n + stride) % all)
    part.transducers.push_back(layout.transducers[n]);
  return part;
}

void reserve(SearchScratch& scratch, std::size_t transducers, std::size_t foci) {
  const std::size_t part = std::min<std::size_t>(transducers, loudest_search.transducers);
  const std::size_t starts = loudest_search.starts;
  for (std::vector<double>* values :
       {&scratch.part.cosine, &scratch.part.sine, &scratch.part.loud, &scratch.part.asked})
    values->reserve(part * foci);
  scratch.single.entries.reserve(part * foci);
  scratch.starts.reserve(starts * foci);
  scratch.merits.reserve(starts);
  scratch.shares.reserve(foci);
  scratch.drive.reserve(part);
  reserve(scratch.climb, part, foci);
}

void search_phases(const FocusMatrix& matrix, const Columns& columns, std::span<const double> claims,
                   const SearchEffort& effort, std::span<Complex> factors, SearchScratch& scratch) {
  const std::size_t foci = columns.foci;
  assert(claims.size() == foci && factors.size() == foci);
  if (columns.transducers == 0) return;
  take_part(columns, effort.transducers, scratch.part);
  take_single(scratch.part, scratch.single);
  scratch.starts.resize(effort.starts * foci);
  scratch.merits.resize(effort.starts);
  scratch.drive.resize(scratch.part.transducers);
  scratch.shares.resize(foci);
  for (std::uint32_t i = 0; i < effort.starts; ++i) {
    const std::span start = std::span(scratch.starts).subspan(i * foci, foci);
    if (i == 0) {
      std::ranges::copy(factors, start.begin());
    } else {
      gs_pat_start(matrix, columns, i, claims, start);
    }
  }
  for (std::size_t first = 0; first < effort.starts; first += starts_together) {
    const std::size_t count = std::min<std::size_t>(starts_together, effort.starts - first);
    run_starts(scratch.single, claims, effort.steps, std::span(scratch.starts).subspan(first * foci, count * foci),
               std::span(scratch.merits).subspan(first, count));
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
