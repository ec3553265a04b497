#include "viewer/app/pick.hpp"

#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/surface/surface_depth.hpp"

namespace palpa::viewer {
namespace {

/// How far along the ray a triangle is; nullopt if the ray misses it (Moeller and Trumbore, 1997).
std::optional<double> hit(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, p = glm::cross(ray.direction, ac);
  const double determinant = glm::dot(ab, p);
  if (std::abs(determinant) < 1e-18) return std::nullopt;
  const Vec3 s = ray.from - a;
  const double u = glm::dot(s, p) / determinant;
  const Vec3 q = glm::cross(s, ab);
  const double v = glm::dot(ray.direction, q) / determinant, t = glm::dot(ac, q) / determinant;
  if (u < 0 || v < 0 || u + v > 1 || t <= 0) return std::nullopt;
  return t;
}

/// The place nearest to the pointer among those offered.
class Nearest {
 public:
  Nearest(const ViewState& state, double x, double y, double width, double height, double reach)
      : projection_(projection(state.viewpoint, width, height)), x_(x), y_(y), best_(reach) {}

  void offer(const char* what, const glm::vec3& at) {
    const Projected p = project(projection_, Vec3(at));
    const double away = std::hypot(p.x - x_, p.y - y_);
    if (!p.visible || away >= best_) return;
    best_ = away;
    reading_ = Reading{what, Vec3(at), std::nullopt};
  }
  const std::optional<Reading>& reading() const { return reading_; }

 private:
  shader::ViewPush projection_;
  double x_, y_, best_;
  std::optional<Reading> reading_;
};

std::optional<Reading> mark_at(const Picture& picture, const ViewState& state, double x, double y, double width,
                               double height, double ratio) {
  constexpr double reach = 7;  // points
  const auto nearest = [&] { return Nearest(state, x, y, width, height, reach * ratio); };
  Nearest foci = nearest(), contacts = nearest(), points = nearest();
  for (const FingerMarks& finger : picture.fingers) {
    for (const FocusMark& focus : finger.foci) {
      if (state.layers.shows(Layer::foci)) foci.offer("focus", focus.position);
    }
  }
  if (foci.reading()) return foci.reading();
  for (const ContactMark& contact : picture.contacts) {
    if (state.layers.shows(Layer::contacts)) contacts.offer("contact", contact.position);
  }
  if (contacts.reading()) return contacts.reading();
  for (const glm::vec3& point : picture.skin_points) {
    if (state.layers.shows(Layer::points)) points.offer("skin point", point);
  }
  for (const glm::vec3& point : picture.dropped_points) {
    if (state.layers.shows(Layer::points)) points.offer("point that is no skin", point);
  }
  return points.reading();
}

}  // namespace

std::optional<Reading> pick(const Picture& picture, const ViewState& state, double x, double y, double width,
                            double height, double ratio) {
  std::optional<Reading> reading = mark_at(picture, state, x, y, width, height, ratio);
  if (!reading && state.layers.shows(Layer::solids)) {
    const Ray ray = line_of_sight(state.viewpoint, x, y, width, height);
    double best = 1e300;
    for (const SurfaceMark& solid : picture.solids) {
      for (const glm::uvec3& t : solid.mesh.triangles) {
        const auto& p = solid.mesh.positions;
        const std::optional<double> away = hit(ray, p[t.x], p[t.y], p[t.z]);
        if (!away || *away >= best) continue;
        best = *away;
        reading = Reading{solid.name, ray.from + ray.direction * best, std::nullopt};
      }
    }
    return reading;
  }
  if (!reading) return reading;
  for (const SurfaceMark& solid : picture.solids) {
    const double depth = geometry::surface_depth(solid.mesh, reading->at);
    if (depth > reading->depth_m.value_or(0)) reading->depth_m = depth;
  }
  return reading;
}

}  // namespace palpa::viewer
