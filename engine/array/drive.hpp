// Drives: what every transducer does for one slot.
//
// The paper's q_k (Sec. III-F) under the time factor e^{-iwt}: a focus f asks of the transducer at distance d the
// amplitude d / max d (or 1) and the phase -k d. What follows when several foci sound in one slot:
//
//   q_j      complex amplitude that focus j asks, its own largest |q_j| being 1; where another sound than the free
//            field's counts (transfer.hpp), with the phase -arg g of what each transducer does at the focus
//   g        shared gain: the largest of the foci's gains
//   r_j      relative gain: gain_j / g, and 1 where g is 0
//   S        sum over j of q_j; G: sum over j of r_j q_j
//   amplitude = g * constraint(G), phase = arg G
//
//   normalise: |G| / max(|S|, |G|), the largest taken over all transducers; uniform: 1; clamp: |G|; never above 1
//
// The largest |S| knows no gains, and is the larger but where gains are so unequal that those who are to be heard no
// longer share the array with the others: normalising |G| by its own largest value would undo the modulation. A gain
// that all foci share is therefore exactly one scalar over the whole drive, phases untouched; where fingers differ,
// each focus' share of the sum is modulated, under `uniform` by way of the phases alone. One focus is exactly the
// paper's q_k times its gain, whatever the solver.
//
// Where foci ask for a pressure, the constraint does not count: G is then the sum of c_j q_j with the factors that give
// each focus what it asks (slot_pressures.hpp), and the amplitude |G|, nowhere above 1.
//
// That is the solver `naive`. The others choose how several foci share the array, and know what the foci do to each
// other (docs/solvers.md): `gs_pat` gives each q_j complex factors, one set for S and one for G (gs_pat.hpp); `greedy`
// chooses the phases of the transducers themselves, all at amplitude g (greedy.hpp). A slot of more than
// most_solved_foci foci is `naive`'s under every solver, or crowd.hpp's where foci ask for a pressure.
#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "array/constraint.hpp"
#include "array/directivity.hpp"
#include "array/free_field.hpp"
#include "array/gs_pat.hpp"
#include "array/layout.hpp"
#include "array/medium.hpp"
#include "array/slot_pressures.hpp"
#include "array/transfer.hpp"
#include "base/math.hpp"
#include "base/words.hpp"

namespace palpa::array {

/// How several foci share the array.
enum class Solver { naive, gs_pat, greedy };
inline constexpr Word<Solver> solver_words[] = {
    {"naive", Solver::naive}, {"gs-pat", Solver::gs_pat}, {"greedy", Solver::greedy}};

/// The phases in which that solver has foci that ask for pressures.
constexpr FocusPhases phases_of(Solver solver) {
  return solver == Solver::gs_pat ? FocusPhases::helping : FocusPhases::own;
}

/// One focus that sounds in a slot: one of a finger's, or several where its method has them sound together.
struct SlotFocus {
  Vec3 position;   ///< metres, in the layout's frame as posed
  float gain = 1;  ///< 0..1, the finger's amplitude modulation and intensity
  /// Peak, that it is to have whatever else sounds, gain included; nothing: nobody says, and the constraint decides.
  /// Where one focus of a slot has one, those without ask for nothing.
  std::optional<double> pressure_pa;
  std::uint32_t voice = 0, number = 0;  ///< of a schedule: whose it is, and which of its foci
  /// Peak that it must never exceed: what its finger asks, at the modulation's crest; nothing: nobody asks.
  std::optional<double> most_pa{};
};

/// Amplitude 0..1 and phase in (-pi, pi] of one transducer, e^{-iwt}: the phase is the delay, -k d for a single focus.
struct TransducerDrive {
  float amplitude;
  float phase;
};
using Drive = std::vector<TransducerDrive>;  ///< in layout order

struct DriveOptions {
  Weighting weighting = Weighting::distance;
  Constraint constraint = Constraint::normalise;
  Medium medium;
  Solver solver = Solver::naive;
  Directivity directivity = Directivity::t4010a1;  ///< what the solvers count on; `naive` does not ask
  /// The sound that foci are made of in the free field's place, for every solver and pressure. It outlives whatever is
  /// made with it. On the host only: a device has the free field.
  const Transfer* transfer = nullptr;
};

/// What foci go by under these options; `free_field` is made ready if it is that.
const Transfer& transfer_of(const Layout& layout, const DriveOptions& options, FreeField& free_field);

/// Whether a focus can be driven: finite, its coordinates within 100 m. Others are left out of their slot.
bool drivable(const SlotFocus& focus);

/// The focus' gain as it is used: within 0..1, NaN being 0.
float gain_of(const SlotFocus& focus);

/// What drive_for works in. Kept from call to call it makes drive_for allocate nothing once it has grown.
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
};

/// Gives `scratch` all the room that drive_for can need for so many foci, and makes what depends on the layout alone.
void reserve(DriveScratch& scratch, const Layout& layout, const DriveOptions& options, std::size_t most_foci);

/// The twin of DrivePass, in double precision: the drive of one slot into `out`, one entry per transducer. No focus
/// (or none that is drivable): all zero. Gains outside 0..1 are clamped, NaN is 0. A transducer at the very focus has
/// phase 0.
void drive_for(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options,
               std::span<TransducerDrive> out, DriveScratch& scratch);
/// The drive of foci whose factors are known, one each: the sum of factor times q_j, nowhere above 1.
void drive_by_factors(const Layout& layout, std::span<const SlotFocus> foci,
                      std::span<const std::complex<double>> factors, const DriveOptions& options,
                      std::span<TransducerDrive> out, DriveScratch& scratch);
/// The same for callers that need few drives: they allocate on every call.
void drive_for(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options,
               std::span<TransducerDrive> out);
Drive drive_for(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options = {});

}  // namespace palpa::array
