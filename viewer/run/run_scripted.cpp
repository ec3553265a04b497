#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/log.hpp"
#include "setup/sessions/touch_run.hpp"
#include "viewer/app/app.hpp"
#include "viewer/panels/file_font.hpp"
#include "viewer/render/offscreen.hpp"
#include "viewer/run/drawing_threads.hpp"
#include "viewer/run/film.hpp"
#include "viewer/run/report.hpp"
#include "viewer/run/run.hpp"
#include "viewer/run/script.hpp"
#include "viewer/run/stopper.hpp"
#include "viewer/run/viewer_files.hpp"

namespace palpa::viewer {
namespace {

using Clock = std::chrono::steady_clock;

/// Draws with the current size at the current time.
class Easel {
 public:
  Easel(const ViewerOptions& options, const gpu::Device& device)
      : device_(&device),
        ratio_(options.pixel_ratio.value_or(1)),
        fineness_(fineness_without_window(options)),
        size_(picture_size(options)),
        drawn_(device),
        film_(options.video) {
    resize(size_);
  }
  void resize(const Size& size) {
    size_ = size;
    offscreen_ = std::make_unique<Offscreen>(*device_, size.width, size.height, ratio_, fineness_);
  }
  const Size& size() const { return size_; }
  void draw(App& app, double now_s) {
    setup::Stopwatch watch;
    app.update(drawn_);
    const App::Frame frame = app.render(size_, ratio_, now_s);
    offscreen_->draw(drawn_, frame.views, frame.sheet);
    const double ms = watch.lap_ms();
    drew_.ms.add(ms);
    drew_.size = size_;
    app.drew(ms / 1e3);
    if (film_.wanted()) film_.add(pixels());  // writing files does not count as part of a frame
  }
  Pixels pixels() const { return offscreen_->pixels(); }
  const PicturesDrawn& drew() const { return drew_; }

