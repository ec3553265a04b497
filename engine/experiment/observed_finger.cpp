#include "experiment/observed_finger.hpp"

#include <cstdint>
#include <utility>

#include "base/error.hpp"
#include "setup/files/body.hpp"

namespace palpa::experiment {
namespace {

/// The centroids of nine equal parts of each of these faces.
std::vector<Vec3> dense_points(const geometry::Mesh& mesh, const std::vector<std::uint32_t>& faces) {
  constexpr int parts = 3;
  std::vector<Vec3> points;
  for (const std::uint32_t f : faces) {
    const glm::uvec3& t = mesh.triangles[f];
    const Vec3 a = mesh.positions[t.x], u = (mesh.positions[t.y] - a) / double{parts},
               v = (mesh.positions[t.z] - a) / double{parts};
    for (int i = 0; i < parts; ++i) {
      for (int j = 0; i + j < parts; ++j) {
        const Vec3 corner = a + double(i) * u + double(j) * v;
        points.push_back(corner + (u + v) / 3.0);
        if (i + j + 1 < parts) points.push_back(corner + 2.0 / 3.0 * (u + v));
      }
    }
  }
  return points;
}

}  // namespace

ObservedFinger::ObservedFinger(const std::string& file)
    : name_(file), air_(setup::air({}, {})), mesh_(setup::load_body(file, air_, false)) {
  find_skin();
}

ObservedFinger::ObservedFinger(std::string name, const acoustics::Air& air,
                               std::shared_ptr<const acoustics::RigidBody> body)
    : name_(std::move(name)), air_(air), mesh_(body->mesh()), body_(std::move(body)) {
  find_skin();
}

void ObservedFinger::find_skin() {
  sites_ = observer::sites_of(mesh_);
  if (sites_.positions.empty())
    throw bad_input(name_, "has no skin within 22 mm of the origin: a finger has its tip there, and its body along +y");
  skin_ = dense_points(mesh_, sites_.faces);
}

const acoustics::RigidBody& ObservedFinger::body() {
  if (!body_) body_ = std::make_shared<const acoustics::RigidBody>(mesh_, air_.wave_number());
  return *body_;
}

const observer::SkinLoad& ObservedFinger::load(observer::Delays delays) {
  std::optional<observer::SkinLoad>& load = delays == observer::Delays::waves ? waves_ : at_once_;
  if (!load) load.emplace(mesh_, sites_, delays);
  return *load;
}

}  // namespace palpa::experiment
