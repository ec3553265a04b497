// The field's part of the acoustics suite: a plane of 512 x 512 points before the paper's array.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>

#include "acoustics/field/field_pass.hpp"
#include "acoustics/field/focus_shape.hpp"
#include "acoustics/field/incident.hpp"
#include "acoustics/field/pressure.hpp"
#include "array/drive.hpp"
#include "array/layouts/layout.hpp"
#include "base/system/now.hpp"
#include "bench/bench.hpp"

namespace palpa::bench {
namespace {

using array::Directivity;
using Complex = std::complex<double>;

constexpr std::uint32_t side = 512;
constexpr double side_m = 0.06;
constexpr std::size_t judged_every = 1009;  // step between checked points: a prime, so that all columns are covered
constexpr double most_error = 1e-4;

struct Case {
  const char* name;
  Directivity directivity;
  bool absorbing;
};
constexpr Case cases[]{{"field, omni", Directivity::omni, false},
                       {"field, pistons in air", Directivity::piston, true},
                       {"field, t4010a1 in air", Directivity::t4010a1, true}};

std::vector<Vec3> plane() {
  std::vector<Vec3> points;
  for (std::uint32_t j = 0; j < side; ++j) {
    for (std::uint32_t i = 0; i < side; ++i)
      points.emplace_back(side_m * ((i + 0.5) / side - 0.5), side_m * (0.5 - (j + 0.5) / side), 0);
  }
  return points;
}

/// Relative L2 against the definition in doubles.
double error_of(std::span<const Complex> pressures, std::span<const Vec3> points, const array::Layout& layout,
                const array::Drive& drive, const acoustics::Air& air, Directivity directivity) {
  double wrong = 0, all = 0;
  for (std::size_t i = 0; i < points.size(); i += judged_every) {
    const Complex expected =
        acoustics::pressure_at(layout, drive, points[i], air.medium, directivity, air.absorption_np_m);
    wrong += std::norm(pressures[i] - expected);
    all += std::norm(expected);
  }
  return std::sqrt(wrong / all);
}

void check_within(const char* what, double value, double least, double most) {
  if (value >= least && value <= most) return;
  wrong(fmt::format("{} is {:.4g}, not {:.4g} to {:.4g}", what, value, least, most));
}

/// The width of foci and the force of one, compared with published values of such arrays
/// (docs/notes/field-numbers.md).
void measure_foci(std::vector<Row>& rows) {
  const double begin_ms = now_ms();
  const auto row = [&](const char* name, std::string note) {
    rows.push_back(make_row("acoustics", name, "focus", {now_ms() - begin_ms}));
    rows.back().note = std::move(note);
  };
  const acoustics::Air air = acoustics::air_of({});
  {
    const array::Layout layout = array::load_layout("paper");
    const array::SlotFocus focus[]{{Vec3(0), 1}};
    const acoustics::Strengths strengths = acoustics::strengths_of(array::drive_for(layout, focus));
    const acoustics::Incident incident(layout, air, Directivity::t4010a1);
    const double across = 1e3 * acoustics::focus_width(incident, strengths, Vec3(0), {1, 0, 0});
    const double along = 1e3 * acoustics::focus_width(incident, strengths, Vec3(0), {0, 0, 1});
    check_within("the width in mm of the paper's focus", across, 4.3, 4.8);
    check_within("the length in mm of the paper's focus", along, 8, 9.5);
    row("paper, focus at its centre",
        fmt::format("|p| above half: {:.2f} mm across, {:.2f} mm along z", across, along));
  }
  array::Layout board = acoustics::square_board(18, 10.16e-3);
  board.source_level_pa_m = 3.4;
  const Vec3 above(0, 0, 0.2);
  const array::SlotFocus focus[]{{above, 1}};
  array::DriveOptions full;
  full.constraint = array::Constraint::uniform;
  const acoustics::Strengths strengths = acoustics::strengths_of(array::drive_for(board, focus, full));
  const acoustics::Incident incident(board, air, Directivity::piston);
  const double width = 1e3 * acoustics::focus_width(incident, strengths, above, {1, 0, 0});
  const double force = 1e3 * acoustics::disc_force(incident, strengths, air, above, 10e-3);
  check_within("the width in mm of a flat board's focus", width, 12.3, 13.2);
  check_within("the force in mN on a disc of 20 mm", force, 0.7 * 16, 1.3 * 16);
  row("18 x 18, focus at 0.2 m",
      fmt::format("|p| above half: {:.1f} mm; {:.1f} mN on 20 mm, measured 16", width, force));
}

}  // namespace

void measure_field(const Context& context, std::vector<Row>& rows) {
  measure_foci(rows);
  const array::Layout layout = array::load_layout("paper");
  const array::SlotFocus focus[]{{Vec3(0), 1}};
  const array::Drive drive = array::drive_for(layout, focus);
  const acoustics::Strengths strengths = acoustics::strengths_of(drive);
  const std::vector<Vec3> points = plane();
  const std::uint32_t runs = std::clamp(context.runs / 50, 3u, 20u);
  for (const Case& which : cases) {
    const acoustics::Air usual = acoustics::air_of({});
    const acoustics::Air air = which.absorbing ? usual : acoustics::without_absorption(usual);
    std::vector<Complex> pressures;
    const auto measure = [&](const char* stage, const auto& sum) {
      sum();
      const double error = error_of(pressures, points, layout, drive, air, which.directivity);
      if (!(error <= most_error))
        wrong(fmt::format("{}, {}: off by {:.1e} of the sum in doubles", which.name, stage, error));
      std::vector<double> samples;
      for (std::uint32_t run = 0; run < runs; ++run) {
        const double begin_ms = now_ms();
        sum();
        samples.push_back(now_ms() - begin_ms);
        context.progress(fmt::format("{}, {}", which.name, stage), run + 1, runs);
      }
      Row row = make_row("acoustics", which.name, stage, samples);
      row.value = static_cast<double>(points.size() * layout.transducers.size()) / row.median_ms / 1e3;
      row.unit = "million pairs/s";
      row.note =
          fmt::format("{} x {} points x {} transducers; error {:.1e}", side, side, layout.transducers.size(), error);
      rows.push_back(row);
    };
    measure("device",
            [&] { acoustics::field_on(context.device, layout, air, which.directivity, points, strengths, pressures); });
    measure("host", [&] {
      acoustics::Waves waves;
      acoustics::Incident(layout, air, which.directivity).at(points, {}, strengths, waves);
      pressures.swap(waves.pressures);
    });
  }
}

}  // namespace palpa::bench
