#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "session/give_way.hpp"
#include "viewer/app.hpp"
#include "viewer/film.hpp"
#include "viewer/offscreen.hpp"
#include "viewer/participant_window.hpp"
#include "viewer/run.hpp"
#include "viewer/script.hpp"
#include "viewer/stopper.hpp"
#include "viewer/swapchain.hpp"
#include "viewer/window.hpp"
#include "viewer/window_surface.hpp"

namespace palpa::viewer {
namespace {

using Clock = std::chrono::steady_clock;

/// Between two pictures: of a live run not more than 30 a second, so that the loop has the cores.
double shortest_s(const App& app) {
  return app.desk().live ? 1.0 / 30 : 0.0;
}

/// The participant's window as the desk has it: opened, closed, and brought up to date.
void look_after(std::optional<ParticipantWindow>& participant, App& app, const gpu::Device& device) {
  if (participant) {
    std::vector<WindowEvent> events;
    participant->take(events);
    for (const WindowEvent& event : events)
      app.handle_participant(event);
    if (participant->closing()) app.try_participant(false);
  }
  try {
    const Desk::ParticipantView& view = app.desk().participant;
    if (view.open && !participant) participant.emplace(device, view.monitor);
    if (!view.open) participant.reset();
    if (participant) participant->show(app);
  } catch (const Error& error) {
    if (device.lost()) throw;
    app.participant_window_failed(error.what());
    participant.reset();
  }
}

/// What the window shows, drawn once more for a film.
class Filming {
 public:
  Filming(const gpu::Device& device, const std::string& folder) : device_(&device), film_(folder) {}
  void add(DrawnPicture& drawn, const App::Frame& frame, const Size& size, double ratio) {
    if (!film_.wanted()) return;
    if (!offscreen_ || offscreen_->width() != size.width || offscreen_->height() != size.height)
      offscreen_ = std::make_unique<Offscreen>(*device_, size.width, size.height, ratio);
    offscreen_->draw(drawn, frame.views, frame.sheet);
    film_.add(offscreen_->pixels());
  }

 private:
  const gpu::Device* device_;
  Film film_;
  std::unique_ptr<Offscreen> offscreen_;
};

Size pixels_of(const Window& window) {
  const VkExtent2D extent = window.size();
  return {extent.width, extent.height};
}

}  // namespace

void run_window(const ViewerOptions& options, const LiveSession::Kinds& kinds) {
  const Size size = picture_size(options);
  const Outputs outputs({{"--video", options.video, Output::Kind::folder}});
  Window window(size.width, size.height, "palpa");  // first: without a display nothing else is worth doing
  const Clock::time_point begin = Clock::now();
  const auto now = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  Stopper stopper(options, Window::wake);
  App app(options, size,
          {.kinds = kinds,
           .stop = &stopper.flag(),
           .wake = Window::wake,
           .copy = [&](const std::string& text) { window.set_clipboard(text); },
           .paste = [&] { return window.clipboard(); },
           .goes_live =
               [&] {
                 stopper.begin();
                 session::give_way();
               },
           .panels = !options.no_panels,
           .settings = settings_file().value_or("")});
  // From here on: threads of a live run have begun, those of the picture have not.
  if (options.is_live()) session::give_way();
  gpu::DeviceOptions device_options = setup::device_options(options.common);
  device_options.window_extensions = window.extensions();
  const gpu::Device device(device_options);
  const WindowSurface surface(device, window);
  DrawnPicture drawn(device);  // outlives the frames that draw it: the presenter's end waits for them
  Presenter presenter(device, surface.get());
  Filming filming(device, options.video);
  Script script(options);
  app.tell_monitors(Window::monitors());
  std::optional<ParticipantWindow> participant;
  std::vector<WindowEvent> events;
  std::uint32_t frames_drawn = 0;
  double last_drawn_s = -1;
  const SilentEnd silent_end(stopper.flag());

  // Draws only when something has changed: a window that nobody touches costs nothing.
  while (!window.closing() && !app.quitting() && !(options.frames && frames_drawn >= *options.frames)) {
    const Size pixels = pixels_of(window);
    const bool visible = pixels.width > 0 && pixels.height > 0;
    double timeout = -1;
    if (const std::optional<double> next = app.next_s()) timeout = std::max(*next - now(), 1e-3);
    if (visible && app.dirty()) timeout = std::max(last_drawn_s + shortest_s(app) - now(), 0.0);
    if (options.frames || script.busy()) timeout = 0;
    events.clear();
    window.wait(timeout, events);
    for (const WindowEvent& event : events)
      app.handle(event, pixels);
    script.play(now(), [&](const Interaction& step) {
      if (step.kind == Interaction::Kind::resize) window.resize(step.width, step.height);
      if (step.kind == Interaction::Kind::event) app.handle(step.event, pixels);
    });
    if (options.frames && frames_drawn > 0) app.go_on();
    app.advance(now(), pixels);
    look_after(participant, app, device);
    if (!visible || !(app.dirty() || options.frames || script.busy())) continue;
    if (now() < last_drawn_s + shortest_s(app) && !options.frames && !script.busy()) continue;
    const double started_s = now(), ratio = options.pixel_ratio.value_or(window.pixel_ratio());
    if (app.stale()) presenter.finish();
    app.update(drawn);
    const App::Frame frame = app.render(pixels, ratio, started_s);
    if (presenter.draw(drawn, frame.views, ratio, frame.sheet)) {
      ++frames_drawn;
      script.drew();
      filming.add(drawn, frame, pixels, ratio);
    } else {
      app.handle({}, pixels);  // it was not shown: once more
    }
    last_drawn_s = now();
    app.drew(last_drawn_s - started_s);
  }
  stopper.end(app);
}

}  // namespace palpa::viewer
