#include "array/drive_options.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "base/files/json_rows.hpp"

namespace palpa::array {

bool drivable(const SlotFocus& focus) {
  const Vec3& p = focus.position;
  // Written so that NaN fails the test.
  return std::abs(p.x) <= 100 && std::abs(p.y) <= 100 && std::abs(p.z) <= 100;
}

float gain_of(const SlotFocus& focus) {
  return focus.gain > 0 ? std::min(1.0f, focus.gain) : 0.0f;
}

DrivenBy driven_by(const DriveOptions& options, std::size_t transducers, bool requests) {
  DrivenBy by{.weighting = options.weighting, .solver = options.solver};
  if (!requests) by.constraint = options.constraint;
  if (options.most_work != std::numeric_limits<std::size_t>::max())
    by.solved_foci = options.most_work / std::max<std::size_t>(transducers, 1);
  return by;
}

const JsonRows<DrivenBy>& driven_rows() {
  static const auto rows =
      JsonRows<DrivenBy>()
          .value("amplitude", [](const DrivenBy& by) { return word_of(weighting_words, by.weighting); })
          .value("solver",
                 [](const DrivenBy& by) {
                   return by.solver ? std::optional(word_of(solver_words, *by.solver)) : std::nullopt;
                 })
          .value("solved_foci",
                 [](const DrivenBy& by) {
                   return by.solved_foci ? std::optional(std::uint64_t{*by.solved_foci}) : std::nullopt;
                 })
          .value("constraint", [](const DrivenBy& by) {
            return by.constraint ? std::optional(word_of(constraint_words, *by.constraint)) : std::nullopt;
          });
  return rows;
}

}  // namespace palpa::array
