// Where to begin a climb (climb.hpp): the phases of several foci have many local optima, of which the loudest is
// sought, on a part of the transducers that is spread over the array.
//
//   x = phase(B c);  p = G x;  c_j <- phase(p_j) |c_j| t_j L / |p_j|
//
// Each start takes a few such steps, and its loudest moment counts. The best starts climb a few steps. The result is
// the factors with which the loudest of them began to climb: phases of transducers do not always follow from factors.
// The first start is the factors that are given; each other one has the phases of the joint sound of gs_pat_sounds
// transducers. docs/notes/gs-pat.md#seeking-loud-phases has the reasons.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/field/transfer.hpp"
#include "array/layouts/layout.hpp"
#include "array/solvers/climb.hpp"
#include "array/solvers/search_lanes.hpp"

namespace palpa::array {

struct SearchEffort {
  std::uint32_t starts = 0;       ///< including the given one
  std::uint32_t steps = 0;        ///< of each start
  std::uint32_t transducers = 0;  ///< maximum number of the part's
  std::uint32_t finalists = 0;    ///< starts that climb
  ClimbEffort climb;              ///< on the part,
  ClimbEffort finish;             ///< and afterwards on all transducers
};

/// The efforts of gs-pat for up to gs_pat_few foci and for more, and of `loudest`. At most most_searched_foci foci.
inline constexpr SearchEffort default_search{16, 12, 256, 3, {5, 5, 0, 256, 2e-3}, {5, 10, 12, 1024, 1e-3, 0.955}};
inline constexpr SearchEffort many_search{16, 12, 128, 1, {0, 0, 0, 128, 2e-3}, {4, 8, 6, 128, 2e-3, 0.955}};
inline constexpr SearchEffort loudest_search{64, 20, 1024, 16, {10, 20, 0, 1024, 5e-4}, {15, 60, 12, 65536, 1e-4}};

/// Keeps its storage from call to call.
struct SearchScratch {
  Columns part;
  SinglePart single;
  std::vector<std::complex<double>> starts;  ///< factors of each start's loudest moment, [start * foci + focus]
  std::vector<std::complex<double>> drive;
  std::vector<double> merits, shares;
  ClimbScratch climb;
};

/// Fills `part` with the columns of up to `count` transducers that are spread over the array. spread_over: the same
/// transducers as a layout.
void take_part(const Columns& columns, std::size_t count, Columns& part);
Layout spread_over(const Layout& layout, std::size_t count);

/// Reserves memory for any effort.
void reserve(SearchScratch& scratch, std::size_t transducers, std::size_t foci);

/// Replaces `factors`. `claims` are t_j of the foci; one whose claim is 0 is ignored.
void search_phases(const FocusMatrix& matrix, const Columns& columns, std::span<const double> claims,
                   const SearchEffort& effort, std::span<std::complex<double>> factors, SearchScratch& scratch);

}  // namespace palpa::array
