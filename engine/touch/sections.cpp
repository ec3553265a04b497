#include "touch/sections.hpp"

#include <cmath>
#include <numbers>
#include <span>

#include "gpu/scan.hpp"
#include "shaders/fingers.h"
#include "shaders/touch_math.h"
#include "spirv/sections.comp.hpp"

namespace palpa::touch {
namespace {

static_assert(max_foci == shader::sections_most_foci);

using shader::Float3;
using shader::Sum;

constexpr std::uint32_t lanes = shader::sections_group;

Float3 position(const Contact& contact) {
  return {contact.position.x, contact.position.y, contact.position.z};
}

glm::vec3 to_vec(const Float3& v) {
  return {v.x, v.y, v.z};
}

/// The threads' sums added in thread order.
float total(const std::array<Sum, lanes>& partial) {
  Sum sum{0, 0};
  for (const Sum& lane : partial)
    sum = add(sum, lane.sum);
  return sum.sum;
}

/// The finger's contacts relative to its first one, and their mean.
struct Local {
  Float3 origin{}, mean{};
  Float3 from_centroid(const Contact& contact) const { return minus(minus(position(contact), origin), mean); }
};

Local find_mean(const Finger& finger, const std::vector<Contact>& contacts, float share) {
  Local local;
  local.origin = position(contacts[finger.contacts.front()]);
  std::array<Sum, lanes> x{}, y{}, z{};
  for (const std::uint32_t i : finger.contacts) {
    const Float3 d = minus(position(contacts[i]), local.origin);
    x[i % lanes] = add(x[i % lanes], d.x);
    y[i % lanes] = add(y[i % lanes], d.y);
    z[i % lanes] = add(z[i % lanes], d.z);
  }
  local.mean = shader::scaled({total(x), total(y), total(z)}, share);
  return local;
}

shader::Sym3 covariance(const Finger& finger, const std::vector<Contact>& contacts, const Local& local, float share) {
  std::array<std::array<Sum, lanes>, 6> sums{};
  for (const std::uint32_t i : finger.contacts) {
    const Float3 d = local.from_centroid(contacts[i]);
    const std::array<float, 6> products{shader::product(d.x, d.x), shader::product(d.x, d.y),
                                        shader::product(d.x, d.z), shader::product(d.y, d.y),
                                        shader::product(d.y, d.z), shader::product(d.z, d.z)};
    for (std::size_t k = 0; k < 6; ++k)
      sums[k][i % lanes] = add(sums[k][i % lanes], products[k]);
  }
  return {total(sums[0]) * share, total(sums[1]) * share, total(sums[2]) * share,
          total(sums[3]) * share, total(sums[4]) * share, total(sums[5]) * share};
}

std::uint32_t sector_of(const shader::Float2& p, std::span<const shader::Border> borders) {
  if (p.x == 0 && p.y == 0) return 0;
  std::uint32_t sector = 0;
  for (std::size_t n = 1; n < borders.size(); ++n)
    sector += reaches(p, {borders[n].x, borders[n].y}) ? 1 : 0;
  return sector;
}

void find_foci(Finger& finger, const std::vector<Contact>& contacts, const Local& local, const shader::Axes& axes,
               std::span<const shader::Border> borders) {
  const float scale1 = 1.0F / std::sqrt(axes.l1), scale2 = 1.0F / std::sqrt(axes.l2);
  const float steps = steps_per_metre(static_cast<std::uint32_t>(finger.contacts.size()), axes);
  std::array<std::array<std::int32_t, 3>, max_foci> sums{};
  finger.foci.assign(borders.size(), {});
  for (const std::uint32_t i : finger.contacts) {
    const Float3 d = local.from_centroid(contacts[i]);
    const std::uint32_t sector = sector_of(on_plane(axes, d, scale1, scale2), borders);
    sums[sector][0] += shader::in_steps(d.x, steps);
    sums[sector][1] += shader::in_steps(d.y, steps);
    sums[sector][2] += shader::in_steps(d.z, steps);
    ++finger.foci[sector].points;
  }
  for (std::size_t n = 0; n < borders.size(); ++n) {
    Focus& focus = finger.foci[n];
    if (focus.points == 0) continue;
    focus.position = {shader::focus_coordinate(local.origin.x, local.mean.x, sums[n][0], focus.points, steps),
                      shader::focus_coordinate(local.origin.y, local.mean.y, sums[n][1], focus.points, steps),
                      shader::focus_coordinate(local.origin.z, local.mean.z, sums[n][2], focus.points, steps)};
  }
}

/// The direction of angle 2 pi n / N, exact where it lies on an axis.
shader::Border border(std::uint32_t n, std::uint32_t foci) {
  const double angle = 2 * std::numbers::pi * n / foci;
  double x = std::cos(angle), y = std::sin(angle);
  if (std::abs(x) < 1e-12) x = 0;
  if (std::abs(y) < 1e-12) y = 0;
  return {static_cast<float>(x), static_cast<float>(y)};
}

std::size_t first_border(std::size_t foci) {
  return foci * (foci - 1) / 2;
}

}  // namespace

std::vector<shader::Border> sector_borders() {
  std::vector<shader::Border> borders;
  borders.reserve(first_border(max_foci + 1));
  for (std::uint32_t foci = 1; foci <= max_foci; ++foci) {
    for (std::uint32_t n = 0; n < foci; ++n)
      borders.push_back(border(n, foci));
  }
  return borders;
}

void find_sections(const Parameters& parameters, Touch& out) {
  const std::vector<shader::Border> every = sector_borders();
  const std::span borders = std::span(every).subspan(first_border(parameters.foci), parameters.foci);
  for (Finger& finger : std::span(out.fingers).first(out.finger_count)) {
    const auto members = static_cast<std::uint32_t>(finger.contacts.size());
    const float share = 1.0F / static_cast<float>(members);
    const Local local = find_mean(finger, out.contacts, share);
    const shader::Axes axes = principal_axes(covariance(finger, out.contacts, local, share));
    finger.section.centroid = to_vec(local.origin) + to_vec(local.mean);
    finger.section.axes = {to_vec(axes.w1), to_vec(axes.w2), to_vec(axes.w3)};
    finger.section.eigenvalues = {axes.l1, axes.l2, axes.l3};
    finger.point_like = shader::is_point_like(members, axes.l1, axes.l2);
    if (finger.point_like) {
      finger.foci.assign(1, {finger.section.centroid, members});
    } else {
      find_foci(finger, out.contacts, local, axes, borders);
    }
  }
}

SectionsPass::SectionsPass(const gpu::Device& device)
    : pipeline_(device, "sections", spirv::sections_comp, {shader::sections_buffers, sizeof(shader::SectionsPush)}) {}

void SectionsPass::record(VkCommandBuffer commands, const SectionsBuffers& b, const Parameters& parameters) const {
  const shader::SectionsPush push{b.most_contacts, parameters.foci, 0, 0};
  const gpu::BufferRef groups{b.header.buffer, b.header.offset, sizeof(VkDispatchIndirectCommand)};
  pipeline_.dispatch_indirect(commands, {b.total, b.parents, b.contacts, b.fingers, b.foci, b.borders}, &push, groups);
}

}  // namespace palpa::touch
