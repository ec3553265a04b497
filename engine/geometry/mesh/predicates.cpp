#include "geometry/mesh/predicates.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace palpa::geometry {
namespace {

/// A sum of non-overlapping doubles, the smallest first: a number of any length (Shewchuk's expansions). Zeros are left
/// out.
template <std::size_t Most>
struct Expansion {
  std::array<double, Most> term;
  std::size_t count = 0;

  void add(double value) {
    double carry = value;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double sum = carry + term[i];
      const double back = sum - carry;
      const double lost = (carry - (sum - back)) + (term[i] - back);
      carry = sum;
      if (lost != 0) term[kept++] = lost;
    }
    if (carry != 0) term[kept++] = carry;
    count = kept;
  }

  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }

  int sign() const { return count == 0 ? 0 : (term[count - 1] > 0 ? 1 : -1); }
};

/// a - b as a sum of two doubles.
struct Difference {
  double high, low;
};
Difference difference(double a, double b) {
  const double high = a - b;
  const double back = a - high;
  return {high, (a - (high + back)) + (back - b)};
}

template <std::size_t A, std::size_t Most>
void add_times(Expansion<Most>& sum, const Expansion<A>& factor, const Difference& d) {
  for (std::size_t i = 0; i < factor.count; ++i) {
    sum.add_product(factor.term[i], d.high);
    if (d.low != 0) sum.add_product(factor.term[i], d.low);
  }
}

void add_product(Expansion<16>& sum, const Difference& a, const Difference& b, double sign) {
  sum.add_product(sign * a.high, b.high);
  if (b.low != 0) sum.add_product(sign * a.high, b.low);
  if (a.low != 0) sum.add_product(sign * a.low, b.high);
  if (a.low != 0 && b.low != 0) sum.add_product(sign * a.low, b.low);
}

Expansion<16> minor(const Difference& ax, const Difference& ay, const Difference& bx, const Difference& by) {
  Expansion<16> m;
  add_product(m, ax, by, 1);
  add_product(m, ay, bx, -1);
  return m;
}

int exact_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  std::array<Difference, 3> u, v, w;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    u[k] = difference(b[i], a[i]);
    v[k] = difference(c[i], a[i]);
    w[k] = difference(d[i], a[i]);
  }
  Expansion<256> sum;
  add_times(sum, minor(u[0], u[1], v[0], v[1]), w[2]);
  add_times(sum, minor(u[1], u[2], v[1], v[2]), w[0]);
  add_times(sum, minor(u[2], u[0], v[2], v[0]), w[1]);
  return sum.sign();
}

}  // namespace

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const double xy = u.x * v.y, yx = u.y * v.x, yz = u.y * v.z, zy = u.z * v.y, zx = u.z * v.x, xz = u.x * v.z;
  const double det = (xy - yx) * w.z + (yz - zy) * w.x + (zx - xz) * w.y;
  const double size = (std::abs(xy) + std::abs(yx)) * std::abs(w.z) + (std::abs(yz) + std::abs(zy)) * std::abs(w.x) +
                      (std::abs(zx) + std::abs(xz)) * std::abs(w.y);
  // (7 + 56 epsilon) epsilon of Shewchuk's paper, rounded up.
  if (std::abs(det) > 8e-16 * size) return det > 0 ? 1 : -1;
  if (size == 0) return 0;  // a plane parallel to the axes
  return exact_orient3d(a, b, c, d);
}

int orient2d(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double left = (b.x - a.x) * (c.y - a.y), right = (b.y - a.y) * (c.x - a.x);
  const double det = left - right;
  if (std::abs(det) > 4e-16 * (std::abs(left) + std::abs(right))) return det > 0 ? 1 : -1;
  return minor(difference(b.x, a.x), difference(b.y, a.y), difference(c.x, a.x), difference(c.y, a.y)).sign();
}

}  // namespace palpa::geometry
