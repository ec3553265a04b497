// What a drive is computed from: the foci of a slot, and the options that apply to all of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "array/amplitudes.hpp"
#include "array/field/directivity.hpp"
#include "array/medium.hpp"
#include "base/math.hpp"
#include "base/words.hpp"

namespace palpa {
template <typename T>
class JsonRows;  // base/files/json_rows.hpp
}

namespace palpa::array {

class Transfer;  // transfer.hpp
class Nulls;     // nulls.hpp

/// How several foci share the array.
enum class Solver { naive, gs_pat, greedy, loudest, eigenvalue, back_propagation };
inline constexpr Word<Solver> solver_words[] = {
    {"naive", Solver::naive},     {"gs-pat", Solver::gs_pat},         {"greedy", Solver::greedy},
    {"loudest", Solver::loudest}, {"eigenvalue", Solver::eigenvalue}, {"back-propagation", Solver::back_propagation}};

/// `loudest` is gs_pat with more care.
constexpr bool is_gs_pat(Solver solver) {
  return solver == Solver::gs_pat || solver == Solver::loudest;
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

/// Whether a focus can be driven: finite, with coordinates within 100 m. Other foci are left out of their slot.
bool drivable(const SlotFocus& focus);

/// The focus' gain as it is used: clamped to 0..1, NaN counts as 0.
float gain_of(const SlotFocus& focus);

/// The defaults are the paper's. Commands have others (setup/options/options.hpp).
struct DriveOptions {
  Weighting weighting = Weighting::distance;
  Constraint constraint = Constraint::normalise;  ///< of several foci
  Medium medium;
  Solver solver = Solver::naive;
  /// Slots with more foci times transducers than this are left to `naive`.
  std::size_t most_work = std::numeric_limits<std::size_t>::max();
  /// Under `normalise`: no other drive has other gains, so that the largest amplitude is 1 with unequal gains, too.
  /// Otherwise, foci keep their loudness while the gains of others change, and the largest may be below 1.
  bool gains_stay = false;
  Directivity directivity = Directivity::t4010a1;  ///< assumed by the solvers; `naive` does not use it
  /// Replaces the free field for making foci, for every solver and pressure. Must outlive everything that is made with
  /// it. On the host only: a device has only the free field.
  const Transfer* transfer = nullptr;
  /// Places that stay silent, for the same layout as posed, the same medium and directivity. Null: none. In the free
  /// field only, and not together with requested pressures. Slots with nulls are solved on the host, on every device.
  std::shared_ptr<const Nulls> nulls;
};

/// What a result says of the drives that it comes from.
struct DrivenBy {
  Weighting weighting{};
  std::optional<Solver> solver{};            ///< of foci that sound together; none: the caller's own
  std::optional<std::size_t> solved_foci{};  ///< `naive` takes the place of the solver above this number
  std::optional<Constraint> constraint{};    ///< of foci that sound together; none: pressures are requested
};
/// `requests`: some focus requests a pressure.
DrivenBy driven_by(const DriveOptions& options, std::size_t transducers, bool requests);
/// The members `amplitude`, `solver`, `solved_foci` and `constraint`.
const JsonRows<DrivenBy>& driven_rows();

}  // namespace palpa::array
