// The lines of a surface: its creases, and its outline as seen from a place. They are found on the host, because hardly
// any of a dense mesh's edges are visible and a device would work through all of them.
#pragma once

#include <cstdint>
#include <vector>

#include "shaders/viewer/view_scene.h"

namespace palpa::viewer {

/// The edges of a mesh that may be drawn as lines.
struct EdgeNet {
  /// The plane of each face: unit normal, and its dot product with any point of the face.
  std::vector<shader::vec4> planes;
  /// An edge between two faces that join smoothly. It is a line if one face is seen from its front and the other is
  /// not.
  struct Fold {
    std::uint32_t from, to;     ///< indices into `ends`
    std::uint32_t left, right;  ///< indices into `planes`
  };
  std::vector<Fold> folds;
  std::vector<shader::vec4> ends;  ///< xyz metres
  /// Sharp or open edges, which are lines from every viewpoint.
  std::vector<shader::ViewEdge> creases;
};

/// Finds outlines; keeps its memory from one surface to the next.
class Outliner {
 public:
  /// Appends the folds of `net` that form its outline, in their order. `eye` is as in ViewPush.
  void find(const EdgeNet& net, const shader::vec4& eye, std::vector<shader::ViewEdge>& lines);

 private:
  std::vector<std::uint8_t> in_front_;  ///< of each face: whether its front is seen
};

}  // namespace palpa::viewer
