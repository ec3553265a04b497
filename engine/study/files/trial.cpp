#include "study/files/trial.hpp"

namespace palpa::study {

void DepthCourse::add(double time_s, double depth_m) {
  if (time_s < 0 || time_s >= bin_s * most_bins) return;
  const auto bin = static_cast<std::size_t>(time_s / bin_s);
  if (bin >= samples.size()) {
    sum_m.resize(bin + 1, 0);
    samples.resize(bin + 1, 0);
  }
  sum_m[bin] += depth_m;
  ++samples[bin];
}

}  // namespace palpa::study
