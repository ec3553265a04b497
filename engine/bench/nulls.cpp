// Foci and nulls at once: four of each, at random places that the array resolves; nulls are places, or balls. Measures
// solves per second, how deep the nulls are, and what they cost. There is no row of a device: the host computes slots
// with nulls on every device (docs/notes/nulls.md).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "acoustics/field/pressure.hpp"
#include "array/drive.hpp"
#include "array/layouts/layout.hpp"
#include "array/nulls/nulls.hpp"
#include "base/system/parallel.hpp"
#include "bench/bench.hpp"

namespace palpa::bench {
namespace {

using array::Constraint;

constexpr std::size_t each = 4;  // foci, and nulls
constexpr double apart_m = 10e-3;

/// Places in a box about `centre`, apart from each other, without regard to their heights where `flat`.
struct Case {
  const char* layout;
  Vec3 centre, half;
  bool flat;
  double radius_m;  ///< of the nulls
  std::uint32_t sets;
};

/// Foci that sound together, and places that stay silent.
struct Set {
  std::vector<array::SlotFocus> foci;
  std::vector<array::Null> nulls;
};

std::vector<Set> random_sets(const Case& which) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1, 1);
  std::vector<Set> all(which.sets);
  for (Set& set : all) {
    std::vector<Vec3> places;
    while (places.size() < 2 * each) {
      const double x = place(random), y = place(random), z = place(random);
      const Vec3 next = which.centre + which.half * Vec3(x, y, z);
      const Vec3 across(1, 1, which.flat ? 0 : 1);
      if (std::ranges::all_of(places,
                              [&](const Vec3& other) { return glm::length((other - next) * across) >= apart_m; }))
        places.push_back(next);
    }
    for (std::size_t i = 0; i < each; ++i) {
      set.foci.push_back({places[i]});
      set.nulls.push_back({places[each + i], which.radius_m});
    }
  }
  return all;
}

/// Where a null is listened to: its centre, and places on its surface.
std::vector<Vec3> places_of(const array::Null& null) {
  std::vector<Vec3> places{null.position};
  constexpr int count = 40;
  for (int i = 0; i < count && null.radius_m > 0; ++i) {
    const double z = 1 - (2.0 * i + 1) / count, across = std::sqrt(1 - z * z);
    const double angle = std::numbers::pi * (1 + std::sqrt(5.0)) * i;
    places.push_back(null.position + null.radius_m * Vec3(across * std::cos(angle), across * std::sin(angle), z));
  }
  return places;
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
      for (const Vec3& place : places_of(null)) {
        const double rest = std::abs(acoustics::pressure_at(layout, drives[s], place));
        heard.deepest_db = std::max(heard.deepest_db, 20 * std::log10(std::max(rest / weakest, 1e-15)));
      }
    }
    const double loss_db = 20 * std::log10(*std::ranges::min_element(before.pascals) / weakest);
    heard.evenness = std::min(heard.evenness, pressure.evenness);
    heard.loss_db = std::max(heard.loss_db, loss_db);
    heard.mean_loss_db += loss_db / static_cast<double>(all.size());
  }
  return heard;
}

void measure(const Context& context, const Case& which, const array::Layout& layout, const std::vector<Set>& all,
             Constraint constraint, std::vector<Row>& rows) {
  const std::string nulls =
      which.radius_m > 0 ? fmt::format("4 nulls of {:.1f} mm", which.radius_m * 1e3) : std::string("4 nulls");
  const std::string name =
      fmt::format("{} 4 foci {} {} C++", layout.name, nulls, word_of(array::constraint_words, constraint));
  array::DriveOptions without;
  without.solver = array::Solver::gs_pat;
  without.constraint = constraint;
  std::vector<array::DriveOptions> options(all.size(), without);
  parallel_chunks(all.size(), 1, [&](std::size_t s, std::size_t, std::size_t) {
    options[s].nulls = std::make_shared<const array::Nulls>(layout, without.medium, without.directivity, all[s].nulls);
  });
  const std::uint32_t cores = std::clamp(worker_count(), 1u, which.sets);
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
  const bool full = constraint != Constraint::normalise;  // clamp gives the drive of uniform
  const double most_db = full ? -40 : which.radius_m > 0 ? -75 : -80;
  if (heard.deepest_db > most_db || heard.evenness < 0.94 || heard.loss_db > 3) {
    wrong(fmt::format("{}: nulls at {:.0f} dB, foci {:.3f}, {:.1f} dB lost", name, heard.deepest_db, heard.evenness,
                      heard.loss_db));
  }
  constexpr std::uint32_t most_runs = 20;
  Row row = make_row("array", name, "total", time_runs(context, name, most_runs, batch));
  row.value = static_cast<double>(all.size()) * 1e3 / row.median_ms;
  row.unit = "solves/s";
  row.note = fmt::format(
      "nulls at most {:.0f} dB of the weakest focus; weakest/strongest {:.3f}; {:.1f} dB less than gs-pat without "
      "nulls, at most {:.1f} ({} threads)",
      heard.deepest_db, heard.evenness, heard.mean_loss_db, heard.loss_db, cores);
  rows.push_back(row);
}

}  // namespace

void measure_nulls(const Context& context, std::vector<Row>& rows, std::uint32_t most_sets) {
  constexpr double half_m = 30e-3, ball_m = 0.5e-3;
  Case cases[]{{"paper", Vec3(0), Vec3(half_m), false, 0, 48},
               {"openmpd", {0, 0, 0.15}, {half_m, half_m, 20e-3}, true, 0, 48},
               {"paper", Vec3(0), Vec3(half_m), false, ball_m, 6}};
  for (Case& which : cases) {
    which.sets = std::min(which.sets, most_sets);
    const array::Layout layout = array::load_layout(which.layout);
    const std::vector<Set> all = random_sets(which);
    for (const Constraint constraint : {Constraint::normalise, Constraint::uniform, Constraint::clamp})
      measure(context, which, layout, all, constraint, rows);
  }
}

}  // namespace palpa::bench
