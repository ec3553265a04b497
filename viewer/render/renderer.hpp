// Draws a picture into an image. Knows no window: it records into the caller's command buffer. The caller owns the
// image that is drawn to, which may be a swapchain's or one that is read back.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "gpu/image.hpp"
#include "viewer/render/drawn_picture.hpp"
#include "viewer/render/rendering.hpp"
#include "viewer/render/sheet_painter.hpp"
#include "viewer/render/view_pipelines.hpp"
#include "viewer/view/fineness.hpp"
#include "viewer/view/viewpoint.hpp"

namespace palpa::viewer {

/// What one frame in flight draws with: the multisampled image, depth, and the overlay's strokes. Made by
/// Renderer::make_canvas of a renderer that must outlive it. It may be used again once the frame that used it has
/// completed.
class Canvas {
 public:
  VkExtent2D extent() const { return depth_.extent(); }

 private:
  friend class Renderer;
  const ViewPipelines* pipelines_ = nullptr;  ///< the renderer's
  Fineness fineness_ = Fineness::fine;
  gpu::Image colour_, depth_;
  gpu::Upload overlay_, lines_;
  SheetMemory sheet_;
  std::vector<shader::ViewStroke> strokes_;
  std::vector<shader::ViewEdge> edges_;
  Outliner outliner_;
};

/// One view in a rectangle of the picture.
struct View {
  Viewpoint viewpoint;
  VkRect2D area{};     ///< pixels, inside the canvas
  bool inset = false;  ///< over what earlier views drew, with a border
};
/// The whole picture from one side.
View whole(const Viewpoint& viewpoint, std::uint32_t width, std::uint32_t height);
/// A close-up of `box` from the same side, on the right below the middle. Its width is inset_share of the picture's.
View close_up(const Viewpoint& viewpoint, const Box& box, std::uint32_t width, std::uint32_t height, double ratio);
inline constexpr double inset_share = 0.33;

struct Target {
  VkImage image = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE;
};

class Renderer {
 public:
  /// `colour` is the targets' format, 8 bits per channel and UNORM: colours are blended as they appear on the screen.
  /// Throws Error (Exit::no_device) for a driver that is known to crash when it draws.
  Renderer(const gpu::Device& device, VkFormat colour);

  /// A canvas for pictures of that fineness. The first canvas of each fineness makes its pipelines. Throws failure()
  /// for an extent of zero or beyond the device's limit.
  Canvas make_canvas(VkExtent2D extent, Fineness fineness = Fineness::fine);

  /// Draws `drawn` into `target`, which must have the canvas' extent. Its old contents are lost. Views are drawn in
  /// order, then the sheet over them. `ratio` is pixels per point (2 on a high-resolution screen). Barriers: the caller
  /// orders earlier users of the target's image before colour-attachment output (by a semaphore's wait, or by waiting
  /// for an earlier submit). Afterwards, the target is a colour target (gpu::image_use::colour_target), and the caller
  /// makes any further transition. With `next`, the picture is drawn in pieces. Returns the commands of the last piece.
  VkCommandBuffer record(VkCommandBuffer commands, DrawnPicture& drawn, std::span<const View> views, Canvas& canvas,
                         const Target& target, double ratio = 1, const Sheet* sheet = nullptr,
                         const NextStep& next = {}) const;

 private:
  VkSampleCountFlagBits samples_of(Fineness fineness) const;
  struct Shot;
  /// The lines of one surface in one view: its creases, and after them its outline.
  struct EdgeLines {
    Items all;
    std::uint32_t creases = 0;
  };
  void draw_points(const Shot& shot, const DrawnPicture& drawn) const;
  void draw_images(const Shot& shot, const DrawnPicture& drawn, const View& view) const;
  void draw_faces_and_lines(const Shot& shot, const DrawnPicture& drawn) const;
  struct Part;
  static std::vector<Part> parts_from_far(const Shot& shot, const DrawnPicture& drawn,
                                          std::span<const EdgeLines> lines);
  void draw_surfaces(const Shot& shot, const DrawnPicture& drawn, const Canvas& canvas,
                     std::span<const EdgeLines> lines) const;
  void draw_heat(const Shot& shot, const DrawnPicture& drawn) const;
  void draw_edges(const Shot& shot, const Canvas& canvas, const EdgeLines& lines) const;
  void draw_overlay(const Shot& shot, const Canvas& canvas, const Items& strokes) const;
  std::vector<Items> upload_overlay(VkCommandBuffer commands, const DrawnPicture& drawn, std::span<const View> views,
                                    Canvas& canvas, double ratio) const;
  std::vector<EdgeLines> upload_edges(VkCommandBuffer commands, const DrawnPicture& drawn, std::span<const View> views,
                                      Canvas& canvas) const;
  void draw_view(const Shot& shot, const DrawnPicture& drawn, const Canvas& canvas, const View& view,
                 const Items& overlay, std::span<const EdgeLines> lines) const;

  const gpu::Device* device_;
  VkFormat colour_, depth_;
  VkSampleCountFlagBits most_samples_;
  std::unique_ptr<const ViewPipelines> single_, several_;  ///< with one sample, and with most_samples_
};

}  // namespace palpa::viewer
