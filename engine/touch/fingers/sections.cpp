#include "touch/fingers/sections.hpp"

#include <span>

#include "touch/fingers/sections_math.hpp"

namespace palpa::touch {
namespace {

/// Contact k of a finger is added to lane k mod lanes.
constexpr std::uint32_t lanes = 128;

/// Adds the lanes' sums, in their order.
float total(const std::array<Sum, lanes>& partial) {
  Sum sum{0, 0};
  for (const Sum& lane : partial)
    sum = add(sum, lane.sum);
  return sum.sum;
}

float share_of(const Finger& finger) {
  return 1.0F / static_cast<float>(finger.contacts.size());
}

/// Covariance of the contacts' places, and of their depth with their places.
struct Moments {
  Sym3 covariance;
  Float3 lean;
};

Moments moments_of(const Finger& finger, const std::vector<Contact>& contacts, const LocalOrigin& local) {
  std::array<std::array<Sum, lanes>, 9> sums{};
  for (std::size_t member = 0; member < finger.contacts.size(); ++member) {
    const Contact& contact = contacts[finger.contacts[member]];
    const Float3 d = local.from_centroid(contact.position);
    const std::array<float, 9> products{d.x * d.x,
                                        d.x * d.y,
                                        d.x * d.z,
                                        d.y * d.y,
                                        d.y * d.z,
                                        d.z * d.z,
                                        d.x * contact.depth_m,
                                        d.y * contact.depth_m,
                                        d.z * contact.depth_m};
    for (std::size_t k = 0; k < products.size(); ++k)
      sums[k][member % lanes] = add(sums[k][member % lanes], products[k]);
  }
  const float share = share_of(finger);
  return {{total(sums[0]) * share, total(sums[1]) * share, total(sums[2]) * share, total(sums[3]) * share,
           total(sums[4]) * share, total(sums[5]) * share},
          {total(sums[6]) * share, total(sums[7]) * share, total(sums[8]) * share}};
}

}  // namespace

LocalOrigin local_origin(const Finger& finger, const std::vector<Contact>& contacts) {
  const glm::vec3& first = contacts[finger.contacts.front()].position;
  LocalOrigin local{{first.x, first.y, first.z}, {0, 0, 0}};
  std::array<Sum, lanes> x{}, y{}, z{};
  for (std::size_t member = 0; member < finger.contacts.size(); ++member) {
    const Float3 d = local.from_centroid(contacts[finger.contacts[member]].position);
    const std::size_t lane = member % lanes;
    x[lane] = add(x[lane], d.x);
    y[lane] = add(y[lane], d.y);
    z[lane] = add(z[lane], d.z);
  }
  local.mean = shader::scaled({total(x), total(y), total(z)}, share_of(finger));
  return local;
}

void find_sections(Touch& out) {
  std::uint32_t id = 0;
  for (Finger& finger : std::span(out.fingers).first(out.finger_count)) {
    const LocalOrigin local = local_origin(finger, out.contacts);
    const Moments moments = moments_of(finger, out.contacts, local);
    const PrincipalAxes axes = principal_axes(moments.covariance);
    finger.id = id++;
    finger.holds = false;
    finger.section.centroid = to_vec(local.origin) + to_vec(local.mean);
    finger.section.axes = {to_vec(axes.w1), to_vec(axes.w2), to_vec(axes.w3)};
    finger.section.eigenvalues = {axes.l1, axes.l2, axes.l3};
    finger.section.turn = {1, 0};
    finger.section.lean = to_vec(moments.lean);
    finger.point_like = is_point_like(static_cast<std::uint32_t>(finger.contacts.size()), axes.l1, axes.l2);
  }
}

}  // namespace palpa::touch
