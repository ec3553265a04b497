#include "array/drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <numbers>

#include "array/crowd.hpp"
#include "array/solvers/greedy.hpp"
#include "base/error.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;
using Source = FocusSource;

/// The largest float that is not above pi; pi itself would round up.
constexpr float float_pi = 3.1415925f;

float as_phase(double radians) {
  return std::clamp(static_cast<float>(radians), -float_pi, float_pi);
}
float as_amplitude(double amplitude) {
  return static_cast<float>(std::clamp(amplitude, 0.0, 1.0));
}

/// -k d in turns, wrapped to (-1/2, 1/2].
double delay_turns(double distance, const Medium& medium) {
  const double turns = distance * medium.turns_per_metre();
  const double early = std::floor(turns) - turns;
  return early <= -0.5 ? early + 1 : early;
}

double asked_amplitude(double distance, double reach, Weighting weighting) {
  return weighting == Weighting::uniform || reach == 0 ? 1.0 : distance / reach;
}

double constrained(double amplitude, double largest, Constraint constraint) {
  switch (constraint) {
    case Constraint::normalise:
      return largest > 0 ? std::min(1.0, amplitude / largest) : (amplitude > 0 ? 1.0 : 0.0);
    case Constraint::uniform:
      return 1.0;
    case Constraint::clamp:
      return std::min(1.0, amplitude);
  }
  return 0;
}

/// The drive of one focus from `columns`, for another transfer than the free field.
void drive_one(const Columns& columns, const Source& source, std::span<TransducerDrive> out) {
  for (std::size_t t = 0; t < out.size(); ++t)
    out[t] = {as_amplitude(columns.asked[t] * source.gain), as_phase(-std::atan2(columns.sine[t], columns.cosine[t]))};
}

