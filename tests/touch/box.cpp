#include "touch/harness.hpp"

namespace palpa::touch::test {

geometry::Solid box(const Vec3& low, const Vec3& high, const std::string& name) {
  geometry::Solid solid;
  solid.name = name;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 normal(0);
    normal[axis] = 1;
    solid.planes.push_back({normal, high[axis]});
    solid.planes.push_back({-normal, -low[axis]});
  }
  solid.bounds = {low, high};
  return solid;
}

}  // namespace palpa::touch::test
