// Pictures without a window: renders into its own image and reads it back.
#pragma once

#include <functional>
#include <span>

#include "drawing/png.hpp"
#include "gpu/commands.hpp"
#include "viewer/render/renderer.hpp"

namespace palpa::viewer {

using drawing::Pixels;

class Offscreen {
 public:
  /// `ratio`: pixels per point, for text and line widths. Throws failure() for sizes that the device does not support.
  Offscreen(const gpu::Device& device, std::uint32_t width, std::uint32_t height, double ratio = 1,
            Fineness fineness = Fineness::fine);

  /// Draws one frame and waits for it. The same picture and views give the same bytes on one machine. With `pause`, it
  /// is drawn piece by piece, and `pause` is called before each piece.
  void draw(DrawnPicture& drawn, std::span<const View> views, const Sheet* sheet = nullptr,
            const std::function<void()>& pause = {});
  void draw(DrawnPicture& drawn, const Viewpoint& viewpoint);
  /// The picture of the last draw; all zero before the first.
  Pixels pixels() const;

  std::uint32_t width() const { return canvas_.extent().width; }
  std::uint32_t height() const { return canvas_.extent().height; }

 private:
  Renderer renderer_;
  Canvas canvas_;
  gpu::Image image_;
  gpu::Readback readback_;
  gpu::Recorder recorder_;
  gpu::Timeline timeline_;
  double ratio_;
  bool drawn_ = false;
};

}  // namespace palpa::viewer
