// Foci and nulls at once: four of each, at random places that the array resolves. Measures solves per second, how deep
// the nulls are, and what they cost.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "acoustics/field/pressure.hpp"
#include "array/drive.hpp"
#include "array/layouts/layout.hpp"
#include "array/nulls.hpp"
#include "base/error.hpp"
#include "bench/bench.hpp"

namespace palpa::bench {
namespace {

using array::Constraint;

constexpr std::uint32_t sets = 48;
constexpr std::size_t each = 4;  // foci, and nulls
constexpr double apart_m = 10e-3;

/// Foci that sound together, and places that stay silent.
struct Set {
  std::vector<array::SlotFocus> foci;
  std::vector<array::Null> nulls;
};

/// Places in a box about `centre`, apart from each other, without regard to their heights where `flat`.
std::vector<Set> random_sets(const Vec3& centre, const Vec3& half, bool flat) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1, 1);
  std::vector<Set> all(sets);
  for (Set& set : all) {
    std::vector<Vec3> places;
    while (places.size() < 2 * each) {
      const double x = place(random), y = place(random), z = place(random);
      const Vec3 next = centre + half * Vec3(x, y, z);
      const Vec3 across(1, 1, flat ? 0 : 1);
      if (std::ranges::all_of(places,
                              [&](const Vec3& other) { return glm::length((other - next) * across) >= apart_m; }))
        places.push_back(next);
    }
    for (std::size_t i = 0; i < each; ++i) {
      set.foci.push_back({places[i]});
      set.nulls.push_back({places[each + i]});
    }
  }
  return all;
}

struct Heard {
  double deepest_db = -std::numeric_limits<double>::infinity();  ///< of the set whose nulls are loudest
  double evenness = 1, loss_db = 0, mean_loss_db = 0;
};

Heard listen(const array::Layout& layout, const std::vector<Set>& all, const std::vector<array::Drive>& drives,
             const array::DriveOptions& without) {
  Heard heard;
  for (std::size_t s = 0; s < all.size(); ++s) {
    const acoustics::FociPressure pressure = acoustics::pressure_at_foci(layout, drives[s], all[s].foci);
    const acoustics::FociPressure before =
        acoustics::pressure_at_foci(layout, array::drive_for(layout, all[s].foci, without), all[s].foci);
    const double weakest = *std::ranges::min_element(pressure.pascals);
    for (const array::Null& null : all[s].nulls) {
      const double rest = std::abs(acoustics::pressure_at(layout, drives[s], null.position));
      heard.deepest_db = std::max(heard.deepest_db, 20 * std::log10(std::max(rest / weakest, 1e-15)));
    }
    const double loss_db = 20 * std::log10(*std::ranges::min_element(before.pascals) / weakest);
    heard.evenness = std::min(heard.evenness, pressure.evenness);
    heard.loss_db = std::max(heard.loss_db, loss_db);
    heard.mean_loss_db += loss_db / static_cast<double>(all.size());
  }
  return heard;
}

void measure(const Context& context, const array::Layout& layout, const std::vector<Set>& all, Constraint constraint,
             std::vector<Row>& rows) {
  const std::string name =
      fmt::format("{} 4 foci 4 nulls {} C++", layout.name, word_of(array::constraint_words, constraint));
  array::DriveOptions without;
  without.solver = array::Solver::gs_pat;
  without.constraint = constraint;
  std::vector<array::DriveOptions> options(all.size(), without);
  for (std::size_t s = 0; s < all.size(); ++s)
    options[s].nulls = std::make_shared<const array::Nulls>(layout, without.medium, without.directivity, all[s].nulls);
  const std::uint32_t cores = std::clamp(std::thread::hardware_concurrency(), 1u, sets);
  std::vector<array::Drive> drives(all.size(), array::Drive(layout.transducers.size()));
  std::vector<array::DriveScratch> scratch(cores);
  const auto batch = [&] {
    std::vector<std::jthread> threads;
    for (std::uint32_t core = 0; core < cores; ++core) {
      threads.emplace_back([&, core] {
        for (std::size_t s = core; s < all.size(); s += cores)
          array::drive_for(layout, all[s].foci, options[s], drives[s], scratch[core]);
      });
    }
  };
  batch();
  const Heard heard = listen(layout, all, drives, without);
  if (heard.deepest_db > (constraint == Constraint::uniform ? -40 : -80) || heard.evenness < 0.94 ||
      heard.loss_db > (constraint == Constraint::clamp ? 5 : 3)) {
    throw failure(fmt::format("bench: {}: nulls at {:.0f} dB, foci {:.3f}, {:.1f} dB lost; nothing was timed", name,
                              heard.deepest_db, heard.evenness, heard.loss_db));
  }
  std::vector<double> total;
  constexpr std::uint32_t runs = 5;
  for (std::uint32_t run = 0; run < runs; ++run) {
    const auto begin = std::chrono::steady_clock::now();
    batch();
    total.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    context.progress(name, run, runs - 1);
  }
  Row row = make_row("array", name, "total", total);
  row.value = static_cast<double>(all.size()) * 1e3 / row.median_ms;
  row.unit = "solves/s";
  row.note = fmt::format(
      "nulls at most {:.0f} dB of the weakest focus; weakest/strongest {:.3f}; {:.1f} dB less than gs-pat without "
      "nulls, "
      "at most {:.1f} ({} threads)",
      heard.deepest_db, heard.evenness, heard.mean_loss_db, heard.loss_db, cores);
  rows.push_back(row);
}

}  // namespace

void measure_nulls(const Context& context, std::vector<Row>& rows) {
  constexpr double half_m = 30e-3;
  for (const auto& [name, centre, half, flat] :
       {std::tuple("paper", Vec3(0), Vec3(half_m), false),
        std::tuple("openmpd", Vec3(0, 0, 0.15), Vec3(half_m, half_m, 20e-3), true)}) {
    const array::Layout layout = array::load_layout(name);
    const std::vector<Set> all = random_sets(centre, half, flat);
    for (const Constraint constraint : {Constraint::normalise, Constraint::uniform, Constraint::clamp})
      measure(context, layout, all, constraint, rows);
  }
}

}  // namespace palpa::bench
