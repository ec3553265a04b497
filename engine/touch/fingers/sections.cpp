#include "touch/fingers/sections.hpp"

#include <array>
#include <cmath>
#include <span>
#include <utility>

namespace palpa::touch {
namespace {

/// A running sum and the part that rounding has removed (Kahan): the error stays at one rounding, however many terms.
struct Sum {
  glm::vec3 sum{0}, lost{0};

  void add(const glm::vec3& term) {
    const glm::vec3 y = term - lost, t = sum + y;
    lost = t - sum - y;
    sum = t;
  }
};

/// Contact k of a finger is added to lane k mod lanes.
constexpr std::uint32_t lanes = 128;
using Lanes = std::array<Sum, lanes>;

/// Adds the lanes' sums, in their order.
glm::vec3 total(const Lanes& partial) {
  Sum sum;
  for (const Sum& lane : partial)
    sum.add(lane.sum);
  return sum.sum;
}

float share_of(const Finger& finger) {
  return 1.0F / static_cast<float>(finger.contacts.size());
}

/// Covariance of the contacts' places, and of their depth with their places.
struct Moments {
  glm::mat3 covariance;
  glm::vec3 lean;
};

Moments moments_of(const Finger& finger, const std::vector<Contact>& contacts, const LocalOrigin& local) {
  Lanes with_x, others, with_depth;
  for (std::size_t member = 0; member < finger.contacts.size(); ++member) {
    const Contact& contact = contacts[finger.contacts[member]];
    const glm::vec3 d = local.from_centroid(contact.position);
    with_x[member % lanes].add(d * d.x);
    others[member % lanes].add(glm::vec3(d.y, d.y, d.z) * glm::vec3(d.y, d.z, d.z));
    with_depth[member % lanes].add(d * contact.depth_m);
  }
  const float share = share_of(finger);
  const glm::vec3 x = total(with_x) * share, o = total(others) * share;
  return {{x, {x.y, o.x, o.y}, {x.z, o.y, o.z}}, total(with_depth) * share};
}

/// Jacobi rotations, which make a symmetric matrix diagonal.
struct Jacobi {
  glm::mat3 a;     ///< what is left of the matrix, scaled to trace 1
  glm::mat3 v{1};  ///< columns: the axes

  bool is_diagonal() const { return std::abs(a[0][1]) + std::abs(a[0][2]) + std::abs(a[1][2]) <= 1e-12F; }
  /// Makes a[p][q] zero; `o` is the third axis.
  void rotate(int p, int q, int o) {
    const float apq = a[p][q];
    if (std::abs(apq) <= 1e-12F) return;  // far below the last digit of a trace of 1
    const float theta = (a[q][q] - a[p][p]) / (2.0F * apq);
    const float root = std::abs(theta) + std::sqrt(theta * theta + 1.0F);
    const float t = (theta < 0.0F ? -1.0F : 1.0F) / root;
    const float c = 1.0F / std::sqrt(t * t + 1.0F), s = t * c;
    a[p][p] -= t * apq;
    a[q][q] += t * apq;
    a[p][q] = a[q][p] = 0;
    const float aop = c * a[o][p] - s * a[o][q], aoq = s * a[o][p] + c * a[o][q];
    a[o][p] = a[p][o] = aop;
    a[o][q] = a[q][o] = aoq;
    const glm::vec3 vp = c * v[p] - s * v[q], vq = s * v[p] + c * v[q];
    v[p] = vp;
    v[q] = vq;
  }
};

/// Fills axes and eigenvalues: the principal axes of a symmetric matrix, by cyclic Jacobi rotations. Ten sweeps are
/// three more than any 3x3 float matrix needs. Always finite and orthonormal: the zero matrix gives w1 = x, w3 = y,
/// w2 = w3 x w1 = -z. Signs: w3 points upwards, w1's largest component is positive, w2 = w3 x w1.
void take_principal_axes(const glm::mat3& m, CrossSection& section) {
  const float trace = m[0][0] + m[1][1] + m[2][2];
  const bool empty = !(trace > 0);
  Jacobi jacobi{m * (empty ? 0.0F : 1.0F / trace)};
  for (int turn = 0; turn < 30 && !jacobi.is_diagonal(); ++turn) {
    const int pair = turn % 3, p = pair == 2 ? 1 : 0, q = pair == 0 ? 1 : 2;
    jacobi.rotate(p, q, 3 - p - q);
  }
  const auto value = [&](int axis) { return jacobi.a[axis][axis]; };
  std::array<int, 3> order{0, 1, 2};  // the largest first
  if (empty) order = {0, 2, 1};
  for (const std::size_t k : {0U, 1U, 0U}) {
    if (value(order[k]) < value(order[k + 1])) std::swap(order[k], order[k + 1]);
  }
  auto& [w1, w2, w3] = section.axes;
  w1 = glm::normalize(jacobi.v[order[0]]);
  w3 = jacobi.v[order[2]];
  w3 = upwards(glm::normalize(w3 - w1 * glm::dot(w1, w3)));
  if (largest_component(w1) < 0) w1 = -w1;
  w2 = glm::cross(w3, w1);
  for (std::size_t k = 0; k < 3; ++k)
    section.eigenvalues[k] = std::max(0.0F, value(order[k]) * trace);
}

/// A finger without a cross-section: fewer than 3 contacts; coincident ones (a spread below a tenth of a micrometre,
/// the spacing of single-precision coordinates a metre from the origin); collinear ones (a thousand times longer than
/// wide: below that, the covariance's second eigenvalue is rounding).
bool is_point_like(const Finger& finger) {
  const auto [l1, l2, l3] = finger.section.eigenvalues;
  return finger.contacts.size() < 3 || l1 <= 1e-14F || l2 <= 1e-6F * l1;
}

}  // namespace

float largest_component(const glm::vec3& a) {
  float largest = a.x;
  if (std::abs(a.y) > std::abs(largest)) largest = a.y;
  if (std::abs(a.z) > std::abs(largest)) largest = a.z;
  return largest;
}

glm::vec3 upwards(const glm::vec3& axis) {
  const float decides = std::abs(axis.y) >= 1e-6F ? axis.y : std::abs(axis.z) >= 1e-6F ? axis.z : axis.x;
  return decides < 0 ? -axis : axis;
}

LocalOrigin local_origin(const Finger& finger, const std::vector<Contact>& contacts) {
  LocalOrigin local{.origin = contacts[finger.contacts.front()].position};
  Lanes sums;
  for (std::size_t member = 0; member < finger.contacts.size(); ++member)
    sums[member % lanes].add(local.from_centroid(contacts[finger.contacts[member]].position));
  local.mean = total(sums) * share_of(finger);
  return local;
}

void find_sections(Touch& out) {
  std::uint32_t id = 0;
  for (Finger& finger : std::span(out.fingers).first(out.finger_count)) {
    const LocalOrigin local = local_origin(finger, out.contacts);
    const Moments moments = moments_of(finger, out.contacts, local);
    finger.id = id++;
    finger.holds = false;
    finger.section.centroid = local.origin + local.mean;
    take_principal_axes(moments.covariance, finger.section);
    finger.section.turn = {1, 0};
    finger.section.lean = moments.lean;
    finger.point_like = is_point_like(finger);
  }
}

}  // namespace palpa::touch
