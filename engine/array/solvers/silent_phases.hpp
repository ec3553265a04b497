// Silences the sound at nulls (nulls.hpp) by the phases of the transducers alone, while foci stay even: Gauss and
// Newton's method, damped, as in even_phases.hpp, with two more rows for each row of the nulls.
//
//   x_n   the drive of transducer n
//   w_jn  G_jn x_n for the foci, l_i Q_in x_n for the rows of the nulls; p_j = sum over n of w_jn
//   u_j   p_j / |p_j|,  L = sum |p| / sum t over the foci
//   J_jn  -Im(u_j* w_jn) / (t_j L) for a focus, without its share of the change of L; -Im w_in / L and Re w_in / L for
//   a
//         null's row
//   m_j   1 - |p_j| / (t_j L) for a focus; -Re p_i / L and -Im p_i / L
//
// L follows the foci: they may all become quieter or louder. If L were kept, a single focus near a null would have to
// stay exactly as loud, against a row that is nearly its own, and the large phases that this takes cost up to 10 dB.
// The phases change by J^T y with (J J^T + damping) y = m. One pass over the transducers turns each w_jn with its
// transducer and sums the p_j. The products of the w in J J^T are summed again only if the last step gained little.
// docs/notes/nulls.md#uniform-and-clamp has the reasons.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/field/split_rows.hpp"

namespace palpa::array {

inline constexpr double silent_depth = 3e-6;  ///< of a null's row, relative to the level of the foci
inline constexpr double silent_miss = 3e-3;   ///< of a focus
inline constexpr std::uint32_t silent_tries = 100;
/// If more tries than this were needed, or L of several foci falls below `silent_keeps` of what it was, and there are
/// at most `silent_raised_rows` rows, `silent_raises` more steps follow, in which each focus aims for `silent_push`
/// beyond its goal, and L is kept. A step is kept if the weakest focus is louder once the nulls are silent again, after
/// at most `silent_settles` tries.
inline constexpr std::uint32_t silent_few = 3;
inline constexpr double silent_keeps = 0.8;
inline constexpr std::size_t silent_raised_rows = 32;
inline constexpr std::uint32_t silent_raises = 8;
inline constexpr std::uint32_t silent_settles = 6;
inline constexpr double silent_push = 0.1;

/// The transducers' share in each row, and its sums.
struct PhasedSounds {
  SplitRows waves;                           ///< w
  std::vector<double> re, im;                ///< x
  std::vector<std::complex<double>> sounds;  ///< p
};

/// Keeps its storage from call to call.
struct SilentScratch {
  PhasedSounds now, tried, kept;      ///< `kept` only of few rows: before a raise
  std::vector<double> products;       ///< of each pair of w, for J J^T
  std::vector<double> along, across;  ///< how a step turns transducers: sum of along Re w + across Im w
  std::vector<double> normal, rest, mean;
};

/// What is wanted of the drive.
struct SilentGoal {
  const SplitRows& foci;             ///< G of the foci
  std::span<const double> targets;   ///< t of each focus; one with 0 is ignored
  const SplitRows& nulls;            ///< Q
  std::size_t null_rows;             ///< only the first `null_rows` rows of Q are used
  std::span<const double> loudness;  ///< l of each of these rows
};

/// Changes the phases of `drive`, one per transducer, magnitudes 0 to 1.
void silent_phases(const SilentGoal& goal, std::span<std::complex<double>> drive, SilentScratch& scratch);

}  // namespace palpa::array
