// Presents a picture on the surface of any window.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "drawing/png.hpp"
#include "gpu/buffer.hpp"
#include "gpu/commands.hpp"
#include "gpu/timestamps.hpp"
#include "viewer/render/renderer.hpp"

namespace palpa::viewer {

class Presenter {
 public:
  /// The caller owns `surface`, which must outlive the presenter. Throws Error (Exit::no_device) if the device cannot
  /// present to it.
  Presenter(const gpu::Device& device, VkSurfaceKHR surface);
  ~Presenter();
  Presenter(const Presenter&) = delete;
  Presenter& operator=(const Presenter&) = delete;

  /// Draws and presents one frame in a window of that size, and makes a new swapchain if the window has changed. On
  /// Wayland, a window is as large as what is shown in it, so `window` is all of it, not what panels leave free.
  /// Returns false if nothing could be shown, because the window has no area or has changed again meanwhile; draw again
  /// later. With `pause`, the frame is drawn piece by piece, and `pause` is called before each piece and before the
  /// frame is presented.
  bool draw(VkExtent2D window, DrawnPicture& drawn, std::span<const View> views, double ratio,
            const Sheet* sheet = nullptr, Fineness fineness = Fineness::fine, const std::function<void()>& pause = {});

  /// The next picture is first drawn unseen with that fineness, so that what the driver makes for it is ready from then
  /// on.
  void expect(Fineness fineness) { expected_ = fineness; }

  /// The same for a finished picture. It must be as large as the window, or nothing is shown.
  bool draw(const drawing::Pixels& pixels);

  /// Waits until no frame is in flight: the picture may then be updated. A device that does not answer within 10 s is
  /// abandoned, as by Timeline::wait.
  void finish();

  /// Whether the device is a processor.
  bool on_processor() const { return device_->description().kind == "cpu"; }
  /// Whether fine pictures are slow: the device is a processor, or took longer than slow_picture_ms for the last
  /// one.
  bool slow() const { return slow_; }

 private:
  struct Flight {
    gpu::Recorder recorder;
    gpu::Handle<VkSemaphore> acquired;
    gpu::Handle<VkFence> done;
    std::array<std::optional<Canvas>, 2> canvases;  ///< used for drawing, by Fineness
    gpu::Timestamps time;
    bool timed = false;  ///< the frame under way is a fine picture
    gpu::Upload pixels;  ///< used for copying
  };
  struct Image {
    VkImage image;
    gpu::Handle<VkImageView> view;
    gpu::Handle<VkSemaphore> drawn;
  };
  void wait(std::span<const VkFence> fences);
  void drain();
  void look_at_time(Flight& flight);
  Canvas& canvas(Flight& flight, Fineness fineness);
  bool rebuild(std::uint32_t width, std::uint32_t height);
  /// Submits what was recorded: everything, or the first or last piece, or one between.
  void submit(Flight& flight, VkSemaphore acquired, VkSemaphore drawn);
  using Record = std::function<void(VkCommandBuffer, Flight&, const Image&, const NextStep&)>;
  bool show(std::uint32_t width, std::uint32_t height, const Record& record, const std::function<void()>& pause = {});

  const gpu::Device* device_;
  VkSurfaceKHR surface_;
  VkSurfaceFormatKHR format_;
  Renderer renderer_;
  gpu::Handle<VkSwapchainKHR> swapchain_;
  VkExtent2D extent_{};
  std::uint32_t asked_width_ = 0, asked_height_ = 0;
  bool stale_ = true, slow_ = false;
  std::optional<Fineness> expected_;
  std::vector<Image> images_;
  std::array<Flight, 2> flights_;
  std::size_t next_flight_ = 0;
  std::vector<gpu::PassTime> times_;
  gpu::Timeline drained_;
};

}  // namespace palpa::viewer
