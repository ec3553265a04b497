// A picture in device memory, ready to be drawn from any side.
#pragma once

#include <cstdint>
#include <vector>

#include "gpu/buffer.hpp"
#include "shaders/viewer/view_scene.h"
#include "viewer/picture/outline.hpp"
#include "viewer/picture/palette.hpp"
#include "viewer/picture/picture.hpp"
#include "viewer/picture/world_marks.hpp"

namespace palpa::viewer {

/// A run of items in one of the scene's buffers.
struct Items {
  std::uint32_t first = 0, count = 0;
};

/// A coarser form of a surface, see detail.hpp.
struct CoarserItems {
  Items corners;
  double error_m = 0;
};

/// One surface's triangles and edges.
struct SurfaceItems {
  Box bounds{};  ///< surfaces are drawn from far to near by its centre
  Items corners;
  std::vector<CoarserItems> coarser;
  EdgeNet edges;
  std::optional<std::uint32_t> part{};  ///< as SurfaceMark has it
  Vec3 away{0};                         ///< where it goes when its solid is taken apart
};

/// Triangles of surfaces on the device, and whether they must still be copied there.
struct SurfaceMemory {
  gpu::Upload vertices, corners;
  bool changed = false;
};

/// An image's two triangles, and where its pixels begin.
struct ImageItems {
  Layer layer = Layer::depth;
  Items vertices;
  std::uint32_t first_pixel = 0, width = 0, height = 0;
};

class DrawnPicture {
 public:
  explicit DrawnPicture(const gpu::Device& device) : device_(&device) {}

  /// Replaces what the scene shows. No frame that draws it may be in flight. Buffers grow and never shrink, so that the
  /// memory of a live scene settles.
  void update(const Picture& picture, const ViewState& state = {});
  /// The same for everything but `solids`: for a skin's surface with other colours or in another place.
  void update_skin(const Picture& picture, const ViewState& state = {});
  /// The same for everything but `solids` and `skin`, which stay those of the last update. It updates what changes with
  /// every frame of a live view, or with the state of the view, and does not process the meshes again.
  void update_marks(const Picture& picture, const ViewState& state = {});
  /// Copies what changed to the device if memory is not unified. Call it outside a rendering, before the draws.
  void record_upload(VkCommandBuffer commands);

 private:
  friend class Renderer;
  void begin_surfaces();
  SurfaceItems add_surface(const SurfaceMark& surface);
  void end_surfaces(SurfaceMemory& memory, const char* name, const char* corners_name);
  void add_discs(const Picture& picture, const Theme& theme);
  void add_images(const Picture& picture);
  Box floor() const;

  const gpu::Device* device_;
  Picture picture_;  ///< without what is on the device
  ViewState state_;
  Box everything_;                    ///< used if there are no solids
  std::vector<SurfaceItems> solids_;  ///< if very many lie in one place, only as many as can be seen
  SurfaceItems skin_;
  bool skin_has_colours_ = false;
  Box points_box_;
  std::vector<ImageItems> images_;
  Items boards_, sections_, tile_, points_, contacts_, transducers_, lines_;
  SurfaceMemory solids_memory_, skin_memory_;
  gpu::Upload face_vertices_, pixels_, discs_, strokes_;
  bool marks_changed_ = false;
  std::vector<shader::ViewVertex> new_vertices_;
  std::vector<std::uint32_t> new_corners_;
  std::vector<shader::ViewDisc> new_discs_;
  std::vector<std::uint32_t> new_pixels_;
  WorldMarks new_marks_;
};

}  // namespace palpa::viewer
