// The paper's Fig. 6: the finger in each of its objects, as pictures and as a table.
#include "setup/tasks/figure6.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/words.hpp"
#include "cli/simulate.hpp"
#include "drawing/arrange.hpp"
#include "setup/options/warnings.hpp"
#include "setup/process/progress.hpp"
#include "setup/tasks/simulate_picture.hpp"

namespace palpa::cli {
namespace {

std::string table_of_figure(const std::vector<setup::Figure6Touch>& touches) {
  std::string text = fmt::format("{:<14} {:<14} {:>9} {:>8} {:>8} {:>8} {:>9} {:>9} {:>8}\n", "object", "method",
                                 "peak Pa", "half mm2", "radius", "elongat.", "of bare", "of |p|^2", "force mN");
  for (const auto& [object, result] : touches) {
    const acoustics::Spot& spot = result.langevin;
    fmt::format_to(std::back_inserter(text),
                   "{:<14} {:<14} {:>9.0f} {:>8.1f} {:>8.2f} {:>8.2f} {:>9.2f} {:>9.2f} {:>8.1f}\n", object,
                   word_of(touch::method_words, result.method), spot.peak_pa, spot.half_area_m2 * 1e6,
                   spot.half_radius_m * 1e3, spot.elongation, spot.elongation / result.bare_elongation.value_or(1),
                   result.squared.elongation, glm::length(result.load.force) * 1e3);
  }
  return text;
}

/// For the paper's method: the foci, and below them the pressures. The objects' tops are at y = 0.
drawing::Pixels pictures(const std::vector<setup::Figure6Touch>& touches) {
  std::vector<drawing::Pixels> foci, pressures;
  for (const auto& [object, result] : touches) {
    if (result.method != touch::Method::cross_section) continue;
    foci.push_back(drawing::halved(foci_picture(result, 0, object)));
    pressures.push_back(drawing::halved(pressure_picture(result, object)));
  }
  const auto columns = static_cast<std::uint32_t>(foci.size());
  foci.insert(foci.end(), pressures.begin(), pressures.end());
  return drawing::side_by_side(foci, columns);
}

}  // namespace

void run_figure6(const SimulateCommand& o) {
  const Outputs outputs({{"--json", o.common.json}, {"--png", o.png}});
  std::optional<setup::Preparing> progress(std::in_place, o.common.quiet);
  setup::FingerBody finger = load_finger(o);
  const std::vector<setup::Figure6Touch> touches = setup::figure6(o.task, finger);
  progress.reset();
  const auto quiet =
      std::ranges::find_if(touches, [](const auto& touch) { return touch.result.unreached.has_value(); });
  if (quiet != touches.end()) log::warning(*quiet->result.unreached);
  if (!o.png.empty()) drawing::write_png(o.png, pictures(touches));
  if (!o.common.json.empty()) write_file(o.common.json, setup::to_json(touches));
  if (!setup::shows_summary(o.common, outputs)) return;
  const bool loud = std::ranges::any_of(touches, [](const auto& touch) { return touch.result.beyond_linear(); });
  write_file("-", table_of_figure(touches) + (loud ? setup::linear_line() : ""));
}

}  // namespace palpa::cli
