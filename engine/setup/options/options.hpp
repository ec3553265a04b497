// The option groups that several programs and subcommands share. Each consists of a struct of values with the defaults
// of the command line, a function `add` that adds its options to a command, and, if values depend on each other, a
// function `check` to be called after parsing.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acoustics/air.hpp"
#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"
#include "array/nulls/null.hpp"
#include "array/schedule.hpp"
#include "base/files/outputs.hpp"
#include "base/log.hpp"
#include "geometry/solid.hpp"
#include "setup/options/compute.hpp"
#include "touch/methods/method.hpp"
#include "touch/types.hpp"

namespace CLI {
class App;
}
namespace palpa::line {
class Group;
}

namespace palpa::setup {

/// Every subcommand has these.
struct CommonOptions : ComputeOptions {
  std::string json;  ///< a file, "-" for stdout, empty for none
  bool quiet = false;
  std::optional<log::Level> log_level;
  bool allow_outside = false;  ///< see base/files/reference.hpp
};
/// What a command computes with. One that never uses a GPU has no --gpu and --validation.
enum class Computes { anywhere, on_processor };
void add_common(CLI::App& app, CommonOptions& options, Computes computes = Computes::anywhere);
/// --allow-outside, of the commands that read scenes or recordings.
void add_allow_outside(const line::Group& group, CommonOptions& options);
/// --scene and --gltf-scene.
void add_scene(const line::Group& group, std::string& scene, std::optional<std::uint32_t>& number);
/// --gltf-scene, beside a --scene.
void add_gltf_scene(const line::Group& group, std::optional<std::uint32_t>& number);
/// --layout: `what` it is, and behind the known layouts what follows.
void add_layout(const line::Group& group, std::string& layout, const char* what, const char* more = "");
/// --finger, the mesh of one that is pressed into a scene; `usual` is used without it.
void add_finger(const line::Group& group, std::string& file, const char* usual = "");
/// --hold, a time or "auto".
void add_hold(const line::Group& group, double& hold_s, bool& automatic);
/// --board-files, beside a --link.
void add_board_files(const line::Group& group, std::string& folder);
/// Sets the log level: --log-level, otherwise "error" with --quiet, otherwise "warning". With the last two, warnings
/// are held until the outcome is known, because a failing command writes only its error. Long computations call
/// log::release_warnings() once their input is read.
void apply_logging(const CommonOptions& options);
/// Throws bad_usage for GPU options beside --backend cpu.
void check(const ComputeOptions& options);
/// Whether a command ends with a text summary on stdout: not with --quiet, and not if an output goes to stdout.
bool shows_summary(const CommonOptions& options, const Outputs& outputs);

/// The definition of a solid's surface.
struct SolidOptions {
  geometry::SurfaceKind surface = geometry::SurfaceKind::mesh;
  std::optional<geometry::InternalFaces> internal_faces;  ///< default: dropped
  std::optional<std::uint32_t> parts;                     ///< maximum number of convex parts per solid, default 64
};
void add_solid_options(CLI::App& app, SolidOptions& options);

/// From skin points to a schedule.
struct TouchOptions {
  touch::FingerOptions parameters;      ///< --delta, --finger-gap, --min-points, --foci
  bool delta_given = false;             ///< --delta is on the line; otherwise, a tracker has a thicker shell
  std::optional<std::uint32_t> stride;  ///< empty: the usual stride for the number of foci
  double dwell_s = 1.5e-3;
  bool dwell_given = false;     ///< --dwell is on the line; otherwise, a link may choose one
  touch::MethodOptions method;  ///< --method
  bool method_given = false;    ///< --method is on the line; otherwise, a link may choose one that it can play
  array::Modulation modulation = array::Modulation::pressure_sine;
  double modulation_hz = 200;
  bool steady_gains = false;         ///< the link cannot change gains from slot to slot; no option
  const char* foci_name = "--foci";  ///< name of the option for parameters.foci
  bool tune = false;                 ///< --tune: choose the stride, and for a single touch the foci, by the perimeter
  std::optional<double> spot_m;      ///< --spot: width of a Gaussian instead of an array's field
};
/// `foci`: name of the option for the number of foci.
void add_touch_options(CLI::App& app, TouchOptions& options, const char* foci = "--foci");
/// Throws bad_usage, suggesting a valid stride, if stride and foci share a divisor (geometry::stride_fault), and if
/// dwell, modulation frequency or spot is out of range. Warns of a long dwell.
void check(const TouchOptions& options);
/// Throws bad_usage if --finger-width is given, which has an effect only with depth images. `goes_with` names the
/// option that gives them.
void refuse_finger_width(const TouchOptions& options, const char* goes_with);

/// Whether a board that can goes from drive to drive in steps.
enum class Steps { on, off };
inline constexpr Word<Steps> steps_words[] = {{"on", Steps::on}, {"off", Steps::off}};

/// What is heard of a single touch.
struct HeardOptions {
  bool audible = false;
  Steps steps = Steps::on;
};
void add_heard_options(CLI::App& app, HeardOptions& options);

/// What skin feels of a single touch.
struct FeltOptions {
  bool spectrum = false;
  std::optional<double> shortest_dwell_s, longest_dwell_s;  ///< both or none: the range for --tune
};
void add_felt_options(CLI::App& app, FeltOptions& options);
/// Throws bad_usage if a range is incomplete, empty or out of range, and if nothing uses the spot.
void check(const FeltOptions& options, const TouchOptions& touch);

/// The air and the tone: --temperature or --sound-speed, --frequency.
struct MediumOptions {
  std::optional<double> celsius;
  std::optional<double> sound_speed;
  double frequency = 40e3;
  bool operator==(const MediumOptions&) const = default;
};
void add_medium_options(CLI::App& app, MediumOptions& options);
/// The sound speed that is given, otherwise that of the temperature, otherwise that of 20 degrees Celsius.
array::Medium medium(const MediumOptions& options);

/// The other properties of the air, for computations that need its density or absorption: --humidity, --air-pressure,
/// and --no-absorption if absorption is the default, otherwise --absorption. They are under the heading of
/// MediumOptions.
struct AirOptions {
  double humidity_percent = 50;
  double pressure_pa = 101325;
  bool absorption = true;     ///< the default
  bool not_normally = false;  ///< the flag was given
};
void add_air_options(CLI::App& app, AirOptions& options);
/// If a sound speed is given, the temperature is 20 degrees Celsius.
acoustics::Air air(const MediumOptions& medium, const AirOptions& options);

/// --solver: one of array::Solver, in its order, or `adjoint`, which is naive with the transfer of a finger.
enum class SolverChoice { naive, gs_pat, greedy, loudest, eigenvalue, back_propagation, adjoint };
SolverChoice choice_of(array::Solver solver);
/// --transfer: foci are computed from the transducers' sound in free air or on a finger.
enum class TransferChoice { free, finger };

/// The options for computing drives.
struct FocusingOptions {
  std::optional<array::Weighting> weighting;    ///< default: the layout's law
  std::optional<SolverChoice> solver;           ///< default: by Solving
  std::optional<TransferChoice> transfer;       ///< default: free
  std::optional<array::Constraint> constraint;  ///< default: uniform
  std::optional<double> pressure_pa;            ///< at each focus, instead of a constraint
  array::Directivity directivity = array::Directivity::t4010a1;
  MediumOptions medium;
  std::vector<array::Null> nulls;     ///< of --null (nulls.hpp), which only some commands have
  std::string nulls_from = "--null";  ///< who asks for them, for messages
};
/// Whether a command has a finger's mesh, so that foci may be computed from the sound around it. If not, it has no
/// --transfer.
enum class FingerMesh { unknown, known };
void add_drive_options(CLI::App& app, FocusingOptions& options, FingerMesh mesh = FingerMesh::unknown);
/// Adds those of them that say how sound travels from transducers to points.
void add_propagation_options(CLI::App& app, FocusingOptions& options);
/// How often drives are computed, which decides the solver where no option does.
enum class Solving {
  once,      ///< a drive by itself: `loudest`
  by_slot,   ///< the foci of several fingers, in each slot of a frame: gs_pat up to most_solved_work, beyond it naive
  by_frame,  ///< the foci of the method multi_focus, the same in all slots of a frame: gs_pat
};
Solving solving_of(touch::Method method);
/// Foci times transducers of a slot that two cores solve with gs_pat in each slot of 1.5 ms, at 90 frames per second:
/// 32 foci on a board of 256. It is a fixed number, so that every machine computes the same drives.
inline constexpr std::size_t most_solved_work = 8192;
/// With nulls, the solver is gs_pat. Throws bad_usage if a pressure is requested with a constraint, with greedy or with
/// nulls, and for nulls with another solver or a finger's transfer; prepare_nulls (nulls.hpp) then sets
/// DriveOptions::nulls. Throws bad_usage for a finger's transfer unless the command has the finger's mesh; the command
/// then sets DriveOptions::transfer.
array::DriveOptions drive_options(const FocusingOptions& options, const array::Layout& layout, Solving solving,
                                  FingerMesh mesh = FingerMesh::unknown);
/// The same checks alone.
void check(const FocusingOptions& options, FingerMesh mesh);
/// The option that requests a finger's transfer; empty if none does.
std::string asks_for_finger(const FocusingOptions& options);

/// Called if `who` requests a pressure: throws bad_usage if the options have a constraint, greedy or nulls.
void refuse_beside_pressure(const FocusingOptions& options, const std::string& who);
/// Throws bad_usage if one of the solids requests a pressure and the options a constraint, greedy or nulls.
void check(const FocusingOptions& options, std::span<const geometry::Solid> solids);

/// An optional array.
struct ArrayOptions {
  std::string layout;  ///< built-in name or file; empty: none
  FocusingOptions drive;
};
/// Without --layout, the options of its drives are refused.
void add_array_options(CLI::App& app, ArrayOptions& options);

/// The physical set-up; --layout replaces the rig's array.
struct RigOptions {
  std::string rig;     ///< file; empty: the paper's
  std::string layout;  ///< built-in name or file; empty: the rig's
};
void add_rig_options(CLI::App& app, RigOptions& options);

}  // namespace palpa::setup
