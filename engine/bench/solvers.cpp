// The solvers' part of the benchmark: ten foci at once, far apart, and as near to each other as on a fingertip.
// Measures solves per second and their quality.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <thread>

#include "acoustics/field/pressure.hpp"
#include "array/drive_pass.hpp"
#include "base/error.hpp"
#include "base/now.hpp"
#include "bench/bench.hpp"
#include "gpu/commands.hpp"

namespace palpa::bench {
namespace {

using array::Constraint;
using array::Solver;

constexpr std::uint32_t sets = 100;       // slots of a batch
constexpr std::uint32_t far_judged = 10;  // number of slots that are compared and evaluated
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

/// The loudness of the evaluated slots, and the evenness of the least even one.
struct Heard {
  double mean_pa = 0, evenness = 1;
  std::vector<double> weakest_pa, even;  ///< slot by slot
};
template <typename DriveOf>
Heard listen(const array::Layout& layout, const std::vector<std::vector<array::SlotFocus>>& slots, std::uint32_t judged,
             DriveOf drive_of) {
  Heard heard;
  for (std::uint32_t s = 0; s < judged; ++s) {
    const acoustics::FociPressure pressure = acoustics::pressure_at_foci(layout, drive_of(s), slots[s]);
    heard.mean_pa += pressure.mean / judged;
    heard.evenness = std::min(heard.evenness, pressure.evenness);
    heard.even.push_back(pressure.evenness);
    heard.weakest_pa.push_back(*std::ranges::min_element(pressure.pascals));
  }
  return heard;
}

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

/// The references for the figures: those of naive under the same constraint, and those of greedy.
struct Yardsticks {
  double naive_pa[3] = {}, greedy_pa = 0;
  std::vector<double> greedy_weakest_pa, greedy_even;
};

std::string quality(const Case& which, const Heard& heard, const Yardsticks& yardsticks) {
  std::string text = fmt::format("weakest/strongest {:.3f}; mean {:.2f} of naive", heard.evenness,
                                 heard.mean_pa / yardsticks.naive_pa[static_cast<int>(which.constraint)]);
  if (yardsticks.greedy_pa > 0) text += fmt::format(" and {:.2f} of greedy", heard.mean_pa / yardsticks.greedy_pa);
  if (yardsticks.greedy_weakest_pa.empty()) return text;
  double least = std::numeric_limits<double>::infinity();
  int behind = 0;
  for (std::size_t s = 0; s < heard.weakest_pa.size(); ++s) {
    least = std::min(least, heard.weakest_pa[s] / yardsticks.greedy_weakest_pa[s]);
    behind += heard.even[s] < yardsticks.greedy_even[s];
  }
  return text + fmt::format("; weakest at least {:.2f} of greedy's; {} of {} sets are less even than greedy's", least,
                            behind, heard.even.size());
}

void keep(const Case& which, const Heard& heard, Yardsticks& yardsticks) {
  if (which.solver == Solver::naive) yardsticks.naive_pa[static_cast<int>(which.constraint)] = heard.mean_pa;
  if (which.solver != Solver::greedy) return;
  yardsticks.greedy_pa = heard.mean_pa;
  yardsticks.greedy_weakest_pa = heard.weakest_pa;
  yardsticks.greedy_even = heard.even;
}

void on_device(const Context& context, const array::Layout& layout, const Case& which, const std::string& name,
               const std::vector<std::vector<array::SlotFocus>>& slots, std::uint32_t judged, double apart,
               Yardsticks& yardsticks, std::vector<Row>& rows) {
  array::DriveOptions options;
  options.solver = which.solver;
  options.constraint = which.constraint;
  const array::DrivePasses passes(context.device, which.solver);
  const auto count = static_cast<std::uint32_t>(slots.size());
  array::DriveMemory buffers(context.device, layout, options, count, count * foci_per_set);
  const gpu::Recorder recorder(context.device, "bench");
  gpu::Timeline timeline(context.device);
  const auto batch = [&] {
    buffers.clear();
    for (const auto& slot : slots) {
      if (!buffers.add_slot(slot)) throw failure("bench: the batch does not fit the device's buffers");
    }
    buffers.record(recorder.begin(), passes);
    timeline.submit(recorder.end());
    buffers.solve_on_host();
    timeline.wait(timeline.last());
  };
  batch();
  const Heard heard = listen(layout, slots, judged, [&](std::uint32_t s) { return buffers.drive(s); });
  keep(which, heard, yardsticks);
  // Factors and phases may differ if several are equally good; the resulting sound may not.
  const Heard expected =
      listen(layout, slots, judged, [&](std::uint32_t s) { return array::drive_for(layout, slots[s], options); });
  if (std::abs(heard.mean_pa / expected.mean_pa - 1) > apart || std::abs(heard.evenness - expected.evenness) > 0.02)
    throw failure(fmt::format("bench: {}: device and C++ twin disagree; nothing was timed", name));

  std::vector<double> total;
  const std::uint32_t runs = std::clamp(context.runs / 10, 3u, 50u);
  for (std::uint32_t run = 0; run < runs + 1; ++run) {
    const double begin = now_ms();
    batch();
    if (run > 0) total.push_back(now_ms() - begin);
    context.progress(name, run, runs);
  }
  Row row = make_row("array", name, "total", total);
  row.value = count * 1e3 / row.median_ms;
  row.unit = "solves/s";
  row.note = quality(which, heard, yardsticks);
  rows.push_back(row);
}

/// The twins, with one thread per core; the slots are interleaved among the threads.
void on_host(const Context& context, const array::Layout& layout, const Case& which, const std::string& name,
             const std::vector<std::vector<array::SlotFocus>>& slots, std::uint32_t judged,
             const Yardsticks& yardsticks, std::vector<Row>& rows) {
  array::DriveOptions options;
  options.solver = which.solver;
  options.constraint = which.constraint;
  const auto count = static_cast<std::uint32_t>(slots.size());
  const std::uint32_t cores = std::clamp(std::thread::hardware_concurrency(), 1u, count);
  std::vector<array::Drive> drives(count, array::Drive(layout.transducers.size()));
  std::vector<array::DriveScratch> scratch(cores);
  const auto batch = [&] {
    std::vector<std::jthread> threads;
    for (std::uint32_t core = 0; core < cores; ++core) {
      threads.emplace_back([&, core] {
        for (std::uint32_t s = core; s < count; s += cores)
          array::drive_for(layout, slots[s], options, drives[s], scratch[core]);
      });
    }
  };
  batch();
  std::vector<double> total;
  for (std::uint32_t run = 0; run < 5; ++run) {
    const double begin = now_ms();
    batch();
    total.push_back(now_ms() - begin);
    context.progress(name, run, 4);
  }
  Row row = make_row("array", name, "total", total);
  row.value = count * 1e3 / row.median_ms;
  row.unit = "solves/s";
  row.note =
      quality(which, listen(layout, slots, judged, [&](std::uint32_t s) { return std::span(drives[s]); }), yardsticks) +
      fmt::format(" ({} threads)", cores);
  rows.push_back(row);
}

/// Random sets far apart, device and twins.
void measure_far(const Context& context, const std::string& name, const Vec3& centre, std::vector<Row>& rows) {
  const array::Layout layout = array::load_layout(name);
  std::mt19937 random(1);
  std::vector<std::vector<array::SlotFocus>> slots(sets);
  for (auto& slot : slots)
    slot = random_set(random, centre);
  Yardsticks yardsticks;
  for (const Case& which : cases) {
    if (array::is_of_host(which.solver)) continue;  // the device would give the host's row again
    on_device(context, layout, which, fmt::format("{} {}", name, which.name), slots, far_judged, 0.01, yardsticks,
              rows);
  }
  for (const Case& which : cases)
    on_host(context, layout, which, fmt::format("{} {} C++", name, which.name), slots, far_judged, yardsticks, rows);
}

void measure_near(const Context& context, const std::string& name, const Vec3& centre, std::vector<Row>& rows) {
  const array::Layout layout = array::load_layout(name);
  const auto slots = near_sets(centre);
  Yardsticks yardsticks;
  const auto judged = static_cast<std::uint32_t>(slots.size());
  for (const Case& which : cases) {
    const std::string row = fmt::format("{} near {}", name, which.name);
    if (array::is_of_host(which.solver)) {
      on_host(context, layout, which, row + " C++", slots, judged, yardsticks, rows);
    } else {
      // For near foci, several drives are equally good; device and twin may choose different ones.
      on_device(context, layout, which, row, slots, judged, 0.05, yardsticks, rows);
    }
  }
}

}  // namespace

void measure_solvers(const Context& context, std::vector<Row>& rows) {
  const Vec3 above(0, 0, 0.15);
  measure_far(context, "paper", Vec3(0), rows);
  measure_near(context, "paper", Vec3(0), rows);
  measure_far(context, "openmpd", above, rows);
  measure_near(context, "openmpd", above, rows);
  measure_near(context, "autd3", above, rows);
}

}  // namespace palpa::bench
