// Drives: the amplitude and phase of every transducer for one slot.
//
// The paper's q_k (Sec. III-F) under the time factor e^{-iwt}: for a focus f, the transducer at distance d gets the
// amplitude d / max d (or 1) and the phase -k d. If several foci sound in one slot:
//
//   q_j      complex amplitude for focus j, with the largest |q_j| equal to 1; with another transfer than the free
//            field (transfer.hpp), its phase is -arg g, where g is the effect of each transducer at the focus
//   g        shared gain: the largest of the foci's gains
//   r_j      relative gain: gain_j / g, and 1 where g is 0
//   S        sum over j of q_j; G: sum over j of r_j q_j
//   amplitude = g * constraint(G), phase = arg G
//
//   normalise: |G| / max(|S|, |G|), the largest taken over all transducers; uniform: 1; clamp: |G|; never above 1
//
// With max |S|, which no gain changes, a gain that all foci share is one scalar over the whole drive. max |G| counts
// only where it is larger, with very unequal gains. A single focus is q_k times its gain, with any solver.
//
// If foci request a pressure, the constraint has no effect: G is then the sum of c_j q_j (slot_pressures.hpp), and the
// amplitude is |G|, at most 1 everywhere. The above is the solver `naive`; for the others, see solvers/ and
// docs/solvers.md. Slots with more than most_solved_foci foci are solved by `naive`, or by many_foci.hpp if foci
// request a pressure. With nulls, null_drive.hpp solves every slot.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "array/constraint.hpp"
#include "array/directivity.hpp"
#include "array/free_field.hpp"
#include "array/layouts/layout.hpp"
#include "array/medium.hpp"
#include "array/null_drive.hpp"
#include "array/nulls.hpp"
#include "array/slot_pressures.hpp"
#include "array/solvers/eigenvalue.hpp"
#include "array/solvers/gs_pat.hpp"
#include "array/transducer_drive.hpp"
#include "array/transfer.hpp"
#include "base/math.hpp"

namespace palpa::array {

/// How several foci share the array.
enum class Solver { naive, gs_pat, greedy, loudest, eigenvalue, back_propagation };

/// `loudest` is gs_pat with more care.
constexpr bool is_gs_pat(Solver solver) {
  return solver == Solver::gs_pat || solver == Solver::loudest;
}

/// The phases that the solver uses for foci that request pressures.
constexpr FocusPhases phases_of(Solver solver) {
  return is_gs_pat(solver) ? FocusPhases::helping : FocusPhases::own;
}

constexpr Care care_of(Solver solver) {
  return solver == Solver::loudest ? Care::most : Care::usual;
}

/// A focus that sounds in a slot. A slot has one for each finger, or several if the method plays them together.
struct SlotFocus {
  Vec3 position;   ///< metres, in the layout's frame as posed
  float gain = 1;  ///< 0..1, the finger's amplitude modulation and intensity
  /// Requested peak pressure, regardless of other foci, gain included. nullopt: no request, the constraint decides. If
  /// one focus of a slot has a request, those without one request nothing.
  std::optional<double> pressure_pa;
  std::uint32_t voice = 0, number = 0;  ///< of a schedule: its voice, and its number among the voice's foci
  /// Peak pressure that it must never exceed: its finger's request at the crest of the modulation. nullopt: no request.
  std::optional<double> most_pa{};
};

struct DriveOptions {
  Weighting weighting = Weighting::distance;
  Constraint constraint = Constraint::normalise;
  Medium medium;
  Solver solver = Solver::naive;
  Directivity directivity = Directivity::t4010a1;  ///< assumed by the solvers; `naive` does not use it
  /// Replaces the free field for making foci, for every solver and pressure. Must outlive everything that is made with
  /// it. On the host only: a device has only the free field.
  const Transfer* transfer = nullptr;
  /// Places that stay silent, for the same layout as posed, the same medium and directivity. Null: none. In the free
  /// field only, and not together with requested pressures. Slots with nulls are solved on the host, on every device.
  std::shared_ptr<const Nulls> nulls;
};

/// The transfer for these options. Prepares `free_field` if that is the one.
const Transfer& transfer_of(const Layout& layout, const DriveOptions& options, FreeField& free_field);

/// Whether a focus can be driven: finite, with coordinates within 100 m. Other foci are left out of their slot.
bool drivable(const SlotFocus& focus);

/// The focus' gain as it is used: clamped to 0..1, NaN counts as 0.
float gain_of(const SlotFocus& focus);

/// With how many foci drive_for surely takes no longer than this on one core; 0: not even with one. Foci that request a
/// pressure do not count.
std::size_t quick_foci(std::size_t transducers, const DriveOptions& options, double within_s);

/// Working memory of drive_for. If it is reused from call to call, drive_for allocates nothing once it has grown.
struct DriveScratch {
  std::vector<FocusSource> sources;
  std::vector<std::complex<double>> sums;  ///< one per transducer
  std::vector<FocusWeight> weights;
  std::vector<double> gains;
  std::vector<std::uint8_t> phases;
  FreeField free_field;
  Columns columns;
  FocusMatrix matrix;
  GsPatScratch gs_pat;
  PressureScratch pressures;
  std::vector<SlotFocus> foci;  ///< the drivable ones, as `sources`
  std::vector<double> targets;
  std::vector<std::complex<double>> factors, heard;
  EigenvalueScratch eigenvalue;
  NullScratch nulls;
};

/// Allocates all memory in `scratch` that drive_for may need for `most_foci` foci, and computes what depends only on
/// the layout.
void reserve(DriveScratch& scratch, const Layout& layout, const DriveOptions& options, std::size_t most_foci);

/// The twin of DrivePass, in double precision: writes the drive of one slot to `out`, one entry per transducer. Without
/// a drivable focus, all entries are zero. Gains outside 0..1 are clamped, NaN counts as 0. A transducer exactly at the
/// focus has phase 0.
void drive_for(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options,
               std::span<TransducerDrive> out, DriveScratch& scratch);
/// The drive of foci with known factors, one each: the sum of factor times q_j, at most 1 everywhere.
void drive_by_factors(const Layout& layout, std::span<const SlotFocus> foci,
                      std::span<const std::complex<double>> factors, const DriveOptions& options,
                      std::span<TransducerDrive> out, DriveScratch& scratch);
/// The same for callers that need few drives: allocates on every call.
void drive_for(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options,
               std::span<TransducerDrive> out);
Drive drive_for(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options = {});

}  // namespace palpa::array
