#include "setup/options/options.hpp"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "setup/options/warnings.hpp"

namespace palpa::setup {

namespace {

static_assert(static_cast<int>(SolverChoice::back_propagation) == static_cast<int>(array::Solver::back_propagation));
constexpr Word<SolverChoice> choice_words[] = {
    {"naive", SolverChoice::naive},           {"gs-pat", SolverChoice::gs_pat},
    {"greedy", SolverChoice::greedy},         {"loudest", SolverChoice::loudest},
    {"eigenvalue", SolverChoice::eigenvalue}, {"back-propagation", SolverChoice::back_propagation},
    {"adjoint", SolverChoice::adjoint}};
constexpr Word<TransferChoice> transfer_words[] = {{"free", TransferChoice::free}, {"finger", TransferChoice::finger}};

constexpr line::Range dwell_range{1e-6, 10}, modulation_range{0, 1000}, spot_range = line::positive(1);
/// A turn in 100 s. AUTD3 devices play nothing slower than 2.4 mHz.
constexpr double least_modulation_hz = 0.01;
constexpr line::Range tuned_dwell_range{1e-4, 20e-3};

array::Solver solver_of(SolverChoice choice) {
  return choice == SolverChoice::adjoint ? array::Solver::naive : static_cast<array::Solver>(choice);
}

}  // namespace

void add_common(CLI::App& app, CommonOptions& options, Computes computes) {
  const line::Group group(app, "Common options");
  if (computes == Computes::anywhere) {
    group.text("--gpu", options.gpu, "NAME|INDEX",
               "the GPU to use: its number or a part of its name, as palpa doctor lists them [the fastest]");
  }
  group.choice("--backend", options.backend, backend_words,
               "what computes, a GPU or the processor; auto takes a GPU if there is one; $PALPA_BACKEND sets another "
               "default");
  group.text("--json", options.json, "FILE|-", "writes the results as JSON into a file, or with - to stdout [no JSON]");
  group.flag("--quiet", options.quiet,
             "prints no summary, no progress, and no warnings except that palpa waits for a pipe's reader");
  group.choice("--log-level", options.log_level, log::level_words,
               "the least important messages that are printed on stderr [warning]");
  group.integer("--seed", options.seed, 0, ~std::uint64_t{0},
                "the start of all random numbers; the same seed gives the same results");
  if (computes == Computes::on_processor) return;
  group.choice("--validation", options.validation, gpu::validation_words,
               "how strictly the Vulkan calls are checked, for developers [$PALPA_VALIDATION, or off]");
}

void add_allow_outside(const line::Group& group, CommonOptions& options) {
  group.flag("--allow-outside", options.allow_outside,
             "scenes and recordings may name files outside their own folders");
}

void add_scene(const line::Group& group, std::string& scene, std::optional<std::uint32_t>& number) {
  group.text("--scene", scene, "FILE", "glTF model whose meshes can be touched");
  add_gltf_scene(group, number);
}

void add_layout(const line::Group& group, std::string& layout, const char* what, const char* more) {
  group.text("--layout", layout, "NAME|FILE", fmt::format("{}: {} or a TOML{}", what, array::known_layouts(), more));
}

void add_gltf_scene(const line::Group& group, std::optional<std::uint32_t>& number) {
  group.integer("--gltf-scene", number, 0, 1u << 30, "number of the scene in that file [the file's default scene]");
}

void add_finger(const line::Group& group, std::string& file, const char* usual) {
  group.text(
      "--finger", file, "FILE",
      fmt::format("the finger, a closed PLY or glTF mesh with its tip at the origin and its body along +y{}", usual));
}

void add_hold(const line::Group& group, double& hold_s, bool& automatic) {
  group.quantity_or_auto("--hold", hold_s, automatic, Quantity::time, line::positive(10),
                         "how long the newest frame sounds if no other comes; auto lengthens it to up to 200 ms if "
                         "frames are late");
}

void add_board_files(const line::Group& group, std::string& folder) {
  group.text("--board-files", folder, "DIR",
             "folder with the boards' own files, which say how their transducers differ [no differences]");
}

void apply_logging(const CommonOptions& options) {
  log::set_level(options.log_level.value_or(options.quiet ? log::Level::error : log::Level::warning));
  // With a more verbose level than the default, every line is shown at once.
  if (log::level() <= log::Level::warning) log::hold_warnings();
}

bool shows_summary(const CommonOptions& options, const Outputs& outputs) {
  return !options.quiet && !outputs.on_stdout();
}

void check(const ComputeOptions& options) {
  const char* given = !options.gpu.empty() ? "--gpu" : options.validation ? "--validation" : nullptr;
  if (given && options.backend == Backend::cpu)
    throw bad_usage(fmt::format("{}: --backend cpu uses no GPU; leave it out", given));
}

void add_solid_options(CLI::App& app, SolidOptions& options) {
  const line::Group group(app, "Solids");
  group.choice("--surface", options.surface, geometry::surface_words,
               "what counts as a solid's surface, the mesh itself or convex parts that are cut from it");
  group.integer("--parts", options.parts, 1, geometry::most_parts,
                "with --surface parts: the most parts that a solid is cut into [64]");
  group.choice("--internal-faces", options.internal_faces, geometry::internal_faces_words,
               "with --surface parts: whether the cuts between parts count as surface [drop]");
}

void add_touch_options(CLI::App& app, TouchOptions& options, const char* foci) {
  const line::Group group(app, "Touch");
  touch::FingerOptions& p = options.parameters;
  group.quantity("--delta", p.delta_m, Quantity::length, line::positive(1),
                 "thickness of the shell under a solid's surface: how deep a contact may be", &options.delta_given);
  group.quantity("--finger-gap", p.finger_gap_m, Quantity::length, line::positive(1),
                 "contacts belong to one finger if they are no farther apart than this");
  group.integer("--min-points", p.min_points, 1, 1u << 30, "the fewest contacts that count as a finger");
  group.quantity("--finger-width", p.finger_width_m, Quantity::length, {0, 1},
                 "the widest finger that depth cameras see: palpa splits wider clusters, joins patches of one finger, "
                 "and drops flying pixels; 0 does none of these");
  group.choice("--cluster", p.cluster, touch::cluster_words,
               "which skin is clustered into fingers, the contacts or all skin inside a solid");
  options.foci_name = foci;
  group.integer(foci, p.foci, 1, touch::max_foci, "how many foci a finger has");
  group.choice("--spacing", p.spacing, touch::spacing_words,
               "whether foci are equally far apart in angle, or along the outline of the cross-section");
  group.integer(
      "--stride", options.stride, 1, 1u << 20,
      fmt::format("step between consecutive foci; must be coprime with {} [nearest to 0.3 of the foci]", foci));
  group.quantity("--dwell", options.dwell_s, Quantity::time, dwell_range,
                 "how long each focus lasts; foci that stand still on an OpenMPD board last 0.3 ms unless you give it",
                 &options.dwell_given);
  group.choice("--method", options.method.method, touch::method_words,
               "how a cross-section becomes foci (docs/methods.md)", &options.method_given);
  group.choice("--modulation", options.modulation, array::modulation_words,
               "which quantity is a sine in time if foci stand still, as with single-focus and multi-focus");
  group.quantity("--modulation-frequency", options.modulation_hz, Quantity::frequency, modulation_range,
                 "how fast foci that stand still are modulated; 0 does not modulate them");
  group.flag("--tune", options.tune,
             "chooses foci and stride for each finger's perimeter, so that the skin feels as much vibration as "
             "possible; a live run chooses the stride only");
  group.quantity("--spot", options.spot_m, Quantity::length, spot_range,
                 "for --spectrum and --tune: a focus is a Gaussian spot of this width at half its height, and not "
                 "the array's field [3.8mm without an array]");
}

void add_felt_options(CLI::App& app, FeltOptions& options) {
  const line::Group group(app, "What skin feels in time");
  group.flag("--spectrum", options.spectrum, "prints the spectrum of the pressure on each finger's skin");
  group.quantity("--tune-shortest", options.shortest_dwell_s, Quantity::time, tuned_dwell_range,
                 "with --tune-longest: the shortest dwell that --tune may choose [--dwell]");
  group.quantity("--tune-longest", options.longest_dwell_s, Quantity::time, tuned_dwell_range,
                 "with --tune-shortest: the longest dwell that --tune may choose [--dwell]");
  line::need(app, {"--tune-shortest", "--tune-longest"}, "--tune");
  line::need(app, {"--tune-shortest"}, "--tune-longest");
  line::need(app, {"--tune-longest"}, "--tune-shortest");
}

void add_heard_options(CLI::App& app, HeardOptions& options) {
  const line::Group group(app, "What is heard");
  group.flag("--audible", options.audible, "predicts how loud the array is to the ear, beside its beam, in dB(A)");
  group.choice("--steps", options.steps, steps_words,
               "with --audible: whether OpenMPD boards go from drive to drive in steps of 0.1 ms, or jump");
  line::need(app, {"--steps"}, "--audible");
}

void check(const FeltOptions& options, const TouchOptions& touch) {
  if (touch.spot_m && !options.spectrum && !touch.tune) throw bad_usage("--spot goes with --spectrum or --tune");
  if (options.shortest_dwell_s.has_value() != options.longest_dwell_s.has_value()) {
    throw bad_usage("--tune-shortest and --tune-longest go together: give both ends of the range");
  }
  if (!options.shortest_dwell_s) return;
  line::check_quantity("--tune-shortest", *options.shortest_dwell_s, Quantity::time, tuned_dwell_range);
  line::check_quantity("--tune-longest", *options.longest_dwell_s, Quantity::time, tuned_dwell_range);
  constexpr double tenth_ms = 1e-4;
  const double first = std::ceil(*options.shortest_dwell_s / tenth_ms * (1 - 1e-12));
  if (first * tenth_ms > *options.longest_dwell_s * (1 + 1e-12)) {
    throw bad_usage("--tune-shortest, --tune-longest: no whole tenth of a millisecond lies between them");
  }
}

void check(const TouchOptions& options) {
  if (options.stride) {
    const std::string fault = geometry::stride_fault(options.parameters.foci, *options.stride);
    if (!fault.empty()) throw bad_usage(fmt::format("--stride and {}: {}", options.foci_name, fault));
  }
  line::check_quantity("--dwell", options.dwell_s, Quantity::time, dwell_range);
  line::check_quantity("--modulation-frequency", options.modulation_hz, Quantity::frequency, modulation_range);
  if (options.modulation_hz > 0 && options.modulation_hz < least_modulation_hz) {
    throw bad_usage(fmt::format("--modulation-frequency: {:g} Hz is too slow; give at least {:g}Hz, or 0 for none",
                                options.modulation_hz, least_modulation_hz));
  }
  if (options.spot_m) line::check_quantity("--spot", *options.spot_m, Quantity::length, spot_range);
  warn_of_dwell(options);
}

void refuse_finger_width(const TouchOptions& options, const char* goes_with) {
  if (options.parameters.finger_width_m != touch::FingerOptions().finger_width_m)
    throw bad_usage(fmt::format("--finger-width goes with {}: it is for depth images", goes_with));
}

void add_medium_options(CLI::App& app, MediumOptions& options) {
  const line::Group group(app, "Air and tone");
  group.number("--temperature", options.celsius, {array::least_celsius, array::most_celsius}, "CELSIUS",
               "temperature of the air, which sets the speed of sound [20]");
  group.quantity("--sound-speed", options.sound_speed, Quantity::speed,
                 {array::least_sound_speed, array::most_sound_speed},
                 "speed of sound, instead of --temperature [343.2m/s, that of 20 degrees]");
  group.quantity("--frequency", options.frequency, Quantity::frequency, {array::least_frequency, array::most_frequency},
                 "frequency of the transducers' sound");
  line::exclude(app, "--temperature", {"--sound-speed"});
}

array::Medium medium(const MediumOptions& options) {
  array::Medium air;
  air.sound_speed = options.sound_speed ? *options.sound_speed : array::sound_speed_at(options.celsius.value_or(20.0));
  air.frequency = options.frequency;
  return air;
}

void add_air_options(CLI::App& app, AirOptions& options) {
  const line::Group group(app, "Air and tone");
  group.number("--humidity", options.humidity_percent, {0, 100}, "PERCENT",
               "relative humidity of the air, which sets how much sound it absorbs");
  group.quantity("--air-pressure", options.pressure_pa, Quantity::pressure,
                 {acoustics::least_air_pressure_pa, acoustics::most_air_pressure_pa},
                 "pressure of the air, which sets its density and how much sound it absorbs");
  if (options.absorption) {
    group.flag("--no-absorption", options.not_normally,
               "air absorbs no sound; without this option, it absorbs sound as in ISO 9613-1");
    line::exclude(app, "--humidity", {"--no-absorption"});
  } else {
    group.flag("--absorption", options.not_normally,
               "air absorbs sound as in ISO 9613-1; without this option, it absorbs none");
    line::need(app, {"--humidity"}, "--absorption");
  }
}

acoustics::Air air(const MediumOptions& options, const AirOptions& rest) {
  const array::Medium tone = medium(options);
  const acoustics::Weather weather{options.celsius.value_or(20.0), rest.humidity_percent, rest.pressure_pa};
  const acoustics::Air air = acoustics::air_of(weather, tone.frequency, tone.sound_speed);
  return rest.absorption != rest.not_normally ? air : acoustics::without_absorption(air);
}

void add_drive_options(CLI::App& app, FocusingOptions& options, FingerMesh mesh) {
  const line::Group group(app, "Drives");
  group.choice("--amplitude", options.weighting, array::weighting_words,
               "amplitude that a focus asks of each transducer, by its distance or all the same [distance in paper, "
               "uniform on every other layout that does not say otherwise]");
  group.choice(
      "--solver", options.solver, choice_words,
      mesh == FingerMesh::known
          ? "how foci that sound together share the array; adjoint is naive with --transfer finger [the loudest "
            "that is fast enough, see docs/solvers.md]"
          : "how foci that sound together share the array; adjoint needs a finger's mesh, as palpa drive, "
            "simulate and run have [the loudest that is fast enough, see docs/solvers.md]");
  if (mesh == FingerMesh::known) {
    group.choice("--transfer", options.transfer, transfer_words,
                 "whether foci are computed from the sound in free air, or from the sound around the finger [free]");
  }
  group.choice("--constraint", options.constraint, array::constraint_words,
               "how the amplitudes of foci that sound together get into the range 0 to 1 [uniform]");
  group.quantity("--pressure", options.pressure_pa, Quantity::pressure, line::positive(array::most_pressure_pa),
                 "peak pressure at each focus, whatever else sounds, instead of --constraint [as loud as possible]");
  add_propagation_options(app, options);
}

void add_propagation_options(CLI::App& app, FocusingOptions& options) {
  line::Group(app, "Drives")
      .choice("--directivity", options.directivity, array::directivity_words,
              "how a transducer's sound depends on direction; affects pressures, and all solvers except naive");
  add_medium_options(app, options.medium);
}

void refuse_beside_pressure(const FocusingOptions& options, const std::string& who) {
  if (options.constraint) throw bad_usage("--constraint: " + who + ", which replaces it; leave one of them out");
  if (options.solver == SolverChoice::greedy)
    throw bad_usage("--solver greedy: " + who + ", but it drives all transducers in full; use gs-pat or naive");
  if (!options.nulls.empty())
    throw bad_usage(options.nulls_from + ": " + who + ", which nulls change; leave one of them out");
}

void check(const FocusingOptions& options, std::span<const geometry::Solid> solids) {
  for (const geometry::Solid& solid : solids) {
    if (solid.haptics.pressure_pa)
      refuse_beside_pressure(options, fmt::format("mesh \"{}\" asks for a pressure", printable(solid.name, 60)));
  }
}

std::string asks_for_finger(const FocusingOptions& options) {
  if (options.solver == SolverChoice::adjoint) return "--solver adjoint";
  return options.transfer == TransferChoice::finger ? "--transfer finger" : "";
}

SolverChoice choice_of(array::Solver solver) {
  return static_cast<SolverChoice>(solver);
}

Solving solving_of(touch::Method method) {
  return touch::sounds_together(method) ? Solving::by_frame : Solving::by_slot;
}

void check(const FocusingOptions& options, FingerMesh mesh) {
  if (options.solver == SolverChoice::adjoint && options.transfer == TransferChoice::free)
    throw bad_usage("--solver adjoint means naive with --transfer finger: leave --transfer free out");
  if (const std::string asks = asks_for_finger(options); !asks.empty() && mesh == FingerMesh::unknown) {
    throw bad_usage(asks + ": this command has no finger's mesh; palpa drive --mesh, simulate and run have one");
  }
  if (options.pressure_pa) refuse_beside_pressure(options, "--pressure sets how loud foci are");
  const bool silent = !options.nulls.empty();
  if (silent && !asks_for_finger(options).empty())
    throw bad_usage(options.nulls_from + ": nulls are places in free air: leave " + asks_for_finger(options) + " out");
  if (silent && options.solver && *options.solver != SolverChoice::gs_pat)
    throw bad_usage(options.nulls_from + " goes with --solver gs-pat: no other solver leaves places silent");
}

array::DriveOptions drive_options(const FocusingOptions& options, const array::Layout& layout, Solving solving,
                                  FingerMesh mesh) {
  check(options, mesh);
  array::DriveOptions drive;
  drive.weighting = options.weighting.value_or(layout.amplitude_law);
  drive.constraint = options.constraint.value_or(array::Constraint::uniform);
  drive.medium = medium(options.medium);
  drive.gains_stay = solving == Solving::once;
  if (options.solver) {
    drive.solver = solver_of(*options.solver);
  } else if (solving == Solving::once && options.nulls.empty()) {
    drive.solver = array::Solver::loudest;
  } else {
    drive.solver = array::Solver::gs_pat;
    if (solving == Solving::by_slot && options.nulls.empty()) drive.most_work = most_solved_work;
  }
  drive.directivity = options.directivity;
  return drive;
}

void add_array_options(CLI::App& app, ArrayOptions& options) {
  add_layout(line::Group(app, "Array"), options.layout, "the array",
             "; palpa then prints the pressure at the foci [no array]");
  add_drive_options(app, options.drive);
  line::need(app, line::under(app, {"Drives", "Air and tone"}), "--layout");
}

void add_rig_options(CLI::App& app, RigOptions& options) {
  const line::Group group(app, "Rig");
  group.text("--rig", options.rig, "FILE", "TOML file of cameras, array and screen [the paper's rig]");
  add_layout(group, options.layout, "array instead of the rig's", " [the rig's]");
}

}  // namespace palpa::setup
