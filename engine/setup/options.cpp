#include "setup/options.hpp"

#include <fmt/core.h>

#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "setup/values.hpp"
#include "setup/warnings.hpp"

namespace palpa::setup {

namespace {

constexpr Word<SolverChoice> solver_words[] = {{"naive", SolverChoice::naive},
                                               {"gs-pat", SolverChoice::gs_pat},
                                               {"greedy", SolverChoice::greedy},
                                               {"adjoint", SolverChoice::adjoint}};
constexpr Word<TransferChoice> transfer_words[] = {{"free", TransferChoice::free}, {"finger", TransferChoice::finger}};

constexpr Range dwell_range{1e-6, 10}, modulation_range{0, 1000}, spot_range = positive(1);
constexpr Range tuned_dwell_range{1e-4, 20e-3};

array::Solver solver_of(SolverChoice choice) {
  switch (choice) {
    case SolverChoice::gs_pat:
      return array::Solver::gs_pat;
    case SolverChoice::greedy:
      return array::Solver::greedy;
    case SolverChoice::naive:
    case SolverChoice::adjoint:
      return array::Solver::naive;
  }
  return array::Solver::naive;
}

}  // namespace

void add_common(CLI::App& app, CommonOptions& options) {
  const Group group(app, "Common options");
  group.text("--gpu", options.gpu, "NAME|INDEX", "GPU to use, as `palpa doctor` lists them");
  group.choice("--backend", options.backend, {{"gpu", Backend::gpu}, {"cpu", Backend::cpu}}, "where to compute");
  group.text("--json", options.json, "FILE|-", "write the results as JSON, - for stdout");
  group.flag("--quiet", options.quiet, "no summary, no progress, no warnings");
  group.choice("--log-level", options.log_level, log::level_words, "what goes to stderr, normally warnings");
  group.integer("--seed", options.seed, 0, ~std::uint64_t{0}, "for whatever is random");
  group.choice("--validation", options.validation, gpu::validation_words,
               "of Vulkan calls, normally $PALPA_VALIDATION");
}

void add_allow_outside(const Group& group, CommonOptions& options) {
  group.flag("--allow-outside", options.allow_outside, "scenes and recordings may name files elsewhere");
}

void apply_logging(const CommonOptions& options) {
  log::set_level(options.log_level.value_or(options.quiet ? log::Level::error : log::Level::warning));
  // With a more verbose level than the default, every line is shown at once.
  if (log::level() <= log::Level::warning) log::hold_warnings();
}

bool shows_summary(const CommonOptions& options, const Outputs& outputs) {
  return !options.quiet && !outputs.on_stdout();
}

gpu::DeviceOptions device_options(const ComputeOptions& options) {
  gpu::DeviceOptions device;
  device.select = options.gpu;
  device.validation = options.validation;
  return device;
}

void refuse_gpu_options(const ComputeOptions& options, const std::string& why) {
  const char* given = !options.gpu.empty() ? "--gpu" : options.validation ? "--validation" : nullptr;
  if (given) throw bad_usage(fmt::format("{}: {}; leave it out", given, why));
}

void check(const ComputeOptions& options) {
  if (options.backend == Backend::cpu) refuse_gpu_options(options, "--backend cpu uses no GPU");
}

void add_solid_options(CLI::App& app, SolidOptions& options) {
  const Group group(app, "Solids");
  group.choice("--surface", options.surface, geometry::surface_words,
               "the mesh's own, exactly, or that of convex parts of it");
  group.integer("--parts", options.parts, 1, geometry::most_parts,
                "with --surface parts: how many per solid, at most [64]");
  group.choice("--internal-faces", options.internal_faces, geometry::internal_faces_words,
               "of parts: whether cuts count as surface, normally dropped");
}

void add_touch_options(CLI::App& app, TouchOptions& options, const char* foci) {
  const Group group(app, "Touch");
  touch::Parameters& p = options.parameters;
  group.quantity("--delta", p.delta_m, Quantity::length, positive(1),
                 "thickness of the shell: how deep a contact may be");
  group.quantity("--finger-gap", p.finger_gap_m, Quantity::length, positive(1),
                 "contacts no farther apart than this are in one finger");
  group.integer("--min-points", p.min_points, 1, 1u << 30, "contacts that make a finger");
  group.quantity("--finger-width", p.finger_width_m, Quantity::length, {0, 1},
                 "depth cameras: wider clusters are split at valleys, patches of one finger are joined, flying pixels "
                 "are dropped; 0: all three off");
  group.choice("--cluster", p.cluster, touch::cluster_words,
               "what is clustered into fingers: contacts, or all skin inside a solid");
  options.foci_name = foci;
  group.integer(foci, p.foci, 1, touch::max_foci, "foci per finger");
  group.choice("--spacing", p.spacing, touch::spacing_words,
               "foci at equal angles, or at equal lengths along the cross-section");
  group.integer("--stride", options.stride, 1, 1u << 20,
                "step from a focus to the next; coprime to the number of foci, normally the nearest to 0.3 of it");
  group.quantity("--dwell", options.dwell_s, Quantity::time, dwell_range, "how long a focus lasts");
  group.choice("--method", options.method.method, touch::method_words, "how a cross-section becomes foci",
               &options.method_given);
  group.choice("--modulation", options.modulation, array::modulation_words,
               "what is a sine where foci stand still, as under single-focus and multi-focus");
  group.quantity("--modulation-frequency", options.modulation_hz, Quantity::frequency, modulation_range,
                 "of foci that stand still; 0: none");
  group.flag("--tune", options.tune,
             "choose foci and stride by each finger's perimeter, so that skin feels most of the vibration; "
             "while running, the stride alone");
  group.quantity("--spot", options.spot_m, Quantity::length, spot_range,
                 "a focus' pressure is a Gaussian so wide at half its height, in place of the array's field "
                 "[3.8mm where there is no array]");
}

void add_felt_options(CLI::App& app, FeltOptions& options) {
  const Group group(app, "What skin feels in time");
  group.flag("--spectrum", options.spectrum, "the spectrum of the pressure on each finger's skin");
  group.quantity("--tune-shortest", options.shortest_dwell_s, Quantity::time, tuned_dwell_range,
                 "with --tune-longest: dwells that --tune may choose, normally --dwell alone");
  group.quantity("--tune-longest", options.longest_dwell_s, Quantity::time, tuned_dwell_range, "see --tune-shortest");
}

void check(const FeltOptions& options, const TouchOptions& touch) {
  if (touch.spot_m && !options.spectrum && !touch.tune) throw bad_usage("--spot goes with --spectrum or --tune");
  if (options.shortest_dwell_s.has_value() != options.longest_dwell_s.has_value()) {
    throw bad_usage("--tune-shortest and --tune-longest go together: give both ends of the range");
  }
  if (!options.shortest_dwell_s) return;
  if (!touch.tune) throw bad_usage("--tune-shortest and --tune-longest go with --tune");
  check_quantity("--tune-shortest", *options.shortest_dwell_s, Quantity::time, tuned_dwell_range);
  check_quantity("--tune-longest", *options.longest_dwell_s, Quantity::time, tuned_dwell_range);
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
  check_quantity("--dwell", options.dwell_s, Quantity::time, dwell_range);
  check_quantity("--modulation-frequency", options.modulation_hz, Quantity::frequency, modulation_range);
  if (options.spot_m) check_quantity("--spot", *options.spot_m, Quantity::length, spot_range);
  warn_of_dwell(options);
}

void refuse_finger_width(const TouchOptions& options, const char* goes_with) {
  if (options.parameters.finger_width_m != touch::Parameters().finger_width_m)
    throw bad_usage(fmt::format("--finger-width goes with {}: it is for depth images", goes_with));
}

void add_medium_options(CLI::App& app, MediumOptions& options) {
  const Group group(app, "Air and tone");
  group.number("--temperature", options.celsius, {array::least_celsius, array::most_celsius}, "CELSIUS",
               "of the air, which says how fast sound is [20]");
  group.quantity("--sound-speed", options.sound_speed, Quantity::speed,
                 {array::least_sound_speed, array::most_sound_speed}, "to be used in place of the temperature's");
  group.quantity("--frequency", options.frequency, Quantity::frequency, {array::least_frequency, array::most_frequency},
                 "of the transducers");
}

array::Medium medium(const MediumOptions& options) {
  if (options.celsius && options.sound_speed) {
    throw bad_usage("--temperature and --sound-speed both set the speed of sound: give one of them");
  }
  array::Medium air;
  air.sound_speed = options.sound_speed ? *options.sound_speed : array::sound_speed_at(options.celsius.value_or(20.0));
  air.frequency = options.frequency;
  return air;
}

void add_air_options(CLI::App& app, AirOptions& options) {
  const Group group(app, "Air and tone");
  group.number("--humidity", options.humidity_percent, {0, 100}, "PERCENT", "of the air, relative: what it absorbs");
  group.quantity("--air-pressure", options.pressure_pa, Quantity::pressure,
                 {acoustics::least_air_pressure_pa, acoustics::most_air_pressure_pa},
                 "which says how dense air is and what it absorbs");
  if (options.absorption) {
    group.flag("--no-absorption", options.not_normally,
               "air takes nothing from the sound, normally as ISO 9613-1 says");
  } else {
    group.flag("--absorption", options.not_normally, "air takes from the sound what ISO 9613-1 says, normally nothing");
  }
}

acoustics::Air air(const MediumOptions& options, const AirOptions& rest) {
  const array::Medium tone = medium(options);
  const acoustics::Weather weather{options.celsius.value_or(20.0), rest.humidity_percent, rest.pressure_pa};
  const acoustics::Air air = acoustics::air_of(weather, tone.frequency, tone.sound_speed);
  return rest.absorption != rest.not_normally ? air : acoustics::without_absorption(air);
}

void refuse_idle_air(const AirOptions& options) {
  const AirOptions usual;
  if (options.absorption != options.not_normally) return;
  const char* given = options.humidity_percent != usual.humidity_percent ? "--humidity"
                      : options.pressure_pa != usual.pressure_pa         ? "--air-pressure"
                                                                         : nullptr;
  if (given)
    throw bad_usage(fmt::format(
        "{} sets how much air absorbs, and --no-absorption that it absorbs nothing: give one of them", given));
}

void add_drive_options(CLI::App& app, DriveOptionsGroup& options, FingerMesh mesh) {
  const Group group(app, "Drives");
  group.choice("--amplitude", options.weighting, array::weighting_words, "what a focus asks of a transducer");
  group.choice("--solver", options.solver, solver_words,
               mesh == FingerMesh::known
                   ? "how several foci share the array [naive; gs-pat for the method multi-focus]; adjoint: naive with "
                     "--transfer finger"
                   : "how several foci share the array [naive; gs-pat for the method multi-focus]; adjoint needs a "
                     "finger's mesh, as drive and simulate have");
  Group(app, mesh == FingerMesh::known ? "Drives" : "")
      .choice("--transfer", options.transfer, transfer_words,
              "foci are made of the sound in free air, or of that around the finger [free]");
  group.choice("--constraint", options.constraint, array::constraint_words,
               "how amplitudes come into 0..1 [normalise]");
  group.quantity("--pressure", options.pressure_pa, Quantity::pressure, positive(array::most_pressure_pa),
                 "peak at each focus whatever else sounds, in place of --constraint");
  group.choice("--directivity", options.directivity, array::directivity_words,
               "of a transducer, for pressures and for all solvers but naive");
  add_medium_options(app, options.medium);
}

void refuse_beside_pressure(const DriveOptionsGroup& options, const std::string& who) {
  if (options.constraint) throw bad_usage("--constraint: " + who + ", which replaces it; leave one of them out");
  if (options.solver == SolverChoice::greedy)
    throw bad_usage("--solver greedy: " + who + ", but it drives all transducers in full; take gs-pat or naive");
}

void check(const DriveOptionsGroup& options, std::span<const geometry::Solid> solids) {
  for (const geometry::Solid& solid : solids) {
    if (solid.haptics.pressure_pa)
      refuse_beside_pressure(options, fmt::format("mesh \"{}\" asks for a pressure", printable(solid.name, 60)));
  }
}

std::string asks_for_finger(const DriveOptionsGroup& options) {
  if (options.solver == SolverChoice::adjoint) return "--solver adjoint";
  return options.transfer == TransferChoice::finger ? "--transfer finger" : "";
}

array::DriveOptions drive_options(const DriveOptionsGroup& options, touch::Method method, FingerMesh mesh) {
  if (options.solver == SolverChoice::adjoint && options.transfer == TransferChoice::free)
    throw bad_usage("--solver adjoint means naive with --transfer finger: leave --transfer free out");
  if (const std::string asks = asks_for_finger(options); !asks.empty() && mesh == FingerMesh::unknown) {
    throw bad_usage(asks + ": this command has no finger's mesh; palpa drive --mesh and palpa simulate have one");
  }
  if (options.pressure_pa) refuse_beside_pressure(options, "--pressure sets how loud foci are");
  array::DriveOptions drive;
  drive.weighting = options.weighting;
  drive.constraint = options.constraint.value_or(array::Constraint::normalise);
  drive.medium = medium(options.medium);
  const bool together = method == touch::Method::multi_focus;
  drive.solver = solver_of(options.solver.value_or(together ? SolverChoice::gs_pat : SolverChoice::naive));
  drive.directivity = options.directivity;
  return drive;
}

void add_array_options(CLI::App& app, ArrayOptions& options) {
  Group(app, "Array")
      .text("--layout", options.layout, "NAME|FILE",
            "array that sounds: autd3, paper, openmpd, openmpd-pair, sonicsurface or a TOML; says what "
            "pressure it gives at the foci");
  add_drive_options(app, options.drive);
}

void check(const ArrayOptions& options) {
  if (options.layout.empty() && options.drive != DriveOptionsGroup())
    throw bad_usage("options for driving an array go with --layout: give the array, such as paper");
}

void add_rig_options(CLI::App& app, RigOptions& options) {
  const Group group(app, "Rig");
  group.text("--rig", options.rig, "FILE", "cameras, array and screen as TOML [the paper's]");
  group.text("--layout", options.layout, "NAME|FILE",
             "array: autd3, paper, openmpd, openmpd-pair, sonicsurface or a TOML");
}

}  // namespace palpa::setup
