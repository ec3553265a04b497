#include "acoustics/bodies/body_cache.hpp"

#include <algorithm>

namespace palpa::acoustics {

std::shared_ptr<const RigidBody> BodyCache::of(const geometry::Mesh& mesh, double wave_number,
                                               const std::atomic<bool>* give_up) {
  const auto found = std::ranges::find_if(kept_, [&](const auto& body) {
    return body->wave_number() == wave_number && body->mesh().positions == mesh.positions &&
           body->mesh().triangles == mesh.triangles;
  });
  if (found != kept_.end()) {
    std::rotate(found, found + 1, kept_.end());
    return kept_.back();
  }
  if (kept_.size() >= most_ && !kept_.empty()) kept_.erase(kept_.begin());
  auto body = std::make_shared<const RigidBody>(mesh, wave_number, give_up);
  ++made_;
  if (most_ > 0) kept_.push_back(body);
  return body;
}

}  // namespace palpa::acoustics
