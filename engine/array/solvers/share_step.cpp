#include "array/solvers/share_step.hpp"

#include <algorithm>

namespace palpa::array {
namespace {

/// Solves the system of the foci in `takes` in place, for both right-hand sides; the others get 0. `more` is added to
/// the diagonal.
void solve(std::span<const double> growth, std::span<const std::uint8_t> takes, double more, ShareScratch& scratch) {
  const std::size_t foci = takes.size();
  double trace = 0, count = 0;
  for (std::size_t j = 0; j < foci; ++j) {
    if (!takes[j]) continue;
    trace += growth[j * foci + j];
    count += 1;
  }
  const double ridge = std::max(share_ridge * trace / std::max(count, 1.0), 1e-30) + more;
  std::vector<double>& normal = scratch.normal;
  for (std::size_t j = 0; j < foci; ++j) {
    for (std::size_t k = 0; k < foci; ++k)
      normal[j * foci + k] = takes[j] && takes[k] ? growth[j * foci + k] : 0;
    normal[j * foci + j] = takes[j] ? normal[j * foci + j] + ridge : 1;
    if (!takes[j]) scratch.ones[j] = scratch.rest[j] = 0;
  }
  for (std::size_t k = 0; k < foci; ++k) {
    const double inverse = 1 / normal[k * foci + k];
    for (std::size_t i = k + 1; i < foci; ++i) {
      const double part = normal[i * foci + k] * inverse;
      for (std::size_t j = k + 1; j < foci; ++j)
        normal[i * foci + j] -= part * normal[k * foci + j];
      scratch.ones[i] -= part * scratch.ones[k];
      scratch.rest[i] -= part * scratch.rest[k];
    }
  }
  for (std::size_t k = foci; k-- > 0;) {
    for (std::size_t j = k + 1; j < foci; ++j) {
      scratch.ones[k] -= normal[k * foci + j] * scratch.ones[j];
      scratch.rest[k] -= normal[k * foci + j] * scratch.rest[j];
    }
    scratch.ones[k] /= normal[k * foci + k];
    scratch.rest[k] /= normal[k * foci + k];
  }
}

void resize(ShareScratch& scratch, std::size_t foci) {
  scratch.normal.resize(foci * foci);
  for (std::vector<double>* values : {&scratch.ones, &scratch.rest})
    values->resize(foci);
  scratch.takes.resize(foci);
  scratch.returns.resize(foci);
}

}  // namespace

double find_shares(std::span<const double> growth, std::span<const double> loud, std::span<const std::uint8_t> counts,
                   double stiffness, double spread, std::span<double> shares, ShareScratch& scratch) {
  const std::size_t foci = loud.size();
  resize(scratch, foci);
  std::ranges::copy(counts, scratch.takes.begin());
  double level = 0;
  for (std::uint32_t round = 0; round < share_rounds; ++round) {
    for (std::size_t j = 0; j < foci; ++j) {
      scratch.ones[j] = 1;
      scratch.rest[j] = loud[j];
    }
    solve(growth, scratch.takes, stiffness * spread, scratch);
    double ones = 0, rest = 0;
    for (std::size_t j = 0; j < foci; ++j) {
      ones += scratch.ones[j];
      rest += scratch.rest[j];
    }
    level = ones > 0 ? (1 / stiffness + rest) / ones : 0;
    for (std::size_t j = 0; j < foci; ++j)
      shares[j] = stiffness * (level * scratch.ones[j] - scratch.rest[j]);
    bool changed = false;
    for (std::size_t j = 0; j < foci; ++j) {
      bool takes = shares[j] > 0;
      if (!scratch.takes[j]) {
        double grows = 0;
        for (std::size_t k = 0; k < foci; ++k)
          grows += growth[j * foci + k] * std::max(0.0, shares[k]);
        takes = counts[j] && loud[j] + grows / stiffness < level;
      }
      scratch.returns[j] = takes ? 1 : 0;
      changed = changed || takes != (scratch.takes[j] != 0);
    }
    if (!changed) break;
    std::ranges::copy(scratch.returns, scratch.takes.begin());
  }
  double sum = 0;
  for (double& share : shares) {
    share = std::max(0.0, share);
    sum += share;
  }
  for (double& share : shares)
    share = sum > 0 ? share / sum : 0;
  return level;
}

void find_changes(std::span<const double> growth, std::span<const double> change, std::span<const std::uint8_t> counts,
                  std::span<double> shares, ShareScratch& scratch) {
  const std::size_t foci = change.size();
  resize(scratch, foci);
  std::ranges::fill(scratch.ones, 0);
  std::ranges::copy(change, scratch.rest.begin());
  solve(growth, counts, 0, scratch);
  std::ranges::copy(scratch.rest, shares.begin());
}

}  // namespace palpa::array
