#include "bench/growth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "session/session.hpp"

namespace palpa::bench {
namespace {

/// The sum of each step's times over many frames.
using StepTimes = std::vector<std::pair<std::string, double>>;

void add(StepTimes& steps, const std::string& name, double ms) {
  const auto same = [&](const auto& step) { return step.first == name; };
  const auto found = std::find_if(steps.begin(), steps.end(), same);
  if (found == steps.end()) {
    steps.emplace_back(name, ms);
  } else {
    found->second += ms;
  }
}

/// The two steps that take the most of `total_ms`.
std::string most_costly(StepTimes steps, double total_ms) {
  double rest = total_ms;
  for (const auto& [name, ms] : steps)
    rest -= ms;
  steps.emplace_back("rest", rest);
  std::stable_sort(steps.begin(), steps.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  return fmt::format("{} {:.0f} %, {} {:.0f} %", steps[0].first, 100 * steps[0].second / total_ms, steps[1].first,
                     100 * steps[1].second / total_ms);
}

const touch::Touch& touch_once(session::Session& session, const GrowthCase& frame, std::uint64_t number) {
  const double time_s = static_cast<double>(number) / 90;
  return frame.setting.cameras.empty() ? session.touch(frame.frame.points, time_s, 7 * number)
                                       : session.touch(frame.frame.frames, time_s, 7 * number);
}

void expect_same(const touch::Touch& found, const touch::Touch& expected, const std::string& name) {
  if (expected.finger_count == 0) wrong(name + ": nothing touches");
  if (found.finger_count != expected.finger_count || found.contacts.size() != expected.contacts.size())
    twins_disagree(name);
}

GrowthSample time_frames(const Context& context, const std::string& name, std::uint32_t size, const char* where,
                         const GrowthCase& frame, session::Session& session, std::vector<Row>& rows) {
  std::uint64_t number = 1;  // frame 0 was for the comparison
  StepTimes steps;
  double total_ms = 0;
  const std::vector<double> samples = time_runs(context, fmt::format("{} {}", size, name), context.runs, [&] {
    touch_once(session, frame, number++);
    for (const gpu::PassTime& pass : session.report().passes)
      add(steps, pass.name, pass.ms);
  });
  for (const double ms : samples)
    total_ms += ms;
  Row row = make_row("growth", name, where, samples);
  row.value = size;
  row.unit = name;
  row.note = most_costly(std::move(steps), total_ms);
  rows.push_back(row);
  return {static_cast<double>(size), row.median_ms};
}

void measure_axis(const Context& context, const GrowthAxis& axis, std::uint32_t most_size, std::vector<Row>& rows,
                  std::vector<GrowthCurve>& curves) {
  GrowthCurve of_host{axis.name, "host", {}}, of_device{axis.name, "device", {}};
  for (const std::uint32_t size : axis.sizes) {
    if (size > most_size) continue;
    const GrowthCase frame = axis.make(size);
    session::Session host(frame.setting), device(context.device, frame.setting);
    expect_same(touch_once(device, frame, 0), touch_once(host, frame, 0), fmt::format("{} {}", size, axis.name));
    of_host.samples.push_back(time_frames(context, axis.name, size, "host", frame, host, rows));
    of_device.samples.push_back(time_frames(context, axis.name, size, "device", frame, device, rows));
  }
  if (of_host.samples.empty()) return;
  for (GrowthCurve* curve : {&of_host, &of_device}) {
    const Exponents exponents = exponents_of(curve->samples);
    const auto last = std::find_if(rows.rbegin(), rows.rend(), [&](const Row& row) {
      return row.name == curve->name && row.stage == curve->where;
    });
    if (last != rows.rend())
      last->note += fmt::format("; exponent {:.2f}, at most {:.2f}", exponents.fitted, exponents.steepest);
    curves.push_back(std::move(*curve));
  }
}

}  // namespace

Exponents exponents_of(std::span<const GrowthSample> samples) {
  if (samples.size() < 2) return {};
  const auto count = static_cast<double>(samples.size());
  double x = 0, y = 0, xx = 0, xy = 0, steepest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double lx = std::log(samples[i].size), ly = std::log(samples[i].ms);
    x += lx;
    y += ly;
    xx += lx * lx;
    xy += lx * ly;
    if (i > 0) {
      const double before = std::log(samples[i - 1].size);
      steepest = std::max(steepest, (ly - std::log(samples[i - 1].ms)) / (lx - before));
    }
  }
  return {(count * xy - x * y) / (count * xx - x * x), steepest};
}

std::vector<GrowthCurve> measure_growth(const Context& context, std::uint32_t most_size, std::vector<Row>& rows) {
  std::vector<GrowthCurve> curves;
  for (const GrowthAxis& axis : growth_axes())
    measure_axis(context, axis, most_size, rows, curves);
  return curves;
}

}  // namespace palpa::bench
