// The finger of the ideal observer: its equations in sound, and its afferents. It stays at its own origin; objects and
// arrays move around it, so that its equations are solved once.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"
#include "observer/afferents/skin_load.hpp"
#include "observer/afferents/skin_sites.hpp"
#include "setup/options/options.hpp"

namespace palpa::experiment {

class ObservedFinger {
 public:
  /// A closed mesh with its tip at the origin and its body along +y. Throws as load_body does, and bad_input if there
  /// is no skin near the origin.
  explicit ObservedFinger(const std::string& file);
  /// The same of a mesh with its equations. `name` is for messages.
  ObservedFinger(std::string name, const acoustics::Air& air, std::shared_ptr<const acoustics::RigidBody> body);

  const std::string& name() const { return name_; }
  const geometry::Mesh& mesh() const { return mesh_; }
  const acoustics::Air& air() const { return air_; }
  /// Made when it is first needed.
  const acoustics::RigidBody& body();
  const observer::SkinSites& sites() const { return sites_; }
  /// Points of the skin near the tip, at most about 0.3 mm apart, as dense as the clouds of several cameras. The mesh's
  /// own vertices are so far apart that an edge or a point of a shape may pass between them.
  const std::vector<Vec3>& skin() const { return skin_; }
  /// From pressures to afferents, with waves and without.
  const observer::SkinLoad& load(observer::Delays delays);

 private:
  void find_skin();

  std::string name_;
  acoustics::Air air_;
  geometry::Mesh mesh_;
  observer::SkinSites sites_;
  std::vector<Vec3> skin_;
  std::shared_ptr<const acoustics::RigidBody> body_;
  std::optional<observer::SkinLoad> waves_, at_once_;
};

}  // namespace palpa::experiment
