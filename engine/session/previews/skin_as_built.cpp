#include "session/previews/skin_as_built.hpp"

#include <algorithm>
#include <cassert>
#include <complex>
#include <cstddef>
#include <vector>

#include "acoustics/field/incident.hpp"

namespace palpa::session {
namespace {

/// Number of sounds solved together; their incident waves are all in memory at the same time.
constexpr std::size_t together = 16;

/// Adds `part` of the pressure to the sum.
void add(const acoustics::SkinPressure& pressure, double part, acoustics::SkinPressure& sum) {
  const auto add_faces = [&](const std::vector<double>& from, std::vector<double>& to) {
    to.resize(from.size());
    for (std::size_t face = 0; face < from.size(); ++face)
      to[face] += part * from[face];
  };
  const auto add_load = [&](const acoustics::Load& from, acoustics::Load& to) {
    to.force += part * from.force;
    to.torque += part * from.torque;
  };
  add_faces(pressure.langevin, sum.langevin);
  add_faces(pressure.squared, sum.squared);
  add_load(pressure.langevin_load, sum.langevin_load);
  add_load(pressure.squared_load, sum.squared_load);
  sum.loudest_pa += part * pressure.loudest_pa;
  sum.langevin_push_n += part * pressure.langevin_push_n;
}

}  // namespace

acoustics::SkinPressure pressure_as_built(const Sounds& sounds, const array::AsBuilt& built, double celsius,
                                          const acoustics::Air& air, array::Directivity directivity,
                                          std::span<const WarmBody> bodies) {
  assert(bodies.size() == 1 || bodies.size() == 2);
  const acoustics::Strengths factors = acoustics::strengths_of(built.drive);
  acoustics::Strengths strengths = sounds.strengths;
  for (std::size_t i = 0; i < strengths.size(); ++i)
    strengths[i] *= factors[i % factors.size()];

  const acoustics::Incident incident(built.layout, air, directivity);
  const acoustics::RigidBody& any = *bodies[0].body;
  const std::size_t vertices = any.mesh().positions.size();
  std::vector<acoustics::SkinPressure> found(bodies.size());
  acoustics::Waves waves;
  for (std::size_t first = 0; first < sounds.weights.size(); first += together) {
    const std::size_t count = std::min(together, sounds.weights.size() - first);
    incident.at(any.points(), any.normals(),
                std::span(strengths).subspan(first * factors.size(), count * factors.size()), waves);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const std::vector<std::complex<float>> unknowns = bodies[b].body->solve(waves);
      for (std::size_t i = 0; i < count; ++i) {
        acoustics::add_pressure(*bodies[b].body, std::span(unknowns).subspan(i * vertices, vertices), bodies[b].air,
                                sounds.weights[first + i], found[b]);
      }
    }
  }
  if (bodies.size() == 1) return found[0];
  const double above = (celsius - bodies[0].celsius) / (bodies[1].celsius - bodies[0].celsius);
  acoustics::SkinPressure pressure;
  add(found[0], 1 - above, pressure);
  add(found[1], above, pressure);
  return pressure;
}

}  // namespace palpa::session
