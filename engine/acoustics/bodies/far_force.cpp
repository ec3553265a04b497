#include "acoustics/bodies/far_force.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "acoustics/elements/triangle_rules.hpp"
#include "base/system/parallel.hpp"

namespace palpa::acoustics {

using Complex = std::complex<double>;

namespace {

/// Sources this near to the sphere, in its radii, leave too much of their sound above any order.
constexpr double nearest_source = 1.05;
/// Points on the sphere that are worth the effort for any body, and per point of the body.
constexpr double few_points = 5000, points_per_point = 0.5;
/// ln of the part of a source's sound that may show up in wrong coefficients.
constexpr double negligible = 7;

/// The scattered wave falls faster than exponentially above this order.
std::size_t order_of(double ka) {
  return static_cast<std::size_t>(std::ceil(ka + 3 * std::cbrt(ka) + 2));
}

/// Enough for the orders of sources at this distance, in radii: these fall by that factor from order to order.
std::size_t rings_for(std::size_t order, double sources) {
  const double orders = std::isfinite(sources) ? negligible / std::log(sources) : 0;
  return std::max(order + 1, static_cast<std::size_t>((static_cast<double>(order) + 1 + orders) / 2) + 1);
}

}  // namespace

std::optional<FarForce> FarForce::of(const RigidBody& body, std::span<const Vec3> sources) {
  const Vec3 centre = geometry::bounds(body.mesh()).centre();
  double radius = 0, nearest = std::numeric_limits<double>::infinity();
  for (const Vec3& p : body.mesh().positions)
    radius = std::max(radius, glm::distance(p, centre));
  for (const Vec3& source : sources)
    nearest = std::min(nearest, glm::distance(source, centre));
  if (nearest < nearest_source * radius) return {};
  const double ka = body.wave_number() * radius;
  const double most = std::max(few_points, points_per_point * static_cast<double>(body.points().size()));
  if (2 * (ka + 1) * (ka + 1) > most) return {};  // first, because it may be more than any integer
  const auto rings = static_cast<double>(rings_for(order_of(ka), nearest / radius));
  if (2 * rings * rings > most) return {};
  return FarForce(body, centre, radius, nearest);
}

FarForce::FarForce(const RigidBody& body, const Vec3& centre, double radius, double sources_m)
    : body_(&body),
      radius_(radius),
      sphere_(order_of(body.wave_number() * radius),
              rings_for(order_of(body.wave_number() * radius), sources_m / radius)),
      far_(sphere_.order(), sphere_.order() + 1),
      samples_(body.points(), body.normals(), body.areas(), centre, body.wave_number()) {
  for (const Vec3& direction : sphere_.directions())
    points_.push_back(centre + radius * direction);
}

std::vector<Vec3> FarForce::forces(const Waves& incident, std::span<const std::complex<float>> unknowns,
                                   const Air& air) const {
  const double k = body_->wave_number();
  const std::size_t vertices = body_->mesh().positions.size(), waves = unknowns.size() / vertices;
  const std::size_t padded = samples_.padded(), directions = far_.directions().size();
  // The pressures at the samples, as float planes.
  std::vector<float> pressures(2 * waves * padded);
  const auto rule = three_point_rule();
  for (std::size_t wave = 0; wave < waves; ++wave) {
    for (std::size_t point = 0; point < body_->points().size(); ++point) {
      const glm::uvec3& t = body_->mesh().triangles[point / rule.size()];
      const TriangleSample& at = rule[point % rule.size()];
      const std::complex<float>* const u = &unknowns[wave * vertices];
      const std::complex<float> p = static_cast<float>(1 - at.u - at.v) * u[t.x] + static_cast<float>(at.u) * u[t.y] +
                                    static_cast<float>(at.v) * u[t.z];
      pressures[2 * wave * padded + point] = p.real();
      pressures[(2 * wave + 1) * padded + point] = p.imag();
    }
  }
  std::vector<Complex> far(directions * waves);  // [direction][wave]
  parallel_chunks(directions, 32, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t d = begin; d < end; ++d)
      far_sums(samples_, far_.directions()[d], pressures, std::span(far).subspan(d * waves, waves));
  });

  // 1 / (4 pi i^l (j_l + i j_l')), by order.
  std::vector<Complex> from_q;
  Complex power = 1;
  for (unsigned l = 0; l <= far_.order(); ++l) {
    const double x = k * radius_, j = std::sph_bessel(l, x), slope = l / x * j - std::sph_bessel(l + 1, x);
    from_q.push_back(1.0 / (4 * std::numbers::pi * power * Complex(j, slope)));
    power *= Complex(0, 1);
  }
  std::vector<Vec3> forces(waves, Vec3(0));
  parallel_chunks(waves, 1, [&](std::size_t wave, std::size_t, std::size_t) {
    std::vector<Complex> q(points_.size());
    for (std::size_t i = 0; i < q.size(); ++i) {
      const std::size_t at = wave * q.size() + i;
      q[i] = incident.pressures[at] + Complex(0, 1 / k) * incident.slopes[at];
    }
    std::vector<Complex> coefficients = sphere_.coefficients(q);
    for (std::size_t l = 0; l <= far_.order(); ++l) {
      for (std::size_t i = l * l; i < (l + 1) * (l + 1); ++i)
        coefficients[i] *= from_q[l];
    }
    const std::vector<Complex> g = far_.values(coefficients);
    for (std::size_t d = 0; d < directions; ++d) {
      const Complex f = Complex(0, -k / (4 * std::numbers::pi)) * far[d * waves + wave];
      const double sent = std::norm(f) - 4 * std::numbers::pi / k * (std::conj(g[d]) * f).imag();
      forces[wave] -= far_.weights()[d] * sent * far_.directions()[d];
    }
    forces[wave] /= 2 * air.stiffness_pa();
  });
  return forces;
}

Strengths without_absorption(std::span<const Complex> strengths, const array::Layout& layout, const Air& air,
                             const Vec3& place) {
  Strengths reduced(strengths.begin(), strengths.end());
  for (std::size_t i = 0; i < reduced.size(); ++i)
    reduced[i] *= std::exp(-air.absorption_np_m * glm::distance(layout.transducers[i].position, place));
  return reduced;
}

Vec3 loudest_vertex(const RigidBody& body, std::span<const std::complex<float>> unknowns) {
  const auto quieter = [](const std::complex<float>& a, const std::complex<float>& b) {
    return std::norm(a) < std::norm(b);
  };
  return body.mesh()
      .positions[static_cast<std::size_t>(std::ranges::max_element(unknowns, quieter) - unknowns.begin())];
}

}  // namespace palpa::acoustics
