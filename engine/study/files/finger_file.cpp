#include "study/files/finger_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "base/error.hpp"
#include "base/files/lines.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "study/files/gzip.hpp"
#include "study/files/sidecar.hpp"

namespace palpa::study {
namespace {

constexpr std::uint64_t most_packed = 64u << 20, most_unpacked = 256u << 20;
constexpr double between_samples_s = 0.1;

}  // namespace

FingerFile read_finger(const std::filesystem::path& path, std::span<const TrialTime> trials) {
  const std::string name = path.string();
  // The sidecar has the same name with .json in the place of .tsv.gz.
  std::filesystem::path beside = path;
  beside.replace_extension().replace_extension(".json");
  const FingerSidecar sidecar = read_finger_sidecar(beside);
  const Unpacked unpacked = read_gzip(path, most_packed, most_unpacked);
  FingerFile file{.courses = std::vector<DepthCourse>(trials.size())};
  if (unpacked.cut) {
    const auto rows = static_cast<double>(std::ranges::count(unpacked.text, '\n'));
    file.fault =
        fmt::format("{}: is cut off; depths are read up to {:.1f} s", name, sidecar.start_s + rows / sidecar.rate_hz);
  }
  Lines lines(unpacked.text);
  std::optional<std::string_view> line;
  const double step = std::max(1.0, std::floor(between_samples_s * sidecar.rate_hz));
  for (std::size_t t = 0; t < trials.size(); ++t) {
    const TrialTime& trial = trials[t];
    double length_s = std::min(trial.duration_s, DepthCourse::bin_s * DepthCourse::most_bins);
    if (t + 1 < trials.size()) length_s = std::min(length_s, trials[t + 1].onset_s - trial.onset_s);
    const double first = std::max(0.0, std::ceil((trial.onset_s - sidecar.start_s) * sidecar.rate_hz));
    for (double row = first;; row += step) {
      const double time_s = sidecar.start_s + row / sidecar.rate_hz - trial.onset_s;
      if (time_s >= length_s) break;
      const auto index = static_cast<std::uint64_t>(std::min(row, 1e15));
      while (lines.number() <= index) {
        line = lines.next();
        if (!line || lines.cut()) return file;
      }
      const std::vector<std::string> cells = plain_cells_of(*line, '\t', sidecar.columns);
      if (cells.size() != sidecar.columns) {
        throw bad_input(name, fmt::format("line {}: {} where {} {} named", index + 1, counted(cells.size(), "cell"),
                                          counted(sidecar.columns, "column"), sidecar.columns == 1 ? "is" : "are"));
      }
      const std::string& cell = cells[sidecar.depth_column];
      if (cell == not_available) continue;
      const std::optional<double> depth = parse_number(cell);
      constexpr double most_m = 10;
      if (!depth || std::abs(*depth) > most_m) {
        throw bad_input(name, fmt::format("line {}: '{}' is not a depth in metres, such as 0.0031", index + 1,
                                          printable(cell, 40)));
      }
      file.courses[t].add(time_s, *depth);
    }
  }
  return file;
}

}  // namespace palpa::study
