#include "viewer/app/app.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "setup/interrupt.hpp"
#include "viewer/app/pick.hpp"
#include "viewer/live/live_line.hpp"
#include "viewer/live/live_picture.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/stroke_font.hpp"

namespace palpa::viewer {
namespace {

constexpr double toast_s = 6;
constexpr double tend_s = 1;  ///< how often a live run is looked after at least, see LiveSession::look

bool same_marks(const ViewState& a, const ViewState& b) {
  return a.layers == b.layers && a.explode == b.explode && a.slice == b.slice && a.slice_handles == b.slice_handles &&
         a.chosen == b.chosen && a.picked == b.picked && a.dark == b.dark;
}

/// Keys that go on while they are held down; of all others that would be a switch thrown to and fro.
bool goes_on(const WindowEvent& event) {
  constexpr std::string_view characters = ",.-+=z";
  return event.key == Key::left || event.key == Key::right ||
         characters.find(static_cast<char>(event.key)) != std::string_view::npos;
}

}  // namespace

App::App(const ViewerOptions& options, const Size& size, Surroundings around)
    : options_(options), around_(std::move(around)), sounds_(setup::device_options(options.common)) {
  desk_.state = first_state(options_);
  desk_.given = options_.given;
  desk_.live = options_.is_live();
  desk_.panels = around_.panels;
  recall();
  loader_ = std::make_unique<Loader>(around_.wake);
  around_.kinds.sources.push_back(transport_.source());
  around_.kinds.sources.push_back(finger_.source());
  if (around_.panels) ui_ = std::make_unique<Ui>(desk_.state.dark, around_.copy, around_.paste);
  if (desk_.live) {
    start();
  } else {
    show_ = std::make_unique<Show>(options_);
    sounds_.set_finger(finger_mesh(options_.skin, {}));
    desk_.state.time.playing = show_->changes();
  }
  if (options_.participant) open_participant(true);
  ratio_ = options_.pixel_ratio.value_or(1);
  desk_.state.viewpoint = first_viewpoint(options_, picture(), desk_.state, beside_panels(size));
}

App::~App() {
  if (live_) live_->all_off();  // before a disk is waited for
  remember();
}

/// What the command line says goes first.
void App::recall() {
  if (around_.settings.empty()) return;
  try {
    recalled_ = load_settings(around_.settings);
  } catch (const Error& error) {
    say(log::Level::warning, error.what(), 0);
  }
  desk_.state.layers = first_state(options_, recalled_.layers).layers;
  desk_.state.dark = desk_.state.dark || recalled_.dark;
  if (!options_.given.contains("--fine")) desk_.state.fine = recalled_.fine;
  desk_.state.time.slots_per_s = recalled_.slots_per_s;
  desk_.panels = desk_.panels && recalled_.panels;
  began_ = settings();
}

Settings App::settings() const {
  return {desk_.state.layers, desk_.state.dark, desk_.panels, desk_.state.fine, desk_.state.time.slots_per_s};
}

void App::remember() {
  if (around_.settings.empty()) return;
  const Settings now = to_remember(recalled_, began_, settings());
  if (now == recalled_) return;
  recalled_ = now;  // asked once: where it cannot be written it is told once
  try {
    save_settings(around_.settings, now);
  } catch (const std::exception& error) {
    log::warning(error.what());
  }
}

void App::start() {
  scene_.reset();
  *around_.stop = false;
  if (setup::Interrupt::signalled()) {  // asked after the flag was cleared: it may have come just before
    *around_.stop = quitting_ = true;
    return;
  }
  running_ = desk_.given;
  told_ = false;
  setup::LiveOptions options = live_options(desk_.given);
  sounds_.set_finger(finger_mesh(options_.skin, options.source));
  for (const std::string& line : outputs_.name(options, setup::with_builtin(around_.kinds.links)))
    say(log::Level::info, line, now_s_);
  starter_.run([&] {
    live_ = std::make_unique<LiveSession>(
        std::move(options), around_.kinds, *around_.stop, around_.wake ? around_.wake : [] {});
  });
  place_anew();
  desk_.live_state = LiveState::loading;
}

void App::say(log::Level level, const std::string& line, double now_s) {
  dirty_ = true;
  if (const auto same = std::ranges::find(desk_.toasts, line, &Toast::text); same != desk_.toasts.end()) {
    same->until_s = now_s + toast_s;  // what is read for a second time warns of the same
    return;
  }
  if (desk_.toasts.size() >= 4) desk_.toasts.pop_front();
  desk_.toasts.push_back({line, level, now_s + toast_s});
  desk_.log.push_back({level, line});
}

bool App::changing() const {
  return std::ranges::any_of(picture().fingers, [](const FingerMarks& finger) { return finger.foci.size() > 1; });
}

Size App::beside_panels(const Size& size) const {
  if (!ui_ || !desk_.panels) return size;
  const double panels = panels_width(size.width, text_height * ratio_);
  return {std::max(size.width - static_cast<std::uint32_t>(panels), 1U), size.height};
}

void App::handle(const WindowEvent& event, const Size& whole_size) {
  const Size size = beside_panels(whole_size);
  if (event.kind == WindowEvent::Kind::damage) dirty_ = true;
  if (event.kind == WindowEvent::Kind::drop) return open(event.text, now_s_);
  const bool press = event.kind == WindowEvent::Kind::press;
  const auto here = [&](const Area& area) { return area.holds(event.x, event.y); };
  // Before any picture, and whatever lies over the button.
  if (press && desk_.places.all_off && here(*desk_.places.all_off)) switch_off();
  const bool taken =
      ui_ && ui_->take(event, press && event.button == Button::left && std::ranges::any_of(desk_.places.texts, here));
  if (ui_) dirty_ = true;
  if (taken && event.kind != WindowEvent::Kind::release) return;
  if (event.repeat && !goes_on(event)) return;
  // What is held is held until it is let go of, be it while a run begins anew and no handles are there.
  const bool handles = desk_.state.slice_handles && desk_.state.layers.shows(Layer::slice);
  if ((handles || slice_hand_.dragging()) && slice_hand_.handle(event, sight(size), desk_.state.slice)) {
    slice_placed_ = dirty_ = true;
    return;
  }
  if (desk_.live) {
    const bool placed = placing_.handle(event, sight(size));
    place();
    if (placed) return void(dirty_ = true);
  }
  if (event.kind == WindowEvent::Kind::key && event.down) key(event);
  if (event.kind == WindowEvent::Kind::press && event.ctrl && event.button == Button::left)
    return read_at(event.x, event.y, size);
  const Box home = home_of(options_, picture(), desk_.state);
  if (controls_.handle(event, desk_.state.viewpoint, home, size.width, size.height) == Reply::redraw) dirty_ = true;
}

void App::key(const WindowEvent& event) {
  dirty_ = true;
  switch (event.key) {
    case Key::space:
      if (desk_.playback) {
        Playback play = desk_.asked.play.value_or(*desk_.playback);
        play.playing = !play.playing;
        desk_.asked.play = play;
      } else {
        desk_.state.time.playing = !desk_.state.time.playing;
      }
      return;
    case Key::left:
      desk_.asked.step -= 1;
      return;
    case Key::right:
      desk_.asked.step += 1;
      return;
    case Key::tab:
      desk_.panels = !desk_.panels;
      return;
    case Key::escape:
      if (desk_.opening) return cancel_opening();
      desk_.help || desk_.reading ? void() : void(quitting_ = true);
      desk_.help = false;
      desk_.reading.reset();
      desk_.state.picked.reset();
      return;
    default:
      break;
  }
  if (participant_key(event.key)) return;
  switch (static_cast<char>(event.key)) {
    case 'p':
      desk_.asked.participant = !desk_.participant.open;
      break;
    case 'q':
      quitting_ = true;
      break;
    case 'h':
      desk_.help = !desk_.help;
      break;
    case 'o':
      switch_off();
      break;
    case 'r':
      desk_.asked.record = true;
      break;
    case 'c':
      if (desk_.live) desk_.asked.copy = run_command(desk_.given, desk_.told);
      break;
    case ',':
      desk_.asked.slots -= 1;
      break;
    case '.':
      desk_.asked.slots += 1;
      break;
    case '-':
      desk_.state.time.slots_per_s = std::max(desk_.state.time.slots_per_s / 2, 0.5);
      break;
    case '+':
    case '=':
      desk_.state.time.slots_per_s = std::min(desk_.state.time.slots_per_s * 2, 667.0);
      break;
    default:
      break;
  }
}

void App::read_at(double x, double y, const Size& size) {
  desk_.reading = pick(picture(), desk_.state, x, y, size.width, size.height, ratio_);
  desk_.state.picked = desk_.reading ? std::optional(desk_.reading->at) : std::nullopt;
  dirty_ = true;
}

void App::advance(double now_s, const Size& whole_size) {
  const Size size = beside_panels(whole_size);
  now_s_ = now_s;
  for (const log::Line& line : tail_.take()) {
    if (line.level <= log::Level::warning) {
      say(line.level, line.text, now_s);
    } else {
      desk_.log.push_back(line);
    }
  }
  while (desk_.log.size() > log::Tail::most)
    desk_.log.pop_front();
  advance_opening(now_s);
  do_asked(now_s, size);
  if (live_) advance_live(now_s, size);
  tell_doing();
  if (now_s >= next_reload_s_) reload(now_s);
  advance_slots(now_s);
  listen(now_s);
  if (std::ranges::any_of(desk_.toasts, [&](const Toast& toast) { return now_s >= toast.until_s; })) dirty_ = true;
  if (!same_marks(desk_.state, drawn_state_)) {
    if (desk_.state.explode != drawn_state_.explode) ++surfaces_version_;
    stale_marks_ = dirty_ = true;
  }
}

/// What is being loaded, by a run that begins or beside what is shown.
void App::tell_doing() {
  const bool loads = desk_.opening || (desk_.live && desk_.live_state == LiveState::loading);
  const std::optional<Doing> doing = loads ? palpa::doing() : std::nullopt;
  desk_.doing = doing ? doing->what : std::string();
  desk_.done = doing && doing->total > 0
                   ? std::optional(static_cast<double>(doing->done) / static_cast<double>(doing->total))
                   : std::nullopt;
  if (loads) dirty_ = true;
}

void App::do_asked(double now_s, const Size& size) {
  const Desk::Asked asked = std::exchange(desk_.asked, {});
  if (desk_.live && ui_) do_placing(now_s);
  const double aspect = static_cast<double>(std::max(size.width, 1u)) / std::max(size.height, 1u);
  if (asked.all_off) switch_off();
  if (asked.plane) turn_slice(*asked.plane);
  if (asked.view) look(desk_.state.viewpoint, *asked.view);
  if (asked.frame || asked.view) fit(desk_.state.viewpoint, home_of(options_, picture(), desk_.state), aspect);
  if (!asked.copy.empty()) {
    if (around_.copy) around_.copy(asked.copy);
    say(log::Level::info, asked.copy, now_s);
    if (placing_.moved()) say(log::Level::warning, "what was moved is not in it: save the scene, then copy", now_s);
  }
  if (asked.play) transport_.play(*asked.play);
  if (asked.go_to) transport_.go_to(*asked.go_to);
  if (asked.participant) try_participant(*asked.participant);
  if (asked.cancel) cancel_opening();
  if (asked.record) record(now_s);
  if (asked.step != 0) transport_.step(asked.step);
  if (asked.slots != 0) {
    SlotTime& time = desk_.state.time;
    time.playing = false;
    const auto back = static_cast<std::uint64_t>(std::max(-asked.slots, 0));
    time.slot =
        asked.slots > 0 ? time.slot + static_cast<std::uint64_t>(asked.slots) : time.slot - std::min(time.slot, back);
    show_slot_now();
  }
  if (asked.start || asked.view || asked.frame) dirty_ = true;
  if (asked.start && !asked.all_off) off_ = false;
  const bool anew = std::exchange(anew_, false);
  if (desk_.live && (asked.start || anew || desk_.given != running_)) touch_options(now_s);
  if (desk_.told != copied_) touch_told(now_s);
}

/// Silence at once, and nothing begins until somebody starts it.
void App::switch_off() {
  if (!live_) return;
  live_->all_off();
  restart_ = false;
  desk_.asked.start = false;
  if (ui_) ui_->forget();  // a click on Start that no picture has shown yet
  if (!std::exchange(off_, true)) say(log::Level::info, "all off", now_s_);
}

/// Options that changed, or a run that is to begin anew: the one that runs ends first. After all off nothing begins
/// until somebody starts it.
void App::touch_options(double now_s) {
  try {
    live_options(desk_.given);
  } catch (const Error& error) {
    say(log::Level::error, error.what(), now_s);
    desk_.given = running_;  // what runs stays
    return;
  }
  running_ = desk_.given;
  if (off_) return;
  if (live_ && !live_->over()) live_->all_off();
  restart_ = true;
}

/// What only the copied command has: nothing that runs changes.
void App::touch_told(double now_s) {
  try {
    check_told(desk_.told);
    copied_ = desk_.told;
  } catch (const Error& error) {
    say(log::Level::error, error.what(), now_s);
    desk_.told = copied_;
  }
}

void App::advance_live(double now_s, const Size& size) {
  if (setup::Interrupt::signalled()) quitting_ = true;
  live_->look();
  const LinkWatch& link = live_->link();
  const bool sounding = link.sounding;
  if (desk_.sounding != sounding || desk_.live_state != live_->state()) dirty_ = true;
  desk_.sounding = sounding;
  desk_.link_open = link.open;
  desk_.drives = link.drives;
  desk_.silent_drives = link.silent;
  desk_.live_state = live_->state();
  desk_.playback = transport_.now();
  tell_recording(now_s);

  // Before the scene is asked for: a snapshot's scene is there by then.
  const bool fresh = live_->take();
  const bool seen = live_->take_seen();
  if (auto scene = live_->scene(); scene && scene != scene_) {
    scene_ = std::move(scene);
    live_picture_ = scene_->picture;
    sounds_.forget();
    surfaces_changed();
    begin_placing();
    if (!std::exchange(framed_, true)) desk_.state.viewpoint = first_viewpoint(options_, picture(), desk_.state, size);
  }
  fresh_ = fresh_ || fresh;
  if (scene_ && (fresh || seen)) {
    show_live(live_picture_, *scene_, live_->snapshot(), live_->seen(), desk_.state.layers.shows(Layer::depth));
    desk_.numbers = live_->snapshot().numbers;
    show_slot_now();
  }
  if (!live_->over()) return;
  if (!std::exchange(told_, true)) {
    dirty_ = true;
    if (const std::string fault = live_->fault(); !fault.empty()) say(log::Level::error, fault, now_s);
  }
  if (!std::exchange(restart_, false) || quitting_) return;
  tell_recording(now_s);  // it ends with its run
  live_.reset();
  start();
}

void App::show_slot_now() {
  const std::uint64_t slot = desk_.state.time.slot;
  if (show_) {
    show_->go_to(slot);
  } else if (live_ && scene_) {
    show_live_slot(live_picture_, *scene_, live_->snapshot(), slot, slot_);
  }
  stale_marks_ = dirty_ = true;
}

void App::advance_slots(double now_s) {
  SlotTime& time = desk_.state.time;
  if (!time.playing || !changing()) {
    next_slot_s_ = now_s + 1 / time.slots_per_s;
    return;
  }
  if (now_s < next_slot_s_) return;
  const double late = std::clamp((now_s - next_slot_s_) * time.slots_per_s, 0.0, 1e4);
  time.slot += 1 + static_cast<std::uint64_t>(late);
  next_slot_s_ = now_s + 1 / time.slots_per_s;
  show_slot_now();
}

std::optional<double> App::next_s() const {
  std::optional<double> next;
  const auto sooner = [&](double at) { next = next ? std::min(*next, at) : at; };
  if (desk_.state.time.playing && changing()) sooner(next_slot_s_);
  for (const Toast& toast : desk_.toasts)
    sooner(toast.until_s);
  if (desk_.given.contains("--scene")) sooner(next_reload_s_);
  if (desk_.opening) sooner(now_s_ + 0.1);
  if (sounds_.busy()) sooner(now_s_ + 0.03);
  if (live_ && !told_) sooner(now_s_ + (desk_.live_state == LiveState::loading ? 0.1 : tend_s));
  return next;
}

void App::update(DrawnPicture& drawn) {
  if (stale_surfaces_) {
    drawn.update(picture(), desk_.state);
  } else if (stale_skin_) {
    drawn.update_skin(picture(), desk_.state);
  } else if (stale_marks_) {
    drawn.update_marks(picture(), desk_.state);
  }
  stale_surfaces_ = stale_skin_ = stale_marks_ = false;
  drawn_state_ = desk_.state;
}

App::Frame App::render(const Size& size, double ratio, double now_s) {
  Frame frame;
  ratio_ = ratio;
  if (ui_) {
    ui_->set_dark(desk_.state.dark);
    ui_->begin(size.width, size.height, ratio, now_s - last_render_s_);
    desk_.picture = &picture();
    show_placing(beside_panels(size));
    draw_panels(desk_, now_s);
    take_placing();
    frame.sheet = &ui_->end();
  }
  last_render_s_ = now_s;
  dirty_ = false;
  frame.views = views_from(desk_.state.viewpoint, options_, picture(), beside_panels(size), ratio);
  return frame;
}

bool App::finish(double patience_s) {
  constexpr double while_loading_s = 0.3;  // what loads looks at no flag
  remember();
  if (!live_) return true;
  live_->all_off();
  const auto begin = std::chrono::steady_clock::now();
  while (!live_->over()) {
    const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - begin;
    if (waited.count() > (loading() ? while_loading_s : patience_s)) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace palpa::viewer
