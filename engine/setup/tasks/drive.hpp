// What `palpa drive` computes: amplitude and phase of every transducer for one focus, or for several at once, and what
// that sounds like at them. Lengths in metres, pressures in Pa, peak, phases in radians under the time factor e^-iwt;
// all in the layout's own frame. The formulas are in array/drive.hpp and, for a finger, in
// acoustics/bodies/finger_transfer.hpp.
#pragma once

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
#include "array/drive.hpp"
#include "array/layout.hpp"
#include "array/resolution.hpp"
#include "geometry/mesh/mesh.hpp"
#include "gpu/device.hpp"
#include "setup/options.hpp"
#include "setup/tasks/foci.hpp"

namespace palpa::setup {

/// What to drive, by names and files, as the command line gives it.
struct DriveTask {
  std::string layout;                 ///< a built-in name or a file; empty with `touch`: the rig's
  std::vector<std::string> foci;      ///< texts of schedule_of; none with `touch`
  std::string touch;                  ///< what palpa touch --json wrote
  std::optional<std::uint32_t> slot;  ///< of that touch's order, normally 0
  std::string rig;  ///< where the array stands for that touch; empty: where the layout stands by default
  DriveOptionsGroup drive;
  std::string mesh;    ///< the finger of a finger's transfer: a closed mesh in the layout's frame
  bool force = false;  ///< also with a finger that is too coarse for the wavelength
};
/// Throws bad_usage, which names the command's options, where some are missing or exclude each other.
void check(const DriveTask& task);

struct DriveResult {
  array::Layout layout;
  array::Medium medium;
  std::vector<array::SlotFocus> foci;
  std::vector<Vec3> aimed;  ///< with a finger where each focus sounds: on the skin; else none
  array::Drive drive;       ///< in layout order
  acoustics::FociPressure pressure;
  /// With a finger: the pressure at each focus over that of the drive for the same foci in free air. None where a
  /// pressure is asked for.
  std::vector<double> over_free_field;
  std::vector<array::FocusPair> unresolved;  ///< foci that are closer than the array resolves
  bool pressure_asked = false;               ///< some focus asks for a pressure

  /// A focus has more pressure than linear acoustics holds for (array::linear_pressure_pa).
  bool beyond_linear() const;
};
/// What `palpa drive --json` writes (docs/files.md).
std::string to_json(const DriveResult& result);

/// A rigid finger in the sound of a layout's transducers, for drives that focus on it.
struct FingerInSound {
  /// `body` as body_of (setup/body.hpp) makes it for this air, clear of the array (acoustics::check_clear_of), in the
  /// layout's frame. `layout` outlives it. The air is that of `drive`, without absorption, as in the solvers.
  FingerInSound(geometry::Mesh body, const array::Layout& layout, const DriveOptionsGroup& drive);

  acoustics::RigidBody body;
  acoustics::FingerTransfer sound;
};
/// The same with all checks, of a closed mesh that messages call `name`. Throws as load_body and check_clear_of do.
std::unique_ptr<FingerInSound> finger_in_sound(const std::string& name, const geometry::Mesh& mesh,
                                               const array::Layout& layout, const DriveOptionsGroup& drive,
                                               bool force = false);

/// The drive of foci that sound together. On `device`, and where that is null on the processor; array/drive_pass.hpp
/// says how far they agree. Throws bad_usage as drive_options and schedule_of do, where there is no focus, and for air,
/// tone or pressure that the command line would refuse, too; warns of what is unusual.
DriveResult make_drive(const array::Layout& layout, std::span<const AskedFocus> foci, const DriveOptionsGroup& drive,
                       const gpu::Device* device = nullptr);
/// The same on a finger, which was made for this layout and these options: `drive` need not ask for its transfer. On
/// the processor.
DriveResult make_drive(const array::Layout& layout, std::span<const AskedFocus> foci, const DriveOptionsGroup& drive,
                       FingerInSound& finger);

/// The same of files. Of `common` the backend and what chooses a device count. `finger_read` is called where there is a
/// finger, once it is read and before its sound is computed, which takes seconds. Throws as check, load_touch,
/// load_placed_layout, load_body and make_drive do; bad_usage where the touch has no such slot, and where a finger of
/// it asks for a pressure beside what a pressure takes the place of; bad_input where all of its fingers are silent.
DriveResult make_drive(const DriveTask& task, const CommonOptions& common,
                       const std::function<void()>& finger_read = {});

}  // namespace palpa::setup
