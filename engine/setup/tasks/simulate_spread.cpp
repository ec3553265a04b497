#include "setup/tasks/simulate_spread.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "acoustics/bodies/radiation.hpp"
#include "base/activity.hpp"
#include "session/previews/skin_as_built.hpp"

namespace palpa::setup {
namespace {

/// Temperatures at which equations are solved, in standard deviations from the nominal one. Nearly all draws are
/// between the first and the last.
constexpr double nodes[] = {-2.5, -1.25, 0, 1.25, 2.5};

/// All numbers of one draw, in the order in which they are filled and read back.
constexpr std::size_t spot_numbers = 7, all_numbers = 2 * spot_numbers + 6;
using Numbers = std::array<double, all_numbers>;

void put(const acoustics::Spot& spot, std::span<double> to) {
  const double numbers[spot_numbers] = {spot.peak_pa,      spot.peak_at.x,     spot.peak_at.y, spot.peak_at.z,
                                        spot.half_area_m2, spot.half_radius_m, spot.elongation};
  std::ranges::copy(numbers, to.begin());
}

Numbers numbers_of(const geometry::Mesh& mesh, const acoustics::SkinPressure& pressure, const Vec3& tip) {
  Numbers numbers{};
  put(acoustics::spot_of(mesh, pressure.langevin), numbers);
  put(acoustics::spot_of(mesh, pressure.squared), std::span(numbers).subspan(spot_numbers));
  const acoustics::Load load = acoustics::about(tip, pressure.langevin_load);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<glm::length_t>(axis);
    numbers[2 * spot_numbers + axis] = load.force[i];
    numbers[2 * spot_numbers + 3 + axis] = load.torque[i];
  }
  return numbers;
}

SpotSpread spot_of(std::span<const Percentiles> numbers) {
  return {.peak_pa = numbers[0],
          .peak_m = {numbers[1], numbers[2], numbers[3]},
          .half_area_m2 = numbers[4],
          .half_radius_m = numbers[5],
          .elongation = numbers[6]};
}

/// The bodies for the draws, whose temperatures must ascend.
class WarmBodies {
 public:
  WarmBodies(const DesignedTouch& touch, double deviation) : touch_(touch) {
    for (const double node : nodes) {
      const MediumOptions medium = warmer(touch.medium, node * deviation);
      // The ends of the range of temperatures may coincide with other nodes.
      const double celsius = celsius_of(medium);
      if (bodies_.empty() || celsius > bodies_.back().celsius)
        bodies_.push_back({.celsius = celsius, .air = air(medium, touch.air), .body = nullptr});
    }
  }

  static double celsius_of(const MediumOptions& medium) { return medium.celsius.value_or(20); }

  /// One body, or the two around this temperature.
  std::span<const session::WarmBody> around(double celsius) {
    if (bodies_.size() == 1) {
      make(bodies_[0]);
      return bodies_;
    }
    std::size_t below = 0;
    while (below + 2 < bodies_.size() && bodies_[below + 1].celsius <= celsius)
      bodies_[below++].body.reset();
    make(bodies_[below]);
    make(bodies_[below + 1]);
    return std::span(bodies_).subspan(below, 2);
  }

 private:
  void make(session::WarmBody& warm) const {
    if (warm.body) return;
    const double wave_number = warm.air.wave_number();
    warm.body = wave_number == touch_.body->wave_number()
                    ? touch_.body
                    : std::make_shared<const acoustics::RigidBody>(touch_.body->mesh(), wave_number);
  }

  const DesignedTouch& touch_;
  std::vector<session::WarmBody> bodies_;
};

JsonRows<SpotSpread> spot_rows() {
  return JsonRows<SpotSpread>()
      .value("peak_pa", [](const SpotSpread& s) { return numbers_of(s.peak_pa); })
      .value("peak_m", [](const SpotSpread& s) { return lists_of(s.peak_m); })
      .value("half_area_m2", [](const SpotSpread& s) { return numbers_of(s.half_area_m2); })
      .value("half_radius_m", [](const SpotSpread& s) { return numbers_of(s.half_radius_m); })
      .value("elongation", [](const SpotSpread& s) { return numbers_of(s.elongation); });
}

}  // namespace

const JsonRows<SimulateSpread>& simulate_spread_rows() {
  using Result = SimulateSpread;
  static const auto rows = spread_rows<Result>()
                               .object("langevin", spot_rows(), [](const Result& s) { return &s.langevin; })
                               .object("squared", spot_rows(), [](const Result& s) { return &s.squared; })
                               .value("force_N", [](const Result& s) { return lists_of(s.force); })
                               .value("torque_Nm", [](const Result& s) { return lists_of(s.torque); });
  return rows;
}

SimulateSpread spread_of_pressure(const DesignedTouch& touch, const array::Spread& spread, const Draws& draws) {
  const array::Drive unit(touch.layout.transducers.size(), {.amplitude = 1, .phase = 0});
  const auto draw_of = [&](std::uint32_t draw) {
    return array::as_built(touch.layout, unit, spread, draws.seed, draw);
  };
  std::vector<MediumOptions> mediums;
  for (std::uint32_t draw = 0; draw < draws.count; ++draw)
    mediums.push_back(warmer(touch.medium, draw_of(draw).temperature));
  std::vector<std::uint32_t> by_temperature(draws.count);
  std::iota(by_temperature.begin(), by_temperature.end(), 0u);
  std::ranges::stable_sort(by_temperature, {},
                           [&](std::uint32_t draw) { return WarmBodies::celsius_of(mediums[draw]); });

  WarmBodies bodies(touch, spread.temperature);
  std::array<std::vector<double>, all_numbers> lists;
  Activity activity("computing random arrays", draws.count);
  for (const std::uint32_t draw : by_temperature) {
    const double celsius = WarmBodies::celsius_of(mediums[draw]);
    const acoustics::SkinPressure pressure = session::pressure_as_built(
        touch.sounds, draw_of(draw), celsius, air(mediums[draw], touch.air), touch.directivity, bodies.around(celsius));
    const Numbers numbers = numbers_of(touch.body->mesh(), pressure, touch.tip);
    for (std::size_t i = 0; i < all_numbers; ++i)
      lists[i].push_back(numbers[i]);
    activity.advance();
  }
  std::array<Percentiles, all_numbers> found;
  std::ranges::transform(lists, found.begin(), [](std::vector<double>& list) { return percentiles(std::move(list)); });
  const auto part = [&](std::size_t first) { return std::span(found).subspan(first); };
  constexpr std::size_t force = 2 * spot_numbers, torque = force + 3;
  return {.draws = draws,
          .langevin = spot_of(part(0)),
          .squared = spot_of(part(spot_numbers)),
          .force = {found[force], found[force + 1], found[force + 2]},
          .torque = {found[torque], found[torque + 1], found[torque + 2]}};
}

}  // namespace palpa::setup
