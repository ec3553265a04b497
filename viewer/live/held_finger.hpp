// A made-up finger under somebody's hand.
#pragma once

#include <glm/ext/matrix_transform.hpp>
#include <mutex>
#include <string>

#include "base/math.hpp"
#include "session/links/sources.hpp"

namespace palpa::viewer {

/// The viewer's thread says where it is, the capture thread has the rig's cameras see it there: a session knows no
/// other finger from it.
class HeldFinger {
 public:
  /// Its tip is at the origin of its own frame, its body along +y.
  Transform pose() const;
  void put(const Transform& T_world_finger);

  /// Whether --source is of the kind `mouse`.
  static bool is_held(const std::string& source);
  /// That kind. The finger outlives what it opens.
  session::SourceKind source();

 private:
  mutable std::mutex mutex_;
  /// Out of everybody's sight until somebody has put it where it is to be.
  Transform T_world_finger_ = glm::translate(Transform(1.0), Vec3(0, 10, 0));
};

}  // namespace palpa::viewer
