// The solvers' part of the benchmark: ten foci at once, far apart, and as near to each other as on a fingertip.
// Measures solves per second and their quality.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "acoustics/field/pressure.hpp"
#include "array/drive_pass.hpp"
#include "array/layouts/layout.hpp"
#include "array/slot_drives.hpp"
#include "base/error.hpp"
#include "base/system/parallel.hpp"
#include "bench/bench.hpp"
#include "gpu/commands.hpp"

namespace palpa::bench {
namespace {

using array::Constraint;
using array::Solver;

constexpr std::uint32_t far_sets = 100;     // slots of a batch
constexpr std::size_t far_judged_each = 3;  // one of so many is compared and evaluated
constexpr std::size_t foci_per_set = 10;
constexpr double cube_m = 0.06, apart_m = 8e-3;

std::vector<array::SlotFocus> random_set(std::mt19937& random, const Vec3& centre) {
  std::uniform_real_distribution<double> place(-cube_m / 2, cube_m / 2);
  std::vector<array::SlotFocus> foci;
  while (foci.size() < foci_per_set) {
    const double x = place(random), y = place(random), z = place(random);
    const Vec3 position = centre + Vec3(x, y, z);
    if (std::ranges::all_of(foci,
                            [&](const auto& other) { return glm::distance(other.position, position) >= apart_m; }))
      foci.push_back({position, 1});
  }
  return foci;
}

/// Rings of 2 to 10 mm radius in five planes, and balls of 4 and 8 mm radius.
std::vector<std::vector<array::SlotFocus>> near_sets(const Vec3& centre) {
  std::mt19937 random(5);
  std::normal_distribution<double> any;
  std::uniform_real_distribution<double> place(-1, 1);
  const auto direction = [&] {
    const double x = any(random), y = any(random), z = any(random);
    return glm::normalize(Vec3(x, y, z));
  };
  const Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  std::vector<std::vector<array::SlotFocus>> slots;
  for (const double radius : {2e-3, 2.5e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3, 8e-3, 10e-3}) {
    const Vec3 one = direction(), two = direction(), other = direction(), another = direction();
    for (const auto& [u, v] : {std::pair(x, y),
                               {x, z},
                               {y, z},
                               {one, glm::normalize(glm::cross(one, two))},
                               {other, glm::normalize(glm::cross(other, another))}}) {
      std::vector<array::SlotFocus>& foci = slots.emplace_back();
      for (std::size_t i = 0; i < foci_per_set; ++i) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(i) / foci_per_set;
        foci.push_back({centre + radius * (std::cos(angle) * u + std::sin(angle) * v), 1});
      }
    }
  }
  for (std::uint32_t set = 0; set < 40; ++set) {
    std::vector<array::SlotFocus>& foci = slots.emplace_back();
    while (foci.size() < foci_per_set) {
      const double a = place(random), b = place(random), c = place(random);
      if (const Vec3 way(a, b, c); glm::length(way) <= 1)
        foci.push_back({centre + (set % 2 == 0 ? 4e-3 : 8e-3) * way, 1});
    }
  }
  return slots;
}

/// What is heard of a slot.
struct Judged {
  std::size_t slot = 0;
  double mean_pa = 0, weakest_pa = 0, even = 1;
};
using Heard = std::vector<Judged>;  ///< slots ascend

/// Foci of many slots.
struct Sets {
  std::string name;
  array::Layout layout;
  std::vector<std::vector<array::SlotFocus>> slots;
  std::size_t judged_each = 1;  ///< one slot of so many is listened to
  double apart = 0.01;          ///< the part of the mean pressure by which device and twin may differ
};

struct Case {
  const char* name;
  Solver solver;
  Constraint constraint;
};
constexpr Case cases[]{{"naive normalise", Solver::naive, Constraint::normalise},
                       {"naive uniform", Solver::naive, Constraint::uniform},
                       {"naive clamp", Solver::naive, Constraint::clamp},
                       {"greedy", Solver::greedy, Constraint::uniform},
                       {"gs-pat normalise", Solver::gs_pat, Constraint::normalise},
                       {"gs-pat uniform", Solver::gs_pat, Constraint::uniform},
                       {"gs-pat clamp", Solver::gs_pat, Constraint::clamp},
                       {"loudest uniform", Solver::loudest, Constraint::uniform},
                       {"loudest clamp", Solver::loudest, Constraint::clamp},
                       {"eigenvalue normalise", Solver::eigenvalue, Constraint::normalise},
                       {"eigenvalue uniform", Solver::eigenvalue, Constraint::uniform},
                       {"eigenvalue clamp", Solver::eigenvalue, Constraint::clamp},
                       {"back-propagation normalise", Solver::back_propagation, Constraint::normalise},
                       {"back-propagation uniform", Solver::back_propagation, Constraint::uniform},
                       {"back-propagation clamp", Solver::back_propagation, Constraint::clamp}};

/// Solved over the whole array, step by step. Only one set of slow_each has to be.
bool is_slow(const Case& which) {
  return which.solver == Solver::back_propagation && which.constraint != Constraint::normalise;
}
constexpr std::size_t slow_each = 3;

array::DriveOptions options_of(const Case& which) {
  array::DriveOptions options;
  options.solver = which.solver;
  options.constraint = which.constraint;
  return options;
}

/// The slots that a case solves.
std::vector<std::size_t> slots_of(const Case& which, const Sets& sets) {
  std::vector<std::size_t> slots;
  for (std::size_t s = 0; s < sets.slots.size(); s += is_slow(which) ? slow_each : 1)
    slots.push_back(s);
  return slots;
}
/// Those of them that are listened to.
std::vector<std::size_t> judged_of(const Case& which, const Sets& sets) {
  std::vector<std::size_t> slots = slots_of(which, sets);
  std::erase_if(slots, [&](std::size_t slot) { return slot % sets.judged_each != 0; });
  return slots;
}

/// The drives of slots by the twins, on all cores.
class Twins {
 public:
  Twins(const Sets& sets, std::span<const std::size_t> slots, const array::DriveOptions& options)
      : layout_(sets.layout), options_(options), out_(slots.size() * sets.layout.transducers.size()) {
    drives_.reserve(layout_, options_, slots.size(), slots.size() * foci_per_set);
    for (const std::size_t slot : slots)
      drives_.add(sets.slots[slot], {});
  }
  void solve() { drives_.solve(layout_, options_, out_); }
  std::span<const array::TransducerDrive> drive(std::size_t number) const {
    const std::size_t transducers = layout_.transducers.size();
    return std::span(out_).subspan(number * transducers, transducers);
  }

