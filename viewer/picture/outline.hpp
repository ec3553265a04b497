// Where a surface is drawn as a line: its creases, and its outline as seen from a place. Found on the host: of a dense
// mesh's edges hardly any is to be seen, and a device would work through all of them.
#pragma once

#include <cstdint>
#include <vector>

#include "shaders/viewer/view_scene.h"

namespace palpa::viewer {

/// The edges of a mesh that may be lines.
struct EdgeNet {
  /// The plane of each face: unit normal, and its product with any point of the face.
  std::vector<shader::vec4> planes;
  /// Between faces that lie smoothly side by side; a line where one of them is seen from its front, the other is not.
  struct Fold {
    std::uint32_t from, to;     ///< indices into `ends`
    std::uint32_t left, right;  ///< indices into `planes`
  };
  std::vector<Fold> folds;
  std::vector<shader::vec4> ends;  ///< xyz metres
  /// Sharp or open edges: lines from wherever they are looked at.
  std::vector<shader::ViewEdge> creases;
};

/// Finds outlines; keeps its memory from one surface to the next.
class Outliner {
 public:
  /// Appends the folds of `net` that are its outline, in their order. `eye` as ViewPush has it.
  void find(const EdgeNet& net, const shader::vec4& eye, std::vector<shader::ViewEdge>& lines);

 private:
  std::vector<std::uint8_t> in_front_;  ///< of each face: whether its front is seen
};

}  // namespace palpa::viewer
