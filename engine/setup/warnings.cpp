#include "setup/warnings.hpp"

#include <fmt/core.h>

#include <string>

#include "array/usual.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "setup/values.hpp"

namespace palpa::setup {
namespace {

void warn_of_dwell(const std::string& where, double dwell_s) {
  if (dwell_s <= longest_usual_dwell_s) return;
  log::warning(fmt::format("{} of {} is long: a focus that stays in a place for more than {} is felt as jumps", where,
                           format_quantity(dwell_s, Quantity::time),
                           format_quantity(longest_usual_dwell_s, Quantity::time)));
}

}  // namespace

void warn_of_dwell(const TouchOptions& options) {
  warn_of_dwell("--dwell", options.dwell_s);
}

void warn_of_dwell(std::span<const geometry::Solid> solids) {
  for (const geometry::Solid& solid : solids) {
    if (solid.haptics.dwell_s)
      warn_of_dwell(fmt::format("{}: mesh \"{}\": a dwell", solid.file, printable(solid.name, 60)),
                    *solid.haptics.dwell_s);
  }
}

void warn_of_frequency(const array::Layout& layout, const array::Medium& medium) {
  if (const std::string odd = array::unusual_frequency(layout, medium.frequency); !odd.empty())
    log::warning("--frequency: " + odd);
}

void warn_of_reach(const array::Layout& layout, std::span<const geometry::Solid> solids) {
  for (const geometry::Solid& solid : solids) {
    if (const std::string odd = array::unusual_place(layout, solid.bounds); !odd.empty())
      log::warning(fmt::format("{}: mesh \"{}\" {}", solid.file, printable(solid.name, 60), odd));
  }
}

std::string linear_line() {
  return fmt::format(
      "above {} kPa, linear acoustics no longer holds: the real pressure is lower, and partly at multiples of the "
      "frequency\n",
      array::linear_pressure_pa / 1e3);
}

}  // namespace palpa::setup