 private:
  const array::Layout& layout_;
  array::DriveOptions options_;
  array::SlotDrives drives_;
  array::Drive out_;
};

/// `drive_of`: the drive of a slot, by its number among all of them.
template <typename DriveOf>
Heard listen(const Sets& sets, std::span<const std::size_t> slots, DriveOf drive_of) {
  Heard heard(slots.size());
  parallel_chunks(slots.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    const acoustics::FociPressure pressure =
        acoustics::pressure_at_foci(sets.layout, drive_of(slots[i]), sets.slots[slots[i]]);
    heard[i] = {slots[i], pressure.mean, *std::ranges::min_element(pressure.pascals), pressure.evenness};
  });
  return heard;
}

double mean_of(const Heard& heard) {
  double sum = 0;
  for (const Judged& slot : heard)
    sum += slot.mean_pa / static_cast<double>(heard.size());
  return sum;
}
double evenness_of(const Heard& heard) {
  return std::ranges::min_element(heard, {}, &Judged::even)->even;
}

/// The references for the figures: naive under the same constraint, and greedy.
struct Yardsticks {
  Heard naive[3], greedy;
};

/// The same slots as in `heard`, of more.
Heard same_slots(const Heard& heard, const Heard& more) {
  Heard same;
  for (const Judged& slot : heard)
    same.push_back(*std::ranges::lower_bound(more, slot.slot, {}, &Judged::slot));
  return same;
}

std::string quality(const Case& which, const Sets& sets, const Heard& heard, const Yardsticks& yardsticks) {
  const Heard naive = same_slots(heard, yardsticks.naive[static_cast<int>(which.constraint)]);
  std::string text = fmt::format("weakest/strongest {:.3f}; mean {:.0f} Pa, {:.2f} of naive", evenness_of(heard),
                                 mean_of(heard), mean_of(heard) / mean_of(naive));
  if (yardsticks.greedy.empty()) return text;
  const Heard greedy = same_slots(heard, yardsticks.greedy);
  text += fmt::format(" and {:.2f} of greedy", mean_of(heard) / mean_of(greedy));
  if (sets.judged_each > 1) return text;
  double least = std::numeric_limits<double>::infinity();
  int behind = 0;
  for (std::size_t i = 0; i < heard.size(); ++i) {
    least = std::min(least, heard[i].weakest_pa / greedy[i].weakest_pa);
    behind += heard[i].even < greedy[i].even;
  }
  return text + fmt::format("; weakest at least {:.2f} of greedy's; {} of {} sets are less even than greedy's", least,
                            behind, heard.size());
}

void keep(const Case& which, const Heard& heard, Yardsticks& yardsticks) {
  if (which.solver == Solver::naive) yardsticks.naive[static_cast<int>(which.constraint)] = heard;
  if (which.solver == Solver::greedy) yardsticks.greedy = heard;
}

/// The passes of each solver, made once: a software device is slow to make some kernels.
class Passes {
 public:
  explicit Passes(const gpu::Device& device) : device_(device) {}
  const array::DrivePasses& of(Solver solver) {
    const Solver which = array::is_gs_pat(solver) ? Solver::gs_pat : solver;
    return made_.try_emplace(which, device_, which).first->second;
  }

