#include "array/drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "array/free_drives.hpp"
#include "array/nulls/null_drive.hpp"
#include "array/nulls/nulls.hpp"
#include "array/pressures/many_foci.hpp"
#include "array/pressures/slot_pressures.hpp"
#include "array/pressures/solver_traits.hpp"
#include "array/solvers/back_propagation.hpp"
#include "array/solvers/eigenvalue.hpp"
#include "array/solvers/greedy.hpp"
#include "array/solvers/gs_pat.hpp"
#include "array/solvers/hearing.hpp"
#include "array/solvers/loud_phases.hpp"
#include "base/error.hpp"

namespace palpa::array {

struct DriveScratch::Parts {
  std::vector<FocusSource> sources;
  std::vector<std::complex<double>> sums;  ///< one per transducer
  std::vector<std::complex<double>> even;  ///< the same of a solver that evens out
  std::vector<FocusWeight> weights;
  std::vector<double> gains;
  std::vector<std::uint8_t> phases;
  FreeField free_field;
  Columns columns;
  FocusMatrix matrix;
  GsPatScratch gs_pat;
  LoudScratch loud;
  Columns ears;  ///< those of a few transducers, which judge whether foci are near
  PressureScratch pressures;
  std::vector<SlotFocus> foci;  ///< the drivable ones, as `sources`
  std::vector<double> targets;
  std::vector<std::complex<double>> factors, heard;
  EigenvalueScratch eigenvalue;
  NullScratch nulls;
};

namespace {

using Scratch = DriveScratch::Parts;

using Complex = std::complex<double>;
using Source = FocusSource;

double largest_of(std::span<const Complex> sums) {
  double largest = 0;
  for (const Complex& sum : sums)
    largest = std::max(largest, std::norm(sum));
  return std::sqrt(largest);
}

/// The drives of sums under the options' constraint. `largest`: of all sums, with their gains or without.
void constrain(std::span<const Complex> sums, double largest, const DriveOptions& options, double gain,
               std::span<TransducerDrive> out) {
  if (options.constraint == Constraint::normalise && options.gains_stay) largest = largest_of(sums);
  drive_sums(sums, options.constraint == Constraint::normalise && largest > 0 ? largest : 1.0, gain, out);
  if (options.constraint != Constraint::uniform) return;
  for (TransducerDrive& transducer : out)
    transducer.amplitude = as_amplitude(gain);
}

void drive_one(const Layout& layout, const Source& source, const DriveOptions& options, std::span<TransducerDrive> out,
               Columns& columns) {
  if (!options.transfer) return drive_focus_in_free_field(layout, source, options.weighting, options.medium, out);
  options.transfer->fill(std::span(&source, 1), options.weighting, columns);
  for (std::size_t t = 0; t < out.size(); ++t)
    out[t] = {as_amplitude(columns.asked[t] * source.gain), as_phase(-std::atan2(columns.sine[t], columns.cosine[t]))};
}

double shared_gain_of(const std::vector<Source>& sources) {
  double shared = 0;
  for (const Source& source : sources)
    shared = std::max(shared, source.gain);
  return shared;
}
double relative_gain(const Source& source, double shared) {
  return shared > 0 ? source.gain / shared : 1.0;
}

/// Replaces `scratch.sums` by the sums of `columns`, each times its factor `heard`. Returns the largest magnitude among
/// these sums and those with the factors `plain`.
double sum_columns(Scratch& scratch) {
  const Columns& columns = scratch.columns;
  double largest = 0;
  for (std::size_t t = 0; t < columns.transducers; ++t) {
    Complex plain = 0, heard = 0;
    for (std::size_t j = 0; j < columns.foci; ++j) {
      const Complex asked = columns.ask(t * columns.foci + j);
      plain += scratch.weights[j].plain * asked;
      heard += scratch.weights[j].heard * asked;
    }
    scratch.sums[t] = heard;
    largest = std::max({largest, std::norm(plain), std::norm(heard)});
  }
  return std::sqrt(largest);
}

/// The same for the sources with `scratch.weights`.
double sum_sources(const Layout& layout, const DriveOptions& options, Scratch& scratch) {
  scratch.sums.resize(layout.transducers.size());
  if (!options.transfer) {
    return sum_foci_in_free_field(layout, scratch.sources, scratch.weights, options.weighting, options.medium,
                                  scratch.sums);
  }
  options.transfer->fill(scratch.sources, options.weighting, scratch.columns);
  return sum_columns(scratch);
}

/// The factors of a solver that knows only gains; `plain` are those of equal gains.
template <typename Factors>
void find_weights(Scratch& scratch, Factors factors_for) {
  const std::size_t foci = scratch.columns.foci;
  const bool differ = std::ranges::any_of(scratch.gains, [](double gain) { return gain != 1; });
  scratch.factors.resize(foci);
  scratch.targets.assign(foci, 1);
  for (int time = differ ? 0 : 1; time < 2; ++time) {
    const std::span<const double> gains = time == 0 ? scratch.targets : scratch.gains;
    factors_for(gains, scratch.factors);
    for (std::size_t j = 0; j < foci; ++j)
      (time == 0 ? scratch.weights[j].plain : scratch.weights[j].heard) = scratch.factors[j];
  }
  if (differ) return;
  for (FocusWeight& weight : scratch.weights)
    weight.plain = weight.heard;
}

/// Whether a drive's loudness may depend on its own gains.
bool may_be_plain(const DriveOptions& options, std::span<const double> gains) {
  return options.gains_stay || std::ranges::all_of(gains, [](double gain) { return gain == 1; });
}

/// A device judges it in the same way.
bool are_near(Scratch& scratch) {
  take_part(scratch.columns, loud_ears, scratch.ears);
  return are_near(scratch.ears, scratch.matrix);
}

/// The weakest focus, relative to its gain, if the largest of these sums is played with amplitude 1.
double weakest_of_sums(std::span<const Complex> sums, const Scratch& scratch) {
  const Columns& columns = scratch.columns;
  std::array<Complex, most_solved_foci> pressure{};
  for (std::size_t t = 0; t < columns.transducers; ++t) {
    for (std::size_t j = 0; j < columns.foci; ++j)
      pressure[j] += columns.transfer(t * columns.foci + j) * sums[t];
  }
  const double weakest = weakest_of(scratch.gains, [&](std::size_t j) { return magnitude(pressure[j]); });
  const double largest = largest_of(sums);
  return largest > 0 ? weakest / largest : 0;
}

/// Under `normalise`, foci near each other cost each other amplitude when they are evened out. Returns to the sums of
/// the paper's q_j where all foci are louder with them.
double keep_louder(double largest, Scratch& scratch) {
  const double even = weakest_of_sums(scratch.sums, scratch);
  scratch.even.assign(scratch.sums.begin(), scratch.sums.end());
  for (std::size_t j = 0; j < scratch.columns.foci; ++j)
    scratch.weights[j] = {.plain = scratch.gains[j], .heard = scratch.gains[j]};
  const double plain = sum_columns(scratch);
  if (weakest_of_sums(scratch.sums, scratch) > even) return plain;
  std::ranges::copy(scratch.even, scratch.sums.begin());
  return largest;
}

/// The same with the factors of the solver, from `scratch.columns`.
double sum_weighted(const DriveOptions& options, Scratch& scratch) {
  const Columns& columns = scratch.columns;
  scratch.weights.resize(columns.foci);
  scratch.sums.resize(columns.transducers);
  if (is_gs_pat(options.solver)) {
    const LoudEfforts* const effort = loud_effort(care_of(options.solver), options.constraint, columns.foci,
                                                  columns.transducers, [&] { return are_near(scratch); });
    if (effort) {
      loud_phases(columns, scratch.gains, options.constraint, *effort, scratch.sums, scratch.loud);
      return 1;
    }
  }
  multiply(columns, scratch.matrix);
  if (options.solver == Solver::eigenvalue) {
    find_weights(scratch, [&](std::span<const double> gains, std::span<Complex> factors) {
      eigenvalue_factors(scratch.matrix, columns, gains, factors, scratch.eigenvalue);
    });
    return sum_columns(scratch);
  }
  if (options.solver == Solver::back_propagation) {
    find_weights(scratch, [&](std::span<const double> gains, std::span<Complex> factors) {
      propagated_factors(scratch.matrix, columns, gains, options.constraint, factors, scratch.heard);
    });
    return sum_columns(scratch);
  }
  gs_pat(scratch.matrix, columns, scratch.gains, options.constraint, scratch.weights, scratch.gs_pat);
  const double largest = sum_columns(scratch);
  if (options.constraint == Constraint::normalise && may_be_plain(options, scratch.gains) && are_near(scratch))
    return keep_louder(largest, scratch);
  gs_pat_turn(columns, options.constraint, scratch.sums, scratch.gs_pat);
  return largest;
}

void drive_greedily(std::span<TransducerDrive> out, Scratch& scratch, double shared) {
  scratch.phases.resize(out.size());
  greedy(scratch.columns, scratch.gains, scratch.phases);
  for (std::size_t t = 0; t < out.size(); ++t) {
    const double turns = static_cast<double>(scratch.phases[t]) / greedy_phases;
    out[t] = {as_amplitude(shared), as_phase(2 * std::numbers::pi * (turns > 0.5 ? turns - 1 : turns))};
  }
}

/// Fills the columns of the sources, and their gains relative to the shared one.
void fill_columns(const Layout& layout, const DriveOptions& options, double shared, Scratch& scratch) {
  transfer_of(layout, options, scratch.free_field).fill(scratch.sources, options.weighting, scratch.columns);
  scratch.gains.clear();
  for (const Source& source : scratch.sources)
    scratch.gains.push_back(relative_gain(source, shared));
}

void drive_with_nulls(const Layout& layout, const DriveOptions& options, std::span<TransducerDrive> out,
                      Scratch& scratch) {
  assert(!options.transfer && options.nulls->rows().transducers == layout.transducers.size());
  const double shared = shared_gain_of(scratch.sources);
  fill_columns(layout, options, shared, scratch);
  multiply(scratch.columns, scratch.matrix);
  scratch.weights.resize(scratch.sources.size());
  scratch.sums.resize(out.size());
  const double largest =
      sum_with_nulls(*options.nulls, scratch.columns, scratch.matrix, scratch.gains, options.constraint,
                     scratch.weights, scratch.sums, scratch.gs_pat, scratch.nulls);
  constrain(scratch.sums, largest, options, shared, out);
}

void drive_several(const Layout& layout, const DriveOptions& options, std::span<TransducerDrive> out,
                   Scratch& scratch) {
  const double shared = shared_gain_of(scratch.sources);
  const bool solved = is_solved(options, scratch.sources.size(), layout.transducers.size());
  if (solved) {
    fill_columns(layout, options, shared, scratch);
    if (options.solver == Solver::greedy) return drive_greedily(out, scratch, shared);
  }
  double largest = 0;
  if (solved) {
    largest = sum_weighted(options, scratch);
  } else {
    scratch.weights.clear();
    for (const Source& source : scratch.sources)
      scratch.weights.push_back({.heard = relative_gain(source, shared)});
    largest = sum_sources(layout, options, scratch);
  }
  constrain(scratch.sums, largest, options, shared, out);
}

/// Puts the drivable foci into `scratch.sources`.
void find_sources(const Layout& layout, std::span<const SlotFocus> foci, Scratch& scratch) {
  scratch.sources.clear();
  for (const SlotFocus& focus : foci) {
    if (!drivable(focus)) continue;
    scratch.sources.push_back({focus.position, farthest_distance(layout, focus.position), gain_of(focus)});
  }
}

/// The sum of the sources' q_j times `scratch.factors`.
void drive_sources(const Layout& layout, const DriveOptions& options, std::span<TransducerDrive> out,
                   Scratch& scratch) {
  if (scratch.sources.size() == 1) {  // the paper's q_k, turned down
    Source source = scratch.sources[0];
    source.gain = as_amplitude(std::abs(scratch.factors[0]));  // its phase has no effect
    return drive_one(layout, source, options, out, scratch.columns);
  }
  scratch.weights.clear();
  for (const Complex& factor : scratch.factors)
    scratch.weights.push_back({.heard = factor});
  sum_sources(layout, options, scratch);
  drive_sums(scratch.sums, 1, 1, out);
}

/// The factors that give the drivable foci their requested pressures.
void find_factors(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options,
                  Scratch& scratch) {
  scratch.foci.clear();
  std::ranges::copy_if(foci, std::back_inserter(scratch.foci), drivable);
  const std::size_t count = scratch.sources.size();
  const Transfer& transfer = transfer_of(layout, options, scratch.free_field);
  scratch.targets.resize(count);
  scratch.factors.resize(count);
  for (std::size_t first = 0, end = 0; first < count; first = end) {
    end = part_end(scratch.foci, first);
    const std::span targets = std::span(scratch.targets).subspan(first, end - first);
    const std::span part = std::span<const SlotFocus>(scratch.foci).subspan(first, end - first);
    transfer.fill(std::span(scratch.sources).subspan(first, end - first), options.weighting, scratch.columns);
    multiply(scratch.columns, scratch.matrix);
    for (std::size_t j = 0; j < part.size(); ++j) {
      const bool heard = scratch.matrix.alone(j) > 0;
      targets[j] = heard ? part[j].pressure_pa.value_or(0) / layout.source_level_pa_m : 0;
    }
    cap_unasked(scratch.matrix, part, targets);
    const std::span factors = std::span(scratch.factors).subspan(first, end - first);
    start_pressures(scratch.matrix, scratch.columns, phases_of(options.solver), targets, factors, scratch.pressures);
    release_unasked(part, targets);
    correct_pressures(scratch.matrix, targets, factors, scratch.pressures);
  }
  if (count <= most_solved_foci) return;
  scratch.heard.resize(count);
  keep_below(transfer, layout, scratch.foci, scratch.sources, options.weighting, scratch.factors, scratch.columns,
             scratch.heard);
}

}  // namespace

double sound_speed_at(double celsius) {
  if (!(celsius >= least_celsius && celsius <= most_celsius)) {
    throw bad_usage(fmt::format("temperature {}: give degrees Celsius from {} to {}, such as 20", celsius,
                                least_celsius, most_celsius));
  }
  return 331.3 * std::sqrt(1 + celsius / 273.15);
}

const Transfer& transfer_of(const Layout& layout, const DriveOptions& options, FreeField& free_field) {
  if (options.transfer) return *options.transfer;
  free_field.set(layout, options.medium, options.directivity);
  return free_field;
}

std::size_t quick_foci(std::size_t transducers, const DriveOptions& options, double within_s) {
  if (options.nulls) return 0;
  // A core of a Xeon does 1.4e7 or more.
  constexpr double transducers_and_foci_per_s = 1e7;
  constexpr std::size_t any = std::numeric_limits<std::size_t>::max();
  if (options.solver == Solver::naive) return any;
  const bool searches = options.solver == Solver::loudest ||
                        (options.solver == Solver::back_propagation && options.constraint != Constraint::normalise);
  if (searches) return 1;  // 3.7 ms for two foci in `paper`
  if (static_cast<double>(options.most_work) <= within_s * transducers_and_foci_per_s) return any;
  const double foci = within_s * transducers_and_foci_per_s / std::max(static_cast<double>(transducers), 1.0);
  return static_cast<std::size_t>(std::clamp(foci, 1.0, 1e6));
}

DriveScratch::DriveScratch() : parts_(std::make_unique<Parts>()) {}
DriveScratch::~DriveScratch() = default;
DriveScratch::DriveScratch(DriveScratch&&) noexcept = default;
DriveScratch& DriveScratch::operator=(DriveScratch&&) noexcept = default;

void drive_for(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options,
               std::span<TransducerDrive> out, DriveScratch& memory) {
  Scratch& scratch = memory.parts();
  assert(out.size() == layout.transducers.size());
  find_sources(layout, foci, scratch);
  const std::vector<Source>& sources = scratch.sources;
  if (sources.empty()) {
    std::ranges::fill(out, TransducerDrive{0, 0});
  } else if (options.nulls) {
    drive_with_nulls(layout, options, out, scratch);
  } else if (std::ranges::any_of(foci, [](const SlotFocus& focus) { return focus.pressure_pa.has_value(); })) {
    find_factors(layout, foci, options, scratch);
    drive_sources(layout, options, out, scratch);
  } else if (sources.size() == 1) {
    drive_one(layout, sources[0], options, out, scratch.columns);
  } else {
    drive_several(layout, options, out, scratch);
  }
}

void drive_by_factors(const Layout& layout, std::span<const SlotFocus> foci, std::span<const Complex> factors,
                      const DriveOptions& options, std::span<TransducerDrive> out, DriveScratch& memory) {
  Scratch& scratch = memory.parts();
  assert(factors.size() == foci.size());
  find_sources(layout, foci, scratch);
  scratch.factors.clear();
  for (std::size_t j = 0; j < foci.size(); ++j) {
    if (drivable(foci[j])) scratch.factors.push_back(factors[j]);
  }
  drive_sources(layout, options, out, scratch);
}

void reserve(DriveScratch& memory, const Layout& layout, const DriveOptions& options, std::size_t most_foci) {
  Scratch& scratch = memory.parts();
  const std::size_t transducers = layout.transducers.size();
  constexpr std::size_t few = most_solved_foci, square = few * few;
  scratch.free_field.set(layout, options.medium, options.directivity);
  scratch.sources.reserve(most_foci);
  scratch.foci.reserve(most_foci);
  scratch.sums.reserve(transducers);
  scratch.even.reserve(transducers);
  scratch.phases.reserve(transducers);
  scratch.weights.reserve(most_foci);
  Columns& columns = scratch.columns;
  // hear_all processes at least one transducer for all foci at a time.
  for (std::vector<double>* values : {&columns.cosine, &columns.sine, &columns.loud, &columns.asked})
    values->reserve(std::max(few * transducers, most_foci));
  for (std::vector<double>* values : {&scratch.matrix.re, &scratch.matrix.im})
    values->reserve(square);
  for (std::vector<double>* values : {&scratch.gains, &scratch.targets})
    values->reserve(most_foci);
  for (std::vector<Complex>* values : {&scratch.factors, &scratch.heard})
    values->reserve(most_foci);
  PressureScratch& pressures = scratch.pressures;
  pressures.gains.reserve(few);
  pressures.targets.reserve(few);
  pressures.weights.reserve(few);
  for (GsPatScratch* gs_pat : {&scratch.gs_pat, &pressures.gs_pat}) {
    for (std::vector<Complex>* values : {&gs_pat->pressure, &gs_pat->factors, &gs_pat->start})
      values->reserve(few);
    gs_pat->claims.reserve(few);
    gs_pat->targets.reserve(few);
  }
  PhaseScratch& turning = scratch.gs_pat.phases;
  turning.tried.reserve(transducers);
  for (std::vector<Complex>* values : {&turning.pressure, &turning.tried_pressure, &turning.pull})
    values->reserve(few);
  for (std::vector<Complex>* values : {&turning.alike, &turning.across, &turning.tried_across})
    values->reserve(square);
  turning.normal.reserve(square);
  for (std::vector<double>* values : {&turning.rest, &turning.miss, &turning.tried_miss})
    values->reserve(few);
  reserve(scratch.loud, transducers, few);
  for (std::vector<double>* values :
       {&scratch.ears.cosine, &scratch.ears.sine, &scratch.ears.loud, &scratch.ears.asked})
    values->reserve(loud_ears * few);
  for (EvenScratch* even : {&scratch.gs_pat.even, &pressures.gs_pat.even, &pressures.even}) {
    for (std::vector<Complex>* values : {&even->pressure, &even->tried_pressure, &even->tried})
      values->reserve(few);
    even->slopes.reserve(square);
    even->normal.reserve(square);
    even->rest.reserve(few);
    even->miss.reserve(few);
  }
  scratch.eigenvalue.vector.reserve(few);
  scratch.eigenvalue.next.reserve(few);
  scratch.eigenvalue.system.reserve(square);
  if (options.nulls) reserve(scratch.nulls, *options.nulls, most_foci);
}

void drive_for(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options,
               std::span<TransducerDrive> out) {
  DriveScratch scratch;
  drive_for(layout, foci, options, out, scratch);
}

Drive drive_for(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options) {
  Drive drive(layout.transducers.size());
  drive_for(layout, foci, options, drive);
  return drive;
}

}  // namespace palpa::array
