// The option groups that several programs and subcommands share. Each is a struct of values with the defaults of the
// command line's contract, an `add` that puts its options on a command, and, where values depend on each other, a
// `check` to call once the line is parsed.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "acoustics/air.hpp"
#include "array/drive.hpp"
#include "array/layout.hpp"
#include "array/schedule.hpp"
#include "base/log.hpp"
#include "base/outputs.hpp"
#include "geometry/solid.hpp"
#include "gpu/device.hpp"
#include "touch/foci/method.hpp"
#include "touch/types.hpp"

namespace CLI {
class App;
}

namespace palpa::setup {

class Group;

enum class Backend { gpu, cpu };

/// On what something is computed, and from which seed.
struct ComputeOptions {
  std::string gpu;  ///< part of a device's name or its index; empty: the fastest kind present
  Backend backend = Backend::gpu;
  std::uint64_t seed = 0;
  std::optional<gpu::Validation> validation;
};

/// Every subcommand has these.
struct CommonOptions : ComputeOptions {
  std::string json;  ///< a file, "-" for stdout, empty for none
  bool quiet = false;
  std::optional<log::Level> log_level;
  bool allow_outside = false;  ///< see base/reference.hpp
};
void add_common(CLI::App& app, CommonOptions& options);
/// --allow-outside, of the commands that read scenes or recordings.
void add_allow_outside(const Group& group, CommonOptions& options);
/// Sets the log level: --log-level, else "error" with --quiet, else "warning". At these, warnings are held until the
/// outcome is known, since a failing command writes nothing but its error: long work calls log::release_warnings() once
/// its input is read.
void apply_logging(const CommonOptions& options);
gpu::DeviceOptions device_options(const ComputeOptions& options);
/// Throws bad_usage where an option of a GPU is given and `why` none is used: "palpa scatter computes on the
/// processor".
void refuse_gpu_options(const ComputeOptions& options, const std::string& why);
/// Throws bad_usage for options of a GPU beside --backend cpu.
void check(const ComputeOptions& options);
/// Whether a command ends with a summary for people on stdout: unless --quiet, or an output goes there.
bool shows_summary(const CommonOptions& options, const Outputs& outputs);

/// What counts as a solid's surface.
struct SolidOptions {
  geometry::SurfaceKind surface = geometry::SurfaceKind::mesh;
  std::optional<geometry::InternalFaces> internal_faces;  ///< normally dropped
  std::optional<std::uint32_t> parts;                     ///< at most so many convex parts per solid, normally 64
};
void add_solid_options(CLI::App& app, SolidOptions& options);

/// From skin points to a schedule.
struct TouchOptions {
  touch::Parameters parameters;         ///< --delta, --finger-gap, --min-points, --foci
  std::optional<std::uint32_t> stride;  ///< nothing: the usual one of the number of foci
  double dwell_s = 1.5e-3;
  touch::MethodOptions method;  ///< --method
  bool method_given = false;    ///< on the line; else a link may choose one that it can play
  array::Modulation modulation = array::Modulation::pressure_sine;
  double modulation_hz = 200;
  const char* foci_name = "--foci";  ///< what the option of parameters.foci is called
  bool tune = false;                 ///< --tune: stride, and for a single touch foci, by the perimeter
  std::optional<double> spot_m;      ///< --spot: of a Gaussian in place of an array's field
};
/// `foci`: what the number of foci is called.
void add_touch_options(CLI::App& app, TouchOptions& options, const char* foci = "--foci");
/// Throws bad_usage, with a stride that would do, where stride and foci share a divisor (geometry::stride_fault). Warns
/// of a long dwell.
void check(const TouchOptions& options);
/// Throws bad_usage where --finger-width is given, which only depth images heed: `goes_with` says which option has
/// them.
void refuse_finger_width(const TouchOptions& options, const char* goes_with);

/// What skin feels of a single touch.
struct FeltOptions {
  bool spectrum = false;
  std::optional<double> shortest_dwell_s, longest_dwell_s;  ///< both or none: what --tune may choose
};
void add_felt_options(CLI::App& app, FeltOptions& options);
/// Throws bad_usage where a range is half given, empty, or goes without --tune, and where nothing uses the spot.
void check(const FeltOptions& options, const TouchOptions& touch);

/// The air and the tone: --temperature or --sound-speed, --frequency.
struct MediumOptions {
  std::optional<double> celsius;
  std::optional<double> sound_speed;
  double frequency = 40e3;
  bool operator==(const MediumOptions&) const = default;
};
void add_medium_options(CLI::App& app, MediumOptions& options);
/// Throws bad_usage where both temperature and sound speed are given. Neither: 20 degrees Celsius.
array::Medium medium(const MediumOptions& options);

/// The rest of the air, for whoever needs its density or with what it absorbs: --humidity, --air-pressure, and
/// --no-absorption where sound is absorbed normally, else --absorption. They stand under the heading of MediumOptions.
struct AirOptions {
  double humidity_percent = 50;
  double pressure_pa = 101325;
  bool absorption = true;     ///< what is normal
  bool not_normally = false;  ///< the flag was given
};
void add_air_options(CLI::App& app, AirOptions& options);
/// Beside a sound speed that is given the temperature is 20 degrees Celsius. Throws bad_usage as medium() does.
acoustics::Air air(const MediumOptions& medium, const AirOptions& options);
/// Throws bad_usage where no sound is absorbed and humidity or pressure of the air is given; for results that do not
/// depend on its density either.
void refuse_idle_air(const AirOptions& options);

/// --solver: one of the engine's, or `adjoint`, which is naive with the transfer of a finger.
enum class SolverChoice { naive, gs_pat, greedy, adjoint };
/// --transfer: foci are made of what transducers do in free air, or on a finger.
enum class TransferChoice { free, finger };

/// What drives are made of.
struct DriveOptionsGroup {
  array::Weighting weighting = array::Weighting::distance;
  std::optional<SolverChoice> solver;
  std::optional<TransferChoice> transfer;       ///< normally free
  std::optional<array::Constraint> constraint;  ///< normally normalise
  std::optional<double> pressure_pa;            ///< at each focus, in the place of a constraint
  array::Directivity directivity = array::Directivity::t4010a1;
  MediumOptions medium;
  bool operator==(const DriveOptionsGroup&) const = default;
};
/// Whether a command has a finger's mesh, so that foci may be made of the sound around it. Where it has none, the help
/// leaves --transfer out.
enum class FingerMesh { unknown, known };
void add_drive_options(CLI::App& app, DriveOptionsGroup& options, FingerMesh mesh = FingerMesh::unknown);
/// Without --solver it is gs_pat for the method multi_focus, whose foci sound together, and naive for all others.
/// Throws bad_usage where a pressure is asked for with a constraint or with greedy, and for a finger's transfer unless
/// the command has the finger's mesh: it then sets DriveOptions::transfer.
array::DriveOptions drive_options(const DriveOptionsGroup& options, touch::Method method = touch::Method::cross_section,
                                  FingerMesh mesh = FingerMesh::unknown);
/// The option that asks for a finger's transfer; empty: none does.
std::string asks_for_finger(const DriveOptionsGroup& options);

/// `who` asks for a pressure: throws bad_usage where the options have a constraint or greedy.
void refuse_beside_pressure(const DriveOptionsGroup& options, const std::string& who);
/// Throws bad_usage where one of the solids asks for a pressure and the options for a constraint or for greedy.
void check(const DriveOptionsGroup& options, std::span<const geometry::Solid> solids);

/// An array that need not be there.
struct ArrayOptions {
  std::string layout;  ///< built-in name or file; empty: none
  DriveOptionsGroup drive;
};
void add_array_options(CLI::App& app, ArrayOptions& options);
/// Throws bad_usage where drives are asked for but no array.
void check(const ArrayOptions& options);

/// The physical set-up; --layout replaces the rig's array.
struct RigOptions {
  std::string rig;     ///< file; empty: the paper's
  std::string layout;  ///< built-in name or file; empty: the rig's
};
void add_rig_options(CLI::App& app, RigOptions& options);

}  // namespace palpa::setup