 private:
  const gpu::Device& device_;
  std::map<Solver, array::DrivePasses> made_;
};

Row rate_of(const std::string& name, std::size_t slots, const std::vector<double>& times_ms, const std::string& note) {
  Row row = make_row("array", name, "total", times_ms);
  row.value = static_cast<double>(slots) * 1e3 / row.median_ms;
  row.unit = "solves/s";
  row.note = note;
  return row;
}

std::uint32_t most_runs(const Context& context) {
  return std::clamp(context.runs / 10, 3u, 50u);
}

void on_device(const Context& context, const Sets& sets, const Case& which, Passes& passes, Yardsticks& yardsticks,
               std::vector<Row>& rows) {
  const std::string name = sets.name + " " + which.name;
  const array::DriveOptions options = options_of(which);
  const array::DrivePasses& made = passes.of(which.solver);
  const std::vector<std::size_t> slots = slots_of(which, sets), judged = judged_of(which, sets);
  const auto count = static_cast<std::uint32_t>(slots.size());
  array::DriveMemory buffers(context.device, sets.layout, options, count, count * foci_per_set);
  const gpu::Recorder recorder(context.device, "bench");
  gpu::Timeline timeline(context.device);
  const auto batch = [&] {
    buffers.clear();
    for (const std::size_t slot : slots) {
      if (!buffers.add_slot(sets.slots[slot])) throw failure("bench: the batch does not fit the device's buffers");
    }
    array::compute_drives(buffers, made, recorder, timeline);
  };
  batch();
  const auto number_in = [](const std::vector<std::size_t>& all, std::size_t slot) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(all, slot) - all.begin());
  };
  const Heard heard = listen(sets, judged, [&](std::size_t slot) { return buffers.drive(number_in(slots, slot)); });
  keep(which, heard, yardsticks);
  // Factors and phases may differ if several are equally good; the resulting sound may not.
  Twins twins(sets, judged, options);
  twins.solve();
  const Heard expected = listen(sets, judged, [&](std::size_t slot) { return twins.drive(number_in(judged, slot)); });
  if (std::abs(mean_of(heard) / mean_of(expected) - 1) > sets.apart ||
      std::abs(evenness_of(heard) - evenness_of(expected)) > 0.02)
    twins_disagree(name);
  rows.push_back(rate_of(name, count, time_runs(context, name, most_runs(context), batch),
                         quality(which, sets, heard, yardsticks)));
}

void on_host(const Context& context, const Sets& sets, const Case& which, const Yardsticks& yardsticks,
             std::vector<Row>& rows) {
  const std::string name = fmt::format("{} {} C++", sets.name, which.name);
  const std::vector<std::size_t> slots = slots_of(which, sets), judged = judged_of(which, sets);
  Twins twins(sets, slots, options_of(which));
  twins.solve();
  const Heard heard = listen(sets, judged, [&](std::size_t slot) {
    return twins.drive(static_cast<std::size_t>(std::ranges::lower_bound(slots, slot) - slots.begin()));
  });
  rows.push_back(rate_of(name, slots.size(), time_runs(context, name, most_runs(context), [&] { twins.solve(); }),
                         quality(which, sets, heard, yardsticks) + fmt::format(" ({} threads)", worker_count())));
}

/// Random sets far apart, device and twins.
void measure_far(const Context& context, const std::string& layout, const Vec3& centre, Passes& passes,
                 std::vector<Row>& rows) {
  std::mt19937 random(1);
  Sets sets{.name = layout, .layout = array::load_layout(layout), .slots = {}, .judged_each = far_judged_each};
  for (std::uint32_t set = 0; set < far_sets; ++set)
    sets.slots.push_back(random_set(random, centre));
  Yardsticks yardsticks;
  for (const Case& which : cases)
    on_device(context, sets, which, passes, yardsticks, rows);
  for (const Case& which : cases)
    on_host(context, sets, which, yardsticks, rows);
}

/// For near foci, several drives are equally good; device and twin may choose different ones.
void measure_near(const Context& context, const std::string& layout, const Vec3& centre, Passes& passes,
                  std::vector<Row>& rows) {
  const Sets sets{
      .name = layout + " near", .layout = array::load_layout(layout), .slots = near_sets(centre), .apart = 0.05};
  Yardsticks yardsticks;
  for (const Case& which : cases)
    on_device(context, sets, which, passes, yardsticks, rows);
}

}  // namespace

void measure_solvers(const Context& context, std::vector<Row>& rows) {
  const Vec3 above(0, 0, 0.15);
  Passes passes(context.device);
  measure_far(context, "paper", Vec3(0), passes, rows);
  measure_near(context, "paper", Vec3(0), passes, rows);
  measure_far(context, "openmpd", above, passes, rows);
  measure_near(context, "openmpd", above, passes, rows);
  measure_near(context, "autd3", above, passes, rows);
}

}  // namespace palpa::bench
