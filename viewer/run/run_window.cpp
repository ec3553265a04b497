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

/// Draws what the application shows into its window.
class WindowPictures {
 public:
  WindowPictures(const ViewerOptions& options, Script& script, Window& window, App& app, const gpu::Device& device,
                 Clock::time_point begin)
      : options_(&options),
        script_(&script),
        window_(&window),
        app_(&app),
        device_(&device),
        begin_(begin),
        surface_(device, window),
        drawn_(device),
        presenter_(device, surface_.get()),
        filming_(device, options.video) {}

  bool goes_on() const {
    const bool all_drawn = options_->frames && pictures_.ms.count() >= *options_->frames;
    return !window_->closing() && !app_->quitting() && !all_drawn;
  }

  /// Waits for what happens next, and draws only if something has changed, so an idle window costs nothing.
  void turn() {
    const Size pixels = pixels_of(*window_);
    const bool visible = pixels.width > 0 && pixels.height > 0;
    take_events(wait_s(visible), pixels);
    const bool asked = is_asked(), changed = app_->dirty() || asked;
    if (visible && is_due(asked, changed)) draw(pixels, changed);
  }

  const PicturesDrawn& pictures() const { return pictures_; }

 private:
  double now() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }
  double next_picture_s() const { return last_drawn_s_ + shortest_s(*app_); }
  /// Whether pictures are asked for even if nothing has changed.
  bool is_asked() const { return options_->frames || script_->busy(); }

  /// How long to wait for events; negative: until one comes.
  double wait_s(bool visible) const {
    if (is_asked()) return 0;
    if (visible && app_->dirty()) return std::max(next_picture_s() - now(), 0.0);
    double wait = -1;
    if (const std::optional<double> next = app_->next_s()) wait = std::max(*next - now(), 1e-3);
    if (const std::optional<double> again = rest_.again_s(); visible && again) {
      const double until = std::max(*again - now(), 1e-3);
      wait = wait < 0 ? until : std::min(wait, until);
    }
    return wait;
  }

  void take_events(double wait_s, const Size& pixels) {
    events_.clear();
    window_->wait(wait_s, events_);
    for (const WindowEvent& event : events_)
      app_->handle(event, pixels);
    script_->play(now(), [&](const Interaction& step) {
      if (step.kind == Interaction::Kind::resize) window_->resize(step.width, step.height);
      if (step.kind == Interaction::Kind::event) app_->handle(step.event, pixels);
    });
    if (options_->frames && pictures_.ms.count() > 0) app_->go_on();
    app_->advance(now(), pixels);
    look_after(participant_, *app_, *device_);
    if (const std::string now_shown = app_->title(); now_shown != title_)
      window_->set_title((title_ = now_shown).empty() ? "palpa" : "palpa: " + title_);
  }

  bool is_due(bool asked, bool changed) const {
    const bool rests = rest_.again_s() && now() >= *rest_.again_s();
    return (changed || rests) && (asked || now() >= next_picture_s());
  }

  void draw(const Size& pixels, bool changed) {
    const double started_s = now(), ratio = options_->pixel_ratio.value_or(window_->pixel_ratio());
    // The run may compute on the processor that draws the pictures, so they take turns.
    std::function<void()> pause;
    if (app_->data().content.live && presenter_.on_processor()) {
      pieces_.begin();
      pause = [&] { pieces_.pause(); };
      pause();
    }
    if (app_->stale()) presenter_.finish();
    app_->update(drawn_);
    if (pause) pause();
    const App::Frame frame = app_->render(pixels, ratio, started_s);
    const FinePictures wanted = app_->data().state.fine;
    const Fineness fineness = rest_.next(wanted, presenter_.slow(), changed, started_s);
    // Later pictures in motion are quick ones. They must not wait for a driver that compiles.
    if (pictures_.ms.count() == 0 && wanted == FinePictures::automatic && presenter_.slow())
      presenter_.expect(Fineness::quick);
    const bool shown =
        presenter_.draw({pixels.width, pixels.height}, drawn_, frame.views, ratio, frame.sheet, fineness, pause);
    const double waited_s = pause ? pieces_.end() : 0;
    last_drawn_s_ = now();
    const double took_s = last_drawn_s_ - started_s - waited_s;
    app_->drew(took_s);
    if (!shown) return app_->handle({}, pixels);  // draw again
    rest_.drew(wanted, fineness, last_drawn_s_);
    if (!changed) return;  // the same picture, but finer
    pictures_.ms.add(took_s * 1e3);
    pictures_.size = pixels;
    script_->drew();
    filming_.add(drawn_, frame, pixels, ratio, pause);
  }

  const ViewerOptions* options_;
  Script* script_;
  Window* window_;
  App* app_;
  const gpu::Device* device_;
  Clock::time_point begin_;
  const WindowSurface surface_;
  DrawnPicture drawn_;  // outlives the frames that draw it: the presenter's end waits for them
  Presenter presenter_;
  Filming filming_;
  std::optional<ParticipantWindow> participant_;
  std::vector<WindowEvent> events_;
  Rest rest_;
  PicturesDrawn pictures_;
  std::string title_;
  double last_drawn_s_ = -1;
  PictureSteps pieces_{[this](double work_s, double most_s) {
    return app_->session() ? app_->session()->let_run(work_s, most_s) : 0.0;
  }};
};

}  // namespace

void run_window(const ViewerOptions& options, const LiveSession::Kinds& kinds, TouchGuide* guide) {
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
  Stopper stopper(options, Window::wake);
  DrawingThreads threads;
  App app(options, size,
          {.kinds = kinds,
           .guide = guide,
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
  WindowPictures pictures(options, script, window, app, device, begin);
  app.use_font(system_font());
  app.tell_monitors(Window::monitors());
  const SilentEnd silent_end(stopper.flag());
  while (pictures.goes_on())
    pictures.turn();
  if (const auto place = window.place(); place && !sized) app.window_is_at(*place);
  stopper.end(app);
  report_window(options, outputs, pictures.pictures());
  report_run(options, outputs, app.session());
}

}  // namespace palpa::viewer
