// A made-up finger that the user moves.
#pragma once

#include <glm/ext/matrix_transform.hpp>
#include <mutex>
#include <string>

#include "base/math.hpp"
#include "line/option_table.hpp"
#include "session/links/sources.hpp"

namespace palpa::viewer {

/// The viewer's thread sets where it is, and the capture thread lets the rig's cameras see it there. A session cannot
/// tell it from any other finger.
class HeldFinger {
 public:
  /// In its own frame, its tip is at the origin and its body along +y.
  Transform pose() const;
  void put(const Transform& T_world_finger);

  /// Whether --source is of the kind `mouse`.
  static bool is_held(const std::string& source);
  /// Changes --source for a line without a window, and so without a pointer to follow: a held finger dips by itself.
  static void without_hand(line::Given& given);
  /// The kind `mouse`. The finger must outlive the sources that it opens.
  session::SourceKind source();

 private:
  mutable std::mutex mutex_;
  /// Out of sight until it is put somewhere.
  Transform T_world_finger_ = glm::translate(Transform(1.0), Vec3(0, 10, 0));
};

}  // namespace palpa::viewer
