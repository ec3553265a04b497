// The computation of `palpa drive`: amplitude and phase of every transducer for one focus, or for several at once, and
// the sound at the foci. Lengths are in metres, pressures in Pa (peak), phases in radians with the time factor e^-iwt,
// all in the layout's own frame. The formulas are in array/drive.hpp and, for a finger, in
// acoustics/bodies/finger_transfer.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acoustics/bodies/finger_transfer.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/field/pressure.hpp"
#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"
#include "array/resolution.hpp"
#include "array/transducer_drive.hpp"
#include "base/files/json_rows.hpp"
#include "geometry/mesh/mesh.hpp"
#include "gpu/device.hpp"
#include "setup/options/nulls.hpp"
#include "setup/options/options.hpp"
#include "setup/options/spread.hpp"
#include "setup/sessions/load.hpp"
#include "setup/tasks/foci.hpp"

namespace palpa::setup {

/// The input as names and files, as on the command line.
struct DriveTask {
  std::string layout;             ///< a built-in name or a file; empty with `touch`: the rig's
  std::vector<std::string> foci;  ///< texts for schedule_of; empty with `touch` and `pattern`
  std::string pattern;            ///< file of control points (pattern_file.hpp)
  std::string touch;              ///< output file of `palpa touch --json`
  /// The content of that file, if it is not one; `touch` is then its name in messages.
  std::optional<std::string> touch_json;
  std::optional<std::uint32_t> slot;   ///< in that touch's order, default 0
  std::string rig;                     ///< gives the array's pose for that touch; empty: the layout's default pose
  std::optional<PlacedLayout> placed;  ///< the array itself, instead of `layout` and `rig`
  FocusingOptions drive;
  std::string mesh;    ///< finger for a finger's transfer: a closed mesh in the layout's frame
  bool force = false;  ///< allow a finger that is too coarse for the wavelength
  SpreadOptions spread;
};
/// Throws bad_usage, naming the command's options, if some are missing or exclude each other, and for air, tone or
/// pressure out of range.
void check(const DriveTask& task);

/// What random arrays make of a drive at its foci.
struct DriveSpread {
  Draws draws;
  std::vector<Percentiles> pressures_pa;  ///< one per focus
  Percentiles evenness;
  std::vector<Percentiles> nulls_pa{};  ///< one per null, at its centre
};

struct DriveResult {
  array::Layout layout;
  array::Medium medium;
  std::vector<array::SlotFocus> foci;
  std::vector<Vec3> aimed;  ///< with a finger: where each focus sounds, on the skin; otherwise empty
  array::Drive drive;       ///< in layout order
  acoustics::FociPressure pressure;
  acoustics::RigidBody::Effort effort;  ///< with a finger: how its equations were solved
  /// With a finger: the pressure at each focus divided by that of the drive for the same foci in free air. Empty if a
  /// pressure is requested.
  std::vector<double> over_free_field;
  std::vector<array::FocusPair> unresolved;  ///< foci that are closer together than the array resolves
  bool pressure_asked = false;               ///< some focus requests a pressure
  array::DrivenBy by;                        ///< how the drive was computed
  std::optional<NullReport> nulls;           ///< if there are nulls
  std::optional<DriveSpread> spread;         ///< if requested

  /// Whether a focus has more pressure than linear acoustics holds for (array::linear_pressure_pa).
  bool beyond_linear() const;
};
/// The output of `palpa drive --json` (docs/solvers.md), and its rows, whose paths may be results of a sweep.
const JsonRows<DriveResult>& drive_rows();
std::string to_json(const DriveResult& result);

/// A rigid finger in the sound of a layout's transducers, for drives that focus on it.
struct BodyInSound {
  /// `body` must come from body_of (setup/files/body.hpp) for this air, be clear of the array
  /// (acoustics::check_clear_of), and be in the layout's frame. `layout` must outlive this object. The air is that of
  /// `drive`, without absorption, as in the solvers.
  BodyInSound(geometry::Mesh body, const array::Layout& layout, const FocusingOptions& drive);
  BodyInSound(geometry::Mesh body, array::Layout&& layout, const FocusingOptions& drive) = delete;
  BodyInSound(const BodyInSound&) = delete;  // `sound` refers to `body`
  BodyInSound& operator=(const BodyInSound&) = delete;

  acoustics::RigidBody body;
  acoustics::FingerTransfer sound;
  std::size_t transducers;  ///< of its layout
};
/// The same with all checks, for a closed mesh that messages call `name`. Throws as load_body and check_clear_of do.
std::unique_ptr<BodyInSound> finger_in_sound(const std::string& name, const geometry::Mesh& mesh,
                                             const array::Layout& layout, const FocusingOptions& drive,
                                             bool force = false);
std::unique_ptr<BodyInSound> finger_in_sound(const std::string& name, const geometry::Mesh& mesh,
                                             array::Layout&& layout, const FocusingOptions& drive,
                                             bool force = false) = delete;

/// The drive of foci that sound together, computed on `device`, or on the processor if that is null;
/// array/drive_pass.hpp says how closely they agree. Throws bad_usage as drive_options and schedule_of do, if there is
/// no focus or no transducer, and for air, tone or pressure that the command line would refuse. Warns of unusual
/// values.
DriveResult make_drive(const array::Layout& layout, std::span<const AskedFocus> foci, const FocusingOptions& drive,
                       const gpu::Device* device = nullptr);
/// The same on a finger, which must be made for this layout and these options; bad_usage if it is for a layout of
/// another size. `drive` need not request its transfer.
/// Computed on the processor.
DriveResult make_drive(const array::Layout& layout, std::span<const AskedFocus> foci, const FocusingOptions& drive,
                       BodyInSound& finger);

/// The sound of this drive at its foci in free air, for `count` arrays as built (array/layouts/as_built.hpp) in air of
/// these options. Computed on all cores of the processor; a millisecond per draw of ten foci and a thousand
/// transducers.
DriveSpread spread_of_drive(const array::Layout& layout, const array::Drive& drive,
                            std::span<const array::SlotFocus> foci, const MediumOptions& medium,
                            array::Directivity directivity, const array::Spread& spread, const Draws& draws);
/// The same for a result, with its nulls.
DriveSpread spread_of_drive(const DriveResult& result, const MediumOptions& medium, array::Directivity directivity,
                            const array::Spread& spread, const Draws& draws);

/// The same from files. Only the backend, the choice of device and the seed in `common` are
/// used. If there is a finger,
/// `finger_read` is called after it is read and before its sound is computed, which takes seconds. Throws as check,
/// load_touch, load_placed_layout, load_body and make_drive do. Throws bad_usage if the touch has no such slot, or if
/// one of its fingers requests a pressure together with an option that a pressure replaces. Throws bad_input if all of
/// its fingers are silent.
DriveResult make_drive(const DriveTask& task, const CommonOptions& common,
                       const std::function<void()>& finger_read = {});

}  // namespace palpa::setup
