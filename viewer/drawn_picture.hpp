// A picture in device memory, ready to be drawn from any side.
#pragma once

#include <cstdint>
#include <vector>

#include "gpu/buffer.hpp"
#include "shaders/view_scene.h"
#include "viewer/picture.hpp"

namespace palpa::viewer {

/// A run of items in one of the scene's buffers.
struct Items {
  std::uint32_t first = 0, count = 0;
};

/// One surface's triangles and edges.
struct SurfaceItems {
  Vec3 centre{};  ///< of its bounds: surfaces are drawn from far to near
  Items vertices, edges;
  std::optional<std::uint32_t> part{};  ///< as SurfaceMark has it
};

class DrawnPicture {
 public:
  explicit DrawnPicture(const gpu::Device& device) : device_(&device) {}

  /// Replaces what the scene shows. No frame that draws it may be in flight. Buffers grow and never shrink, so that a
  /// live scene settles.
  void update(const Picture& picture);
  /// The same for everything but `solids` and `skin`, which stay those of the last update: what changes with every
  /// frame of a live view, without working through the meshes again.
  void update_marks(const Picture& picture);
  /// Copies what changed to the device where memory is not unified; outside a rendering, before the draws.
  void record_upload(VkCommandBuffer commands);

 private:
  friend class Renderer;
  template <typename T>
  void fill(gpu::Upload& upload, const std::vector<T>& items, const char* name);
  SurfaceItems add_surface(const geometry::Mesh& mesh);

  const gpu::Device* device_;
  Picture picture_;  ///< without the meshes
  Box floor_;        ///< the grid lies on its underside
  std::vector<SurfaceItems> solids_;
  SurfaceItems skin_;
  Items boards_, points_, contacts_, transducers_, lines_;
  gpu::Upload vertices_, edges_, board_vertices_, discs_, strokes_;
  bool surfaces_changed_ = false, marks_changed_ = false;
  std::vector<shader::ViewVertex> new_vertices_;
  std::vector<shader::ViewEdge> new_edges_;
  std::vector<shader::ViewDisc> new_discs_;
  std::vector<shader::ViewStroke> new_strokes_;
};

}  // namespace palpa::viewer