void drive_one(const Layout& layout, const Source& source, const DriveOptions& options, std::span<TransducerDrive> out,
               Columns& columns) {
  const Weighting weighting = options.constraint == Constraint::uniform ? Weighting::uniform : options.weighting;
  if (options.transfer) {
    options.transfer->fill(std::span(&source, 1), weighting, columns);
    return drive_one(columns, source, out);
  }
  for (std::size_t t = 0; t < out.size(); ++t) {
    const double distance = glm::distance(layout.transducers[t].position, source.position);
    out[t].amplitude = as_amplitude(asked_amplitude(distance, source.reach, weighting) * source.gain);
    out[t].phase = as_phase(2 * std::numbers::pi * delay_turns(distance, options.medium));
  }
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

/// q_j of the sources, the paper's or another transfer's.
class Asks {
 public:
  Asks(const Layout& layout, const DriveOptions& options, DriveScratch& scratch)
      : layout_(layout), options_(options), sources_(scratch.sources), columns_(scratch.columns) {
    if (options.transfer) options.transfer->fill(scratch.sources, options.weighting, scratch.columns);
  }
  Complex of(std::size_t transducer, std::size_t j) const {
    if (options_.transfer) return columns_.ask(transducer * columns_.foci + j);
    const double distance = glm::distance(layout_.transducers[transducer].position, sources_[j].position);
    return std::polar(asked_amplitude(distance, sources_[j].reach, options_.weighting),
                      2 * std::numbers::pi * delay_turns(distance, options_.medium));
  }

 private:
  const Layout& layout_;
  const DriveOptions& options_;
  const std::vector<Source>& sources_;
  const Columns& columns_;
};

/// The sums of every transducer, and the largest of them and of the plain ones.
double sum_naively(const Layout& layout, const DriveOptions& options, DriveScratch& scratch, double shared) {
  const Asks asks(layout, options, scratch);
  double largest = 0;
  for (std::size_t t = 0; t < layout.transducers.size(); ++t) {
    Complex plain = 0;
    for (std::size_t j = 0; j < scratch.sources.size(); ++j) {
      const Complex asked = asks.of(t, j);
      plain += asked;
      scratch.sums[t] += relative_gain(scratch.sources[j], shared) * asked;
    }
    largest = std::max({largest, std::abs(plain), std::abs(scratch.sums[t])});
  }
  return largest;
}

/// The same with the factors of gs_pat.
double sum_weighted(const DriveOptions& options, DriveScratch& scratch) {
  const Columns& columns = scratch.columns;
  scratch.weights.resize(columns.foci);
  multiply(columns, scratch.matrix);
  gs_pat(scratch.matrix, columns, scratch.gains, options.constraint, care_of(options.solver), scratch.weights,
         scratch.gs_pat);
  double largest = 0;
  for (std::size_t t = 0; t < columns.transducers; ++t) {
    Complex plain = 0;
    for (std::size_t j = 0; j < columns.foci; ++j) {
      const Complex asked = columns.ask(t * columns.foci + j);
      plain += scratch.weights[j].plain * asked;
      scratch.sums[t] += scratch.weights[j].heard * asked;
    }
    largest = std::max({largest, std::norm(plain), std::norm(scratch.sums[t])});
  }
  gs_pat_turn(columns, options.constraint, scratch.sums, scratch.gs_pat);
  return std::sqrt(largest);
}

void drive_greedily(std::span<TransducerDrive> out, DriveScratch& scratch, double shared) {
  scratch.phases.resize(out.size());
  greedy(scratch.columns, scratch.gains, scratch.phases);
  for (std::size_t t = 0; t < out.size(); ++t) {
    const double turns = static_cast<double>(scratch.phases[t]) / greedy_phases;
    out[t] = {as_amplitude(shared), as_phase(2 * std::numbers::pi * (turns > 0.5 ? turns - 1 : turns))};
  }
}

void drive_several(const Layout& layout, const DriveOptions& options, std::span<TransducerDrive> out,
                   DriveScratch& scratch) {
  const double shared = shared_gain_of(scratch.sources);
  const bool solved = options.solver != Solver::naive && scratch.sources.size() <= most_solved_foci;
  if (solved) {
    const Transfer& transfer = transfer_of(layout, options, scratch.free_field);
    transfer.fill(scratch.sources, options.weighting, scratch.columns);
    scratch.gains.clear();
    for (const Source& source : scratch.sources)
      scratch.gains.push_back(relative_gain(source, shared));
    if (options.solver == Solver::greedy) return drive_greedily(out, scratch, shared);
  }
  scratch.sums.assign(out.size(), 0);
  const double largest = solved ? sum_weighted(options, scratch) : sum_naively(layout, options, scratch, shared);
  for (std::size_t t = 0; t < out.size(); ++t) {
    const double amplitude = constrained(std::abs(scratch.sums[t]), largest, options.constraint);
    out[t] = {as_amplitude(amplitude * shared), as_phase(std::arg(scratch.sums[t]))};
  }
}

/// Puts the drivable foci into `scratch.sources`.
void find_sources(const Layout& layout, std::span<const SlotFocus> foci, DriveScratch& scratch) {
  scratch.sources.clear();
  for (const SlotFocus& focus : foci) {
    if (!drivable(focus)) continue;
    Source source{focus.position, 0, gain_of(focus)};
    for (const Transducer& transducer : layout.transducers) {
      source.reach = std::max(source.reach, glm::distance(transducer.position, focus.position));
    }
    scratch.sources.push_back(source);
  }
}

/// The sum of the sources' q_j times `scratch.factors`.
void drive_sources(const Layout& layout, const DriveOptions& options, std::span<TransducerDrive> out,
                   DriveScratch& scratch) {
  if (scratch.sources.size() == 1) {  // the paper's q_k, turned down
    Source source = scratch.sources[0];
    source.gain = as_amplitude(std::abs(scratch.factors[0]));  // its phase has no effect
    DriveOptions clamped = options;
    clamped.constraint = Constraint::clamp;
    return drive_one(layout, source, clamped, out, scratch.columns);
  }
  const Asks asks(layout, options, scratch);
  for (std::size_t t = 0; t < out.size(); ++t) {
    Complex sum = 0;
    for (std::size_t j = 0; j < scratch.sources.size(); ++j)
      sum += scratch.factors[j] * asks.of(t, j);
    out[t] = {as_amplitude(std::abs(sum)), as_phase(std::arg(sum))};
  }
}

/// The factors that give the drivable foci their requested pressures.
void find_factors(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options,
                  DriveScratch& scratch) {
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

bool drivable(const SlotFocus& focus) {
  const Vec3& p = focus.position;
  // Written so that NaN fails the test.
  return std::abs(p.x) <= 100 && std::abs(p.y) <= 100 && std::abs(p.z) <= 100;
}

float gain_of(const SlotFocus& focus) {
  return focus.gain > 0 ? std::min(1.0f, focus.gain) : 0.0f;
}

void drive_for(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options,
               std::span<TransducerDrive> out, DriveScratch& scratch) {
  assert(out.size() == layout.transducers.size());
  find_sources(layout, foci, scratch);
  const std::vector<Source>& sources = scratch.sources;
  if (sources.empty()) {
    std::ranges::fill(out, TransducerDrive{0, 0});
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
                      const DriveOptions& options, std::span<TransducerDrive> out, DriveScratch& scratch) {
  assert(factors.size() == foci.size());
  find_sources(layout, foci, scratch);
  scratch.factors.clear();
  for (std::size_t j = 0; j < foci.size(); ++j) {
    if (drivable(foci[j])) scratch.factors.push_back(factors[j]);
  }
  drive_sources(layout, options, out, scratch);
}

void reserve(DriveScratch& scratch, const Layout& layout, const DriveOptions& options, std::size_t most_foci) {
  const std::size_t transducers = layout.transducers.size();
  constexpr std::size_t few = most_solved_foci, square = few * few;
  scratch.free_field.set(layout, options.medium, options.directivity);
  scratch.sources.reserve(most_foci);
  scratch.foci.reserve(most_foci);
  scratch.sums.reserve(transducers);
  scratch.phases.reserve(transducers);
  scratch.weights.reserve(few);
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
  scratch.gs_pat.shares.reserve(few);
  for (std::vector<double>* values : {&scratch.gs_pat.near.re, &scratch.gs_pat.near.im})
    values->reserve(square);
  reserve(scratch.gs_pat.search, transducers, few);
  reserve(scratch.gs_pat.climb, transducers, few);
  for (EvenScratch* even : {&scratch.gs_pat.even, &pressures.gs_pat.even, &pressures.even}) {
    for (std::vector<Complex>* values : {&even->pressure, &even->tried_pressure, &even->tried})
      values->reserve(few);
    even->slopes.reserve(square);
    even->normal.reserve(square);
    even->rest.reserve(few);
    even->miss.reserve(few);
  }
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
