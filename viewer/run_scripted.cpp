#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "session/give_way.hpp"
#include "setup/touch_run.hpp"
#include "viewer/app.hpp"
#include "viewer/film.hpp"
#include "viewer/offscreen.hpp"
#include "viewer/run.hpp"
#include "viewer/script.hpp"
#include "viewer/stopper.hpp"

namespace palpa::viewer {
namespace {

using Clock = std::chrono::steady_clock;

/// Draws wherever its size and time are at the moment.
class Stage {
 public:
  Stage(const ViewerOptions& options, const gpu::Device& device)
      : device_(&device),
        ratio_(options.pixel_ratio.value_or(1)),
        size_(picture_size(options)),
        drawn_(device),
        film_(options.video) {
    resize(size_);
  }
  void resize(const Size& size) {
    size_ = size;
    offscreen_ = std::make_unique<Offscreen>(*device_, size.width, size.height, ratio_);
  }
  const Size& size() const { return size_; }
  void draw(App& app, double now_s) {
    setup::Stopwatch watch;
    app.update(drawn_);
    const App::Frame frame = app.render(size_, ratio_, now_s);
    offscreen_->draw(drawn_, frame.views, frame.sheet);
    times_.push_back(watch.lap_ms());
    app.drew(times_.back() / 1e3);
    if (film_.wanted()) film_.add(pixels());  // files are no part of a frame
  }
  Pixels pixels() const { return offscreen_->pixels(); }
  std::uint32_t frames() const { return static_cast<std::uint32_t>(times_.size()); }
  double median_ms() const {
    if (times_.empty()) return 0;
    std::vector<double> times = times_;
    const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
    std::nth_element(times.begin(), middle, times.end());
    return *middle;
  }

 private:
  const gpu::Device* device_;
  double ratio_;
  Size size_;
  DrawnPicture drawn_;
  std::unique_ptr<Offscreen> offscreen_;
  Film film_;
  std::vector<double> times_;
};

/// A live run's frames as they come; until the end of the run where there are not so many.
void draw_frames(App& app, Stage& stage, std::uint32_t frames, const std::function<double()>& now) {
  while (stage.frames() < frames && !app.quitting()) {
    const LiveState state = app.desk().live_state;
    app.advance(now(), stage.size());
    if (app.showed_frame()) {
      stage.draw(app, now());
    } else if (state == LiveState::failed || state == LiveState::ended) {
      return;
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
}

void play(App& app, Stage& stage, Script script, const std::function<double()>& now) {
  while (script.busy() && !app.quitting()) {
    script.play(now(), [&](const Interaction& step) {
      if (step.kind == Interaction::Kind::event) app.handle(step.event, stage.size());
      if (step.kind == Interaction::Kind::resize) stage.resize({step.width, step.height});
      if (step.kind == Interaction::Kind::shot) write_png(step.file, stage.pixels());
    });
    app.advance(now(), stage.size());
    stage.draw(app, now());
    script.drew();
  }
  // A run that is still loading may yet fail, and the last picture shows it.
  bool waited = false;
  for (; app.loading() && !app.quitting(); waited = true) {
    app.advance(now(), stage.size());
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (!waited || app.quitting()) return;
  app.advance(now(), stage.size());
  stage.draw(app, now());
}

}  // namespace

void run_scripted(const ViewerOptions& options, const LiveSession::Kinds& kinds) {
  const Outputs outputs({{"--json", options.common.json},
                         {"--screenshot", options.screenshot},
                         {"--video", options.video, Output::Kind::folder}});
  refuse_output_as_input(std::filesystem::path(options.reference));
  const Clock::time_point begin = Clock::now();
  const auto now = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  Script script(options);
  Stopper stopper(options);
  App app(options, picture_size(options),
          {.kinds = kinds, .stop = &stopper.flag(), .goes_live = [&] { stopper.begin(); }, .panels = options.panels});
  if (options.is_live()) session::give_way();
  const gpu::Device device(setup::device_options(options.common));
  Stage stage(options, device);
  const SilentEnd silent_end(stopper.flag());
  if (options.interact.empty()) {
    draw_frames(app, stage, options.frames.value_or(1), now);
  } else {
    play(app, stage, std::move(script), now);
  }
  stopper.end(app);
  app.rethrow();
  report_picture(options, outputs, stage.pixels(), stage.frames(), stage.median_ms());
}

}  // namespace palpa::viewer
