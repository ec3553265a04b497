#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files/outputs.hpp"
#include "viewer/app/app.hpp"
#include "viewer/live/frame_gaps.hpp"
#include "viewer/options/preferences.hpp"
#include "viewer/panels/file_font.hpp"
#include "viewer/render/offscreen.hpp"
#include "viewer/run/drawing_threads.hpp"
#include "viewer/run/film.hpp"
#include "viewer/run/report.hpp"
#include "viewer/run/run.hpp"
#include "viewer/run/script.hpp"
#include "viewer/run/stopper.hpp"
#include "viewer/run/viewer_files.hpp"
#include "viewer/window/participant_window.hpp"
#include "viewer/window/swapchain.hpp"
#include "viewer/window/window.hpp"
#include "viewer/window/window_surface.hpp"

namespace palpa::viewer {
namespace {

using Clock = std::chrono::steady_clock;

/// The shortest time between two pictures. A live run has at most 30 pictures a second, so that the loop has the cores;
/// so has what plays as fast as it sounds.
double shortest_s(const App& app) {
  constexpr double fast = 600;
  return app.data().content.live || app.data().state.time.slots_per_s > fast ? 1.0 / 30 : 0.0;
}

/// Opens, closes and updates the participant's window as the panels' data say.
void look_after(std::optional<ParticipantWindow>& participant, App& app, const gpu::Device& device) {
  if (participant) {
    std::vector<WindowEvent> events;
    participant->take(events);
    for (const WindowEvent& event : events)
      app.handle_participant(event);
    if (participant->closing()) app.try_participant(false);
  }
  try {
    const PanelData::ParticipantWindowState& view = app.data().participant;
    if (view.open && !participant) participant.emplace(device, view.monitor);
    if (!view.open) participant.reset();
    if (participant) app.participant().fills(participant->show(app));
  } catch (const Error& error) {
    if (device.lost()) throw;
    app.participant().failed(error.what());
    participant.reset();
  }
}

/// Draws again what the window shows, for a film.
class Filming {
 public:
  Filming(const gpu::Device& device, const std::string& folder) : device_(&device), film_(folder) {}
  void add(DrawnPicture& drawn, const App::Frame& frame, const Size& size, double ratio,
           const std::function<void()>& pause) {
    if (!film_.wanted()) return;
    if (!offscreen_ || offscreen_->width() != size.width || offscreen_->height() != size.height)
      offscreen_ = std::make_unique<Offscreen>(*device_, size.width, size.height, ratio);
    offscreen_->draw(drawn, frame.views, frame.sheet, pause);
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
  Script script(options);
  if (const auto settings = preferences_file()) add_own_file(*settings);  // before an output can be declared
  const Outputs outputs(outputs_of(options, script, kinds));
  refuse_outputs_as_inputs(options);
  const std::filesystem::path settings = preferences_file().value_or("");
  const bool sized = options.given.contains("--size");
  // First, because nothing else makes sense without a display.
  Window window({.width = size.width,
                 .height = size.height,
                 .in_points = !sized,
                 .before = sized || settings.empty() ? std::nullopt : remembered_window(settings)},
                "palpa");
  const Clock::time_point begin = Clock::now();
  const auto now = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  Stopper stopper(options, Window::wake);
  DrawingThreads threads;
  App app(options, size,
          {.kinds = kinds,
           .stop = &stopper.flag(),
           .wake = Window::wake,
           .copy = [&](const std::string& text) { window.set_clipboard(text); },
           .paste = [&] { return window.clipboard(); },
           .goes_live =
               [&] {
                 stopper.begin();
                 threads.give_way();
               },
           .panels = !options.no_panels || options.is_live(),  // the strip with the array's state stays
           .ratio = window.pixel_ratio(),
           .settings = settings});
  // At this point, the threads of a live run have begun, but those of the picture have not.
  if (options.is_live()) threads.give_way();
  threads.expect();
  gpu::DeviceOptions device_options = setup::device_options(options.common);
  device_options.window_extensions = window.extensions();
  const gpu::Device device(device_options);
  threads.have_begun();
  const WindowSurface surface(device, window);
  DrawnPicture drawn(device);  // outlives the frames that draw it: the presenter's end waits for them
  Presenter presenter(device, surface.get());
  Filming filming(device, options.video);
  app.use_font(system_font());
  app.tell_monitors(Window::monitors());
  std::optional<ParticipantWindow> participant;
  std::vector<WindowEvent> events;
  Rest rest;
  PicturesDrawn pictures;
  std::string title;
  double last_drawn_s = -1;
  PictureSteps pieces(
      [&](double work_s, double most_s) { return app.session() ? app.session()->let_run(work_s, most_s) : 0.0; });
  const SilentEnd silent_end(stopper.flag());

  // Draws only when something has changed, so an idle window costs nothing.
  while (!window.closing() && !app.quitting() && !(options.frames && pictures.ms.count() >= *options.frames)) {
    const Size pixels = pixels_of(window);
    const bool visible = pixels.width > 0 && pixels.height > 0;
    double timeout = -1;
    if (const std::optional<double> next = app.next_s()) timeout = std::max(*next - now(), 1e-3);
    if (const std::optional<double> again = rest.again_s(); visible && again) {
      const double until = std::max(*again - now(), 1e-3);
      timeout = timeout < 0 ? until : std::min(timeout, until);
    }
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
    if (options.frames && pictures.ms.count() > 0) app.go_on();
    app.advance(now(), pixels);
    look_after(participant, app, device);
    if (const std::string now_shown = app.title(); now_shown != title)
      window.set_title((title = now_shown).empty() ? "palpa" : "palpa: " + title);
    const bool asked = options.frames || script.busy(), changed = app.dirty() || asked;
    const bool rests = rest.again_s() && now() >= *rest.again_s();
    if (!visible || !(changed || rests)) continue;
    if (now() < last_drawn_s + shortest_s(app) && !asked) continue;
    const double started_s = now(), ratio = options.pixel_ratio.value_or(window.pixel_ratio());
    // The run may compute on the processor that draws the pictures, so they take turns.
    std::function<void()> pause;
    if (app.data().content.live && presenter.on_processor()) {
      pieces.begin();
      pause = [&] { pieces.pause(); };
      pause();
    }
    if (app.stale()) presenter.finish();
    app.update(drawn);
    if (pause) pause();
    const App::Frame frame = app.render(pixels, ratio, started_s);
    const FinePictures wanted = app.data().state.fine;
    const Fineness fineness = rest.next(wanted, presenter.slow(), changed, started_s);
    // Later pictures in motion are quick ones. They must not wait for a driver that compiles.
    if (pictures.ms.count() == 0 && wanted == FinePictures::automatic && presenter.slow())
      presenter.expect(Fineness::quick);
    const bool shown =
        presenter.draw({pixels.width, pixels.height}, drawn, frame.views, ratio, frame.sheet, fineness, pause);
    const double waited_s = pause ? pieces.end() : 0;
    last_drawn_s = now();
    const double took_s = last_drawn_s - started_s - waited_s;
    app.drew(took_s);
    if (!shown) {
      app.handle({}, pixels);  // draw again
      continue;
    }
    rest.drew(wanted, fineness, last_drawn_s);
    if (!changed) continue;  // the same picture, but finer
    pictures.ms.add(took_s * 1e3);
    pictures.size = pixels;
    script.drew();
    filming.add(drawn, frame, pixels, ratio, pause);
  }
  if (const auto place = window.place(); place && !sized) app.window_is_at(*place);
  stopper.end(app);
  report_window(options, outputs, pictures);
  report_run(options, outputs, app.session());
}

}  // namespace palpa::viewer
