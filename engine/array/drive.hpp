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
// only where it is larger, with very unequal gains, or alone with DriveOptions::gains_stay. A single focus is q_k times
// its gain, with any solver and constraint.
//
// If foci request a pressure, the constraint has no effect: G is then the sum of c_j q_j (slot_pressures.hpp), and the
// amplitude is |G|, at most 1 everywhere. The above is the solver `naive`; for the others, see solvers/ and
// docs/solvers.md. Slots with more than most_solved_foci foci are solved by `naive`, or by many_foci.hpp if foci
// request a pressure. With nulls, null_drive.hpp solves every slot.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>

#include "array/drive_options.hpp"
#include "array/field/free_field.hpp"
#include "array/field/transfer.hpp"
#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"

namespace palpa::array {

/// The transfer for these options. Prepares `free_field` if that is the one.
const Transfer& transfer_of(const Layout& layout, const DriveOptions& options, FreeField& free_field);

/// Whether the solver computes a slot of this many foci. If not, `naive` does.
constexpr bool is_solved(const DriveOptions& options, std::size_t foci, std::size_t transducers) {
  return options.solver != Solver::naive && foci > 1 && foci <= most_solved_foci &&
         foci * transducers <= options.most_work;
}

/// With how many foci drive_for surely takes no longer than this on one core; 0: not even with one. Foci that request a
/// pressure do not count.
std::size_t quick_foci(std::size_t transducers, const DriveOptions& options, double within_s);

/// Working memory of drive_for. If it is reused from call to call, drive_for allocates nothing once it has grown.
class DriveScratch {
 public:
  DriveScratch();
  ~DriveScratch();
  DriveScratch(DriveScratch&&) noexcept;
  DriveScratch& operator=(DriveScratch&&) noexcept;

  struct Parts;
  Parts& parts() { return *parts_; }

 private:
  std::unique_ptr<Parts> parts_;
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