 private:
  const gpu::Device* device_;
  double ratio_;
  Fineness fineness_;
  Size size_;
  DrawnPicture drawn_;
  std::unique_ptr<Offscreen> offscreen_;
  Film film_;
  PicturesDrawn drew_;
};

/// Waits for the next frame of a live run. Returns false if there is none until the run ends, or until `until_s`.
bool next_frame(App& app, const Size& size, const std::function<double()>& now, double until_s) {
  while (!app.quitting() && now() < until_s) {
    const LiveState state = app.data().content.run.state;
    app.advance(now(), size);
    if (app.showed_frame()) return true;
    if (state == LiveState::failed || state == LiveState::ended) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

/// A finger has just come: waits until its contacts grow no more, but at most 90 frames or 5 s. If it leaves meanwhile,
/// the picture is that of the next touch, from its beginning on.
void settled_touch(App& app, const Size& size, const std::function<double()>& now) {
  constexpr double most_s = 5;
  constexpr int steady_frames = 4, most_frames = 90;
  const double until_s = now() + most_s;
  std::size_t most = app.picture().contacts.size();
  for (int steady = 0, n = 0; steady < steady_frames && n < most_frames && next_frame(app, size, now, until_s); ++n) {
    if (app.picture().fingers.empty()) {
      while (app.picture().fingers.empty() && next_frame(app, size, now, until_s)) {
      }
      return;
    }
    const std::size_t contacts = app.picture().contacts.size();
    steady = contacts > most ? 0 : steady + 1;
    most = std::max(most, contacts);
  }
}

/// Waits for a frame with a touch. If there is none within 5 s of the first frame, or until the end of the run, says
/// why. Some sources have no frame at all: they are waited for a while longer. Returns false if the run has failed, or
/// ended without a frame.
bool touching_frame(App& app, const Size& size, const std::function<double()>& now) {
  constexpr double longest_wait_s = 5, longest_start_s = 20;
  const auto wait = [&] {
    app.advance(now(), size);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  };
  while (app.beginning() && !app.quitting())
    wait();
  bool shown = next_frame(app, size, now, now() + longest_start_s);
  const double until_s = now() + longest_wait_s;
  while (shown && app.picture().fingers.empty()) {
    if (next_frame(app, size, now, until_s)) continue;
    const std::string& why = app.picture().untouched;
    log::warning(
        fmt::format("nothing touched while the picture waited, for up to 5 s{}{}; --frames 1 takes a run's "
                    "first picture",
                    why.empty() ? "" : ": ", why));
    return true;
  }
  if (shown) settled_touch(app, size, now);
  if (!shown && app.data().content.run.state == LiveState::running) {
    log::warning(fmt::format("no frame came within {:g} s: the picture shows none", longest_start_s));
    shown = true;
  }
  return shown;
}

/// Waits until the sound that the picture shows is computed. Meanwhile, the picture keeps its frame, and the run ends:
/// no array sounds for a picture.
void complete(App& app, const Size& size, const std::function<double()>& now) {
  if (!app.computes()) return;
  app.hold();
  for (app.advance(now(), size); app.computes() && !app.quitting(); app.advance(now(), size)) {
    app.session()->all_off();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

/// Draws a live run's frames as they come, until the end of the run if there are fewer than --frames. The last one
/// waits for its sound, and with --at-touch or without --frames for a touch.
void draw_frames(App& app, Easel& easel, const ViewerOptions& options, const std::function<double()>& now) {
  const std::uint32_t frames = options.frames.value_or(1);
  const bool waits = options.at_touch || !options.frames;
  while (easel.drew().ms.count() < frames && !app.quitting()) {
    const bool last = easel.drew().ms.count() + 1 == frames;
    const bool shown = last && waits ? touching_frame(app, easel.size(), now)
                                     : next_frame(app, easel.size(), now, std::numeric_limits<double>::infinity());
    if (!shown) return;
    if (last) complete(app, easel.size(), now);
    if (last && options.video.empty()) app.leave_room_for_close_up(easel.size());
    easel.draw(app, now());
  }
}

/// Pictures for files. While anything is being loaded, on any thread, a file may turn out to be an input. Pictures are
/// therefore written after loading.
class Shots {
 public:
  void take(const std::string& file, Pixels pixels) { waiting_.emplace_back(file, std::move(pixels)); }
  void write(const App& app) {
    if (app.beginning()) return;
    for (const auto& [file, pixels] : waiting_)
      write_png(file, pixels);
    waiting_.clear();
  }
  /// Throws if a picture could not be written.
  void expect_written() const {
    if (waiting_.empty()) return;
    throw failure(fmt::format("{}: is not written, because the script ended while something was still loading",
                              waiting_.front().first));
  }

 private:
  std::vector<std::pair<std::string, Pixels>> waiting_;
};

void play(App& app, Easel& easel, Script script, const std::function<double()>& now) {
  const auto is_behind = [&] { return app.beginning() || app.awaits_frame(); };
  bool behind = is_behind();  // the last picture is behind what was asked for
  Shots shots;
  while (script.busy() && !app.quitting()) {
    script.play(now(), [&](const Interaction& step) {
      if (step.kind == Interaction::Kind::event) app.handle(step.event, easel.size());
      if (step.kind == Interaction::Kind::resize) easel.resize({step.width, step.height});
      if (step.kind == Interaction::Kind::shot) shots.take(step.file, easel.pixels());
    });
    behind = is_behind();
    app.advance(now(), easel.size());
    shots.write(app);  // it is known now whether anything is loaded
    easel.draw(app, now());
    script.drew();
  }
  // A run that is still loading may still fail. The last picture shows that run, and what was dropped.
  const auto wait = [&] {
    app.advance(now(), easel.size());
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  };
  for (; app.beginning() && !app.quitting(); behind = true)
    wait();
  shots.write(app);
  shots.expect_written();
  // On a busy machine, the first frame of this run comes late. Some sources have no frame at all.
  constexpr double longest_wait_s = 5;
  const double until_s = now() + longest_wait_s;
  for (; app.awaits_frame() && !app.quitting() && now() < until_s; behind = true)
    wait();
  if (!behind || app.quitting()) return;
  app.advance(now(), easel.size());
  easel.draw(app, now());
}

}  // namespace

void run_scripted(const ViewerOptions& options, const LiveSession::Kinds& kinds, TouchGuide* guide) {
  Script script(options);
  const Outputs outputs(outputs_of(options, script, kinds));
  refuse_outputs_as_inputs(options);
  const Clock::time_point begin = Clock::now();
  const auto now = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  Stopper stopper(options);
  DrawingThreads threads;
  App app(options, picture_size(options),
          {.kinds = kinds,
           .guide = guide,
           .stop = &stopper.flag(),
           .goes_live =
               [&] {
                 stopper.begin();
                 threads.give_way();
               },
           .panels = options.panels,
           .hands = !options.interact.empty()});
  if (options.panels) app.use_font(system_font());
  if (options.is_live()) threads.give_way();
  threads.expect();
  const gpu::Device device(setup::device_options(options.common));
  threads.have_begun();
  Easel easel(options, device);
  const SilentEnd silent_end(stopper.flag());
  if (options.interact.empty()) {
    draw_frames(app, easel, options, now);
  } else {
    play(app, easel, std::move(script), now);
  }
  stopper.end(app);
  report_picture(options, outputs, easel.pixels(), easel.drew());
  report_run(options, outputs, app.session());
}

}  // namespace palpa::viewer
