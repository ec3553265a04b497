#include "setup/options/warnings.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <glm/geometric.hpp>
#include <string>

#include "array/drive_options.hpp"
#include "array/layouts/board_types.hpp"
#include "array/plausible.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "geometry/plausible.hpp"
#include "line/values.hpp"
#include "session/plan/feel.hpp"
#include "touch/methods/method.hpp"

namespace palpa::setup {
namespace {

/// Below this distance, a place is on a transducer, and the direction of its sound is meaningless.
constexpr double on_transducer_m = 1e-6;

void warn_of_dwell(const std::string& where, double dwell_s) {
  if (dwell_s <= longest_usual_dwell_s) return;
  log::warning(fmt::format("{} of {} is long: a focus that stays in a place for more than {} is felt as jumps", where,
                           line::format_quantity(dwell_s, Quantity::time),
                           line::format_quantity(longest_usual_dwell_s, Quantity::time)));
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

void warn_of_feel(const session::Session& session) {
  const double slot_s = session.scheduler().slot_s();
  for (std::size_t s = 0; s < session.solids().size(); ++s) {
    const geometry::Solid& solid = session.solids()[s];
    const geometry::Haptics& haptics = solid.haptics;
    const bool vibrates = haptics.texture && (*haptics.texture)[1] + (*haptics.texture)[2] > 0;
    if (!haptics.clicks() && !vibrates) continue;
    const std::string where = fmt::format("{}: mesh \"{}\"", solid.file, printable(solid.name, 60));
    if (session.setting().schedule.steady) {
      log::warning(
          where +
          " has a click or a texture, but the link cannot change in every slot: palpa plays it as if it had neither");
      continue;
    }
    const double hz = haptics.clicks() ? haptics.click->hz : (*haptics.texture)[2] > 0 ? array::high_hz : array::low_hz;
    if (!session::carries({slot_s}, hz)) {
      log::warning(
          fmt::format("{} has vibrations of {:g} Hz, and drives of {:g} ms are too long for them: give a dwell "
                      "of at most {:.3g} ms; palpa does not play them",
                      where, hz, 1e3 * slot_s, 1e3 * session::longest_slot / hz));
      continue;
    }
    if (!haptics.clicks()) continue;
    const double gain = session::resting_gain(haptics, session.scheduler().solids()[s].voice.gain);
    if (gain <= session::most_resting_gain) continue;
    log::warning(
        fmt::format("{} has a gain of {:.2g} at its press depth, so {:g} ms of silence come before each click; "
                    "with an intensity that makes it at most {:g}, a click comes at once",
                    where, gain, 1e3 * session::silence_before_click_s, session::most_resting_gain));
  }
}

void warn_of_size(std::span<const geometry::Solid> solids) {
  for (const geometry::Solid& solid : solids) {
    if (const std::string odd = geometry::implausible_size(solid.bounds); !odd.empty())
      log::warning(fmt::format("{}: mesh \"{}\" {}", solid.file, printable(solid.name, 60), odd));
  }
}

void warn_of_frequency(const array::Layout& layout, const array::Medium& medium) {
  if (const std::string odd = array::implausible_frequency(layout, medium.frequency); !odd.empty())
    log::warning("--frequency: " + odd);
}

void check_frequency(const array::Layout& layout, const array::Medium& medium) {
  if (!layout.boards.empty() && medium.frequency != array::board_frequency_hz)
    throw bad_usage("--frequency: " + array::implausible_frequency(layout, medium.frequency));
  warn_of_frequency(layout, medium);
}

void refuse_coarse_modulation(double slot_s, double hz) {
  if (session::carries({slot_s}, hz)) return;
  throw bad_usage(
      fmt::format("--modulation-frequency: drives of {:g} ms are too long for a modulation of {:g} Hz: give a --dwell "
                  "of at most {:.3g}ms, or a modulation of at most {:.3g}Hz",
                  1e3 * slot_s, hz, 1e3 * session::longest_slot / hz, session::longest_slot / slot_s));
}

void refuse_coarse_modulation(const session::Session& session) {
  const session::ScheduleOptions& schedule = session.setting().schedule;
  if (schedule.own_method || !touch::stands_still(schedule.method.method)) return;
  refuse_coarse_modulation(session.scheduler().slot_s(), schedule.voice.modulation_hz);
}

void refuse_place(const array::Layout& layout, const Vec3& place, const std::string& what) {
  if (!array::drivable({.position = place}))
    throw bad_usage(fmt::format("{} is farther than 100 m from the array", what));
  for (std::size_t i = 0; i < layout.transducers.size(); ++i) {
    if (glm::distance(layout.transducers[i].position, place) < on_transducer_m)
      throw bad_usage(fmt::format("{} is where transducer {} stands; give a point in front of the array", what, i));
  }
}

void warn_of_reach(const array::Layout& layout, std::span<const geometry::Solid> solids) {
  for (const geometry::Solid& solid : solids) {
    if (const std::string odd = array::implausible_place(layout, solid.bounds); !odd.empty())
      log::warning(fmt::format("{}: mesh \"{}\" {}", solid.file, printable(solid.name, 60), odd));
  }
}

void warn_of_surroundings(const sensing::Surroundings& surroundings, std::span<const geometry::Solid> solids) {
  for (const geometry::Solid& solid : solids) {
    std::size_t boards = 0, screens = 0;
    for (const sensing::Slab& slab : surroundings.slabs) {
      if (sensing::reaches_into(solid.mesh, slab)) ++(slab.kind == sensing::NoSkin::board ? boards : screens);
    }
    if (boards + screens == 0) continue;
    const std::string what = boards == 0   ? "the screen"
                             : boards == 1 ? "a board of the array"
                                           : fmt::format("{} boards of the array", boards);
    log::warning(
        fmt::format("{}: mesh \"{}\" reaches into {}{}: palpa drops the points that cameras see there, from {:g} mm "
                    "before its face "
                    "to {:g} mm behind it, so nobody can touch that part{}",
                    solid.file, printable(solid.name, 60), what, boards > 0 && screens > 0 ? " and the screen" : "",
                    sensing::slab_before_m * 1e3, sensing::slab_behind_m * 1e3,
                    boards > 0 ? "; move the object or the array, or give --keep-boards" : ""));
    return;
  }
}

std::string linear_line() {
  return fmt::format(
      "above {} kPa, linear acoustics no longer holds: the real pressure is lower, and partly at multiples of the "
      "frequency\n",
      array::linear_pressure_pa / 1e3);
}

}  // namespace palpa::setup
