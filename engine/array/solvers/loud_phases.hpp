// Loud phases: the drive whose weakest focus is as loud as possible when amplitudes are bounded, so that only phases
// matter. Under `uniform` and `clamp`, this is what gs-pat and `loudest` do.
//
//   G        the pressure at focus j from transducer n at full amplitude
//   R        G G^H, as many rows as foci
//   c_j      the factor of focus j: a weight times a phase
//   x_n      phase(sum over j of conj(G_jn) c_j): with the right weights, no other phases make the weakest louder
//   t_j      the target of focus j: its gain times its claim
//
// The phases of the foci have many local optima, so several starts are tried, in four steps, each for fewer starts than
// the one before, and each nearer to the result:
//
//   starts     weighted Gerchberg-Saxton with R alone:       p = R c;   c_j <- phase(p_j) |c_j| t_j L / |p_j|
//   finalists  the same with all amplitudes at 1, on a part of the transducers that is spread over the array: p = G x
//   the climb of the best one on the part, then on all transducers (climb.hpp)
//
// docs/notes/gs-pat.md#seeking-loud-phases has the reasons.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/amplitudes.hpp"
#include "array/field/transfer.hpp"
#include "array/layouts/layout.hpp"
#include "array/solvers/climb.hpp"

namespace palpa::array {

inline constexpr std::size_t most_loud_foci = 32;
inline constexpr std::size_t starts_together = 8;  ///< in the lanes of a vector
inline constexpr std::uint32_t loud_sounds = 4;    ///< transducers of each start except the first

struct LoudEffort {
  std::uint32_t starts = 0;       ///< a multiple of starts_together
  std::uint32_t steps = 0;        ///< of each start
  std::uint32_t transducers = 0;  ///< maximum number of the part's
  std::uint32_t steppers = 0;     ///< starts that go on
  std::uint32_t phase_steps = 0;  ///< of each of them
  std::uint32_t finalists = 0;    ///< of them, those that climb; one does not climb on the part
  ClimbEffort climb;              ///< of each of them on the part,
  ClimbEffort finish;             ///< and of the best one on all transducers
};

/// How much is done for loudness: `most` is the solver `loudest`.
enum class Care { usual, most };

/// For slots of resolved foci, and for those where the array does not resolve half of the foci from another.
struct LoudEfforts {
  LoudEffort resolved, crowded;
};
/// The efforts of gs-pat for up to loud_few foci and for more, and of `loudest`.
inline constexpr LoudEfforts few_loud{{16, 12, 256, 4, 10, 1, {}, {5, 10, 12, 1024, 1e-3, 0.955}},
                                      {16, 4, 256, 16, 8, 4, {5, 5, 0, 256, 2e-3}, {5, 10, 12, 1024, 1e-3, 0.955}}};
inline constexpr LoudEfforts many_loud{{16, 20, 256, 4, 12, 1, {}, {4, 8, 6, 256, 1e-3, 0.955}},
                                       {16, 4, 128, 16, 12, 1, {}, {5, 10, 6, 256, 1e-3, 0.955}}};
inline constexpr LoudEfforts loudest_of_all{
    {64, 20, 1024, 32, 12, 16, {10, 20, 0, 1024, 5e-4}, {15, 60, 12, 65536, 1e-4}},
    {64, 8, 1024, 64, 20, 16, {10, 20, 0, 1024, 5e-4}, {15, 60, 12, 65536, 1e-4}}};
inline constexpr std::size_t loud_few = 10;

inline constexpr std::size_t loud_board = 1024;  ///< transducers up to which every slot's phases are sought,
inline constexpr double loud_near = 0.05;        ///< else from this share of each other's sound on,
inline constexpr std::size_t loud_ears = 128;    ///< as this many transducers judge it

/// Whether some foci hear loud_near of each other. `part` has the columns of loud_ears transducers (take_part).
bool are_near(const Columns& part, FocusMatrix& scratch);

/// The effort for a slot of this many foci; null: gs_pat.hpp solves it. `near()` tells whether foci are near each other
/// (are_near).
template <typename Near>
const LoudEfforts* loud_effort(Care care, Constraint constraint, std::size_t foci, std::size_t transducers, Near near) {
  if (constraint == Constraint::normalise || foci < 2 || foci > most_loud_foci) return nullptr;
  if (care == Care::most) return &loudest_of_all;
  if (transducers > loud_board && !near()) return nullptr;
  return foci <= loud_few ? &few_loud : &many_loud;
}

/// Fills `part` with the columns of up to `count` transducers that are spread over the array. spread_over: the same
/// transducers as a layout.
void take_part(const Columns& columns, std::size_t count, Columns& part);
Layout spread_over(const Layout& layout, std::size_t count);

/// Keeps its storage from call to call.
struct LoudScratch {
  LaneColumns all, part;
  FocusMatrix matrix;                        ///< R
  std::vector<float> single;                 ///< R and the claims in single precision
  std::vector<std::complex<double>> starts;  ///< factors of each start's loudest moment, [start * foci + focus]
  std::vector<double> merits, stepped;       ///< of the starts, -1 for those that go no further
  std::vector<std::complex<double>> next, best, pressure;
  std::vector<double> alone, claims, targets, shares, best_shares;
  std::vector<double> sizes;  ///< by transducer
  LaneDrives drive, best_drive;
  ClimbScratch climb;
};

/// Reserves memory for any effort.
void reserve(LoudScratch& scratch, std::size_t transducers, std::size_t foci);

/// Fills `sums` with the drive, magnitudes 0 to 1. `gains` are relative to the largest, 0..1, one per focus; 2 to
/// most_loud_foci foci. `constraint` is `uniform` or `clamp`.
void loud_phases(const Columns& columns, std::span<const double> gains, Constraint constraint,
                 const LoudEfforts& efforts, std::span<std::complex<double>> sums, LoudScratch& scratch);

}  // namespace palpa::array
