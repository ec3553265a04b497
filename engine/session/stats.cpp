#include "session/stats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpa::session {
namespace {

std::string distribution(const Samples& samples, double scale) {
  return fmt::format("{{\"count\":{},\"median\":{:.6g},\"p99\":{:.6g},\"p999\":{:.6g},\"max\":{:.6g}}}",
                     samples.count(), samples.quantile(0.5) * scale, samples.quantile(0.99) * scale,
                     samples.quantile(0.999) * scale, samples.quantile(1.0) * scale);
}

}  // namespace

double Samples::quantile(double p) const {
  if (values_.empty()) return 0;
  std::vector<float> sorted = values_;
  const auto at = static_cast<std::ptrdiff_t>(std::lround(p * static_cast<double>(sorted.size() - 1)));
  std::nth_element(sorted.begin(), sorted.begin() + at, sorted.end());
  return sorted[static_cast<std::size_t>(at)];
}

void LoopStats::add_passes(std::span<const gpu::PassTime> times) {
  for (const gpu::PassTime& time : times) {
    auto known =
        std::find_if(passes.begin(), passes.end(), [&](const PassStats& pass) { return pass.name == time.name; });
    if (known == passes.end()) known = passes.insert(passes.end(), PassStats{time.name, {}});
    known->ms.add(time.ms);
  }
}

std::string to_json(const LoopStats& stats) {
  std::string passes;
  for (const PassStats& pass : stats.passes) {
    passes += fmt::format("{}\"{}\":{}", passes.empty() ? "" : ",", pass.name, distribution(pass.ms, 1.0));
  }
  return fmt::format(
      "{{\"frames\":{{\"captured\":{},\"replaced\":{},\"missing\":{},\"unrecorded\":{},\"planned\":{},\"touching\":{}}}"
      ",\n"
      " \"seconds\":{:.6g},\n"
      " \"timing_ms\":{{\"frame_to_plan\":{},\"capture_to_drive\":{},\"drive_jitter\":{}}},\n"
      " \"passes_ms\":{{{}}},\n"
      " \"drives\":{{\"sent\":{},\"silent\":{},\"skipped_slots\":{}}}}}\n",
      stats.captured, stats.replaced, stats.missing, stats.unrecorded, stats.planned, stats.touching, stats.seconds,
      distribution(stats.frame_to_plan_s, 1e3), distribution(stats.output.capture_to_drive_s, 1e3),
      distribution(stats.output.jitter_s, 1e3), passes, stats.output.drives, stats.output.silent_drives,
      stats.output.skipped_slots);
}

}  // namespace palpa::session
