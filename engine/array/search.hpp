// Where to begin a climb (climb.hpp): the phases of several foci have many local optima, of which the loudest is
// sought.
//
// A part of the transducers, spread over the array, stands for all of them; on it everything costs a fraction. Starts
// are those of gs_pat.hpp: the first is the factors that are given, each of the others has the phases of the joint
// sound of gs_pat_sounds transducers. Each start takes a few steps of weighted Gerchberg-Saxton with all amplitudes at
// 1,
//
//   x = phase(B c);  p = G x;  c_j <- phase(p_j) |c_j| t_j L / |p_j|
//
// and its loudest moment counts. The best of them climb a few steps in the phases of the part's transducers, which
// shows how loud they can become. The result is the factors with which the loudest of them began to climb: phases of
// transducers do not always follow from factors.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/climb.hpp"
#include "array/transfer.hpp"

namespace palpa::array {

struct SearchEffort {
  std::uint32_t starts = 0;       ///< including the given one
  std::uint32_t steps = 0;        ///< of each start
  std::uint32_t transducers = 0;  ///< maximum number of the part's
  std::uint32_t finalists = 0;    ///< starts that climb
  ClimbEffort climb;              ///< on the part,
  ClimbEffort finish;             ///< and afterwards on all transducers
};

/// The effort of the solver `loudest`.
inline constexpr SearchEffort loudest_search{32, 20, 512, 12, {10, 15, 0, 512, 1e-3}, {10, 40, 12, 65536, 2e-4}};
inline constexpr std::size_t loudest_most_foci = 32;

/// Keeps its storage from call to call.
struct SearchScratch {
  Columns part;
  std::vector<std::complex<double>> starts;  ///< factors of each start's loudest moment, [start * foci + focus]
  std::vector<std::complex<double>> factors, pressure, does;
  std::vector<double> merits, shares;
  ClimbScratch climb;
};

/// Room for so many transducers and foci, with any effort.
void reserve(SearchScratch& scratch, std::size_t transducers, std::size_t foci);

/// Replaces `factors`. `claims` are t_j of the foci; one whose claim is 0 is ignored.
void search_phases(const FocusMatrix& matrix, const Columns& columns, std::span<const double> claims,
                   const SearchEffort& effort, std::span<std::complex<double>> factors, SearchScratch& scratch);

}  // namespace palpa::array
