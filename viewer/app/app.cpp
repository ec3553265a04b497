#include "viewer/app/app.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <string_view>
#include <utility>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "viewer/app/own_files.hpp"
#include "viewer/app/pick.hpp"
#include "viewer/live/live_picture.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/stroke_font.hpp"

namespace palpa::viewer {
namespace {

constexpr double toast_s = 6;
constexpr double lull_s = 0.1;  ///< the strip notices silence this soon, even if no frame comes
constexpr double tend_s = 1;    ///< a live run is looked after at least this often, see LiveSession::look

/// Keys that repeat while they are held down. Any other key would switch something on and off again and again.
bool goes_on(const WindowEvent& event) {
  constexpr std::string_view characters = ",.-+=z";
  return event.key == Key::left || event.key == Key::right ||
         characters.find(static_cast<char>(event.key)) != std::string_view::npos;
}

/// The event with its place counted from the area's top left.
WindowEvent in_area(WindowEvent event, const Area& area) {
  event.x -= area.left;
  event.y -= area.top;
  return event;
}

/// The kinds that exist without this window, and those that the user controls in it.
LiveSession::Kinds with_hands(LiveSession::Kinds kinds, RecordingPlayer& recording, HeldFinger& finger) {
  kinds.sources.push_back(recording.source());
  kinds.sources.push_back(finger.source());
  return kinds;
}

}  // namespace

App::App(const ViewerOptions& options, const Size& size, Surroundings around)
    : options_(options),
      around_(std::move(around)),
      memory_(around_.settings),
      run_(with_hands(around_.kinds, player_, moved_.finger()), *around_.stop, around_.wake),
      opening_(around_.wake),
      sounds_(setup::device_options(options.common)) {
  slice_.asked = options_.slice;
  data_.state = first_state(options_);
  data_.edit = LiveEdit(options_.given);
  data_.live = options_.is_live();
  data_.panels = around_.panels && !options_.no_panels;
  recall();
  if (around_.panels) {
    ui_ = std::make_unique<Ui>(data_.state.dark, around_.copy, around_.paste);
    list_own_files(data_);
  }
  if (data_.live) {
    run_.start(data_.edit.options());
    begin_run();
  } else {
    show_ = std::make_unique<Show>(options_);
    sounds_.set_finger(finger_mesh(options_.skin, {}));
    data_.state.time.playing = show_->changes();
  }
  if (options_.participant) open_participant(true);
  ratio_ = options_.pixel_ratio.value_or(around_.ratio);
  data_.state.viewpoint = first_viewpoint(options_, picture(), data_.state, beside_panels(size));
}

App::~App() {
  if (run_.session()) run_.session()->all_off();  // before waiting for a disk
  memory_.remember(settings());
}

/// The command line has precedence.
void App::recall() {
  if (!memory_.remembers()) return;
  try {
    memory_.load();
  } catch (const Error& error) {
    say(log::Level::warning, error.what(), 0);
  }
  const Settings& recalled = memory_.recalled();
  data_.state.layers = first_state(options_, recalled.layers).layers;
  data_.state.dark = data_.state.dark || recalled.dark;
  if (!options_.given.contains("--fine")) data_.state.fine = recalled.fine;
  if (!options_.heat) data_.state.skin_colour = recalled.skin_colour;
  data_.state.time.slots_per_s = recalled.slots_per_s;
  data_.panels = data_.panels && recalled.panels;
  data_.headings = recalled.headings;
  data_.recent = recalled.recent;
  window_ = recalled.window;
  memory_.begin(settings());
}

Settings App::settings() const {
  return {.layers = data_.state.layers,
          .dark = data_.state.dark,
          .panels = data_.panels,
          .fine = data_.state.fine,
          .skin_colour = data_.state.skin_colour,
          .slots_per_s = data_.state.time.slots_per_s,
          .headings = data_.headings,
          .window = window_,
          .recent = data_.recent};
}

std::string App::title() const {
  const std::string& scene = data_.edit.options().scene;
  const std::string name = std::filesystem::path(scene).filename().string();
  if (data_.live) return fmt::format("{}, live ({})", name, data_.edit.options().source);
  if (data_.empty) return "";
  if (name.empty()) return options_.layout.empty() ? options_.input.rig : options_.layout;
  return name + (picture().fingers.empty() ? "" : ", one touch");
}

void App::settled(const std::string& about) {
  if (std::erase_if(data_.toasts, [&](const Toast& toast) { return toast.about == about; }) > 0) stale_.redraw();
}

void App::say(log::Level level, const std::string& line, double now_s, const std::string& about) {
  stale_.redraw();
  if (const auto same = std::ranges::find(data_.toasts, line, &Toast::text); same != data_.toasts.end()) {
    same->until_s = now_s + toast_s;  // a second reading gives the same warning
    return;
  }
  if (data_.toasts.size() >= 4) data_.toasts.pop_front();
  data_.toasts.push_back({line, level, now_s + toast_s, about});
  data_.log.push_back({level, line});
}

bool App::changing() const {
  return std::ranges::any_of(picture().fingers, [](const FingerMarks& finger) { return finger.foci.size() > 1; });
}

Area App::picture_area(const Size& size) const {
  const double width = size.width, height = size.height, line = text_height * ratio_;
  if (!ui_) return {0, 0, width, height};
  const double panels = data_.panels ? panels_width(width, line) : 0;
  return {0, std::clamp(strip_height(line), 0.0, std::max(height - 1, 0.0)), std::max(width - panels, 1.0), height};
}

Size App::beside_panels(const Size& size) const {
  const Area area = picture_area(size);
  return {static_cast<std::uint32_t>(area.right - area.left), static_cast<std::uint32_t>(area.bottom - area.top)};
}

void App::handle(const WindowEvent& event, const Size& whole_size) {
  const Size size = beside_panels(whole_size);
  if (event.kind == WindowEvent::Kind::damage) stale_.redraw();
  if (event.kind == WindowEvent::Kind::drop) return open(event.text, now_s_);
  const bool press = event.kind == WindowEvent::Kind::press;
  const auto here = [&](const Area& area) { return area.holds(event.x, event.y); };
  // Before any picture, even if something lies over the button.
  if (press && data_.places.all_off && here(*data_.places.all_off)) switch_off();
  const bool escape = event.kind == WindowEvent::Kind::key && event.down && event.key == Key::escape;
  if (escape && ui_ && ui_->let_go()) {
    data_.ceiling.reset();
    run_.set_ceiling(data_.edit.options().safety.ceiling);
    return stale_.redraw();
  }
  if (escape && ui_ && ui_->close_list()) return stale_.redraw();
  const bool taken =
      ui_ && ui_->take(event, press && event.button == Button::left && std::ranges::any_of(data_.places.texts, here));
  if (ui_) stale_.redraw();
  if (taken && event.kind != WindowEvent::Kind::release) return;
  if (event.repeat && !goes_on(event)) return;
  if (escape && (data_.picker || data_.help)) return close_innermost();
  // The first move onto a panel comes before a picture in which the panels notice the pointer.
  if (press) held_ = true;
  if (event.kind == WindowEvent::Kind::release) held_ = false;
  if (event.kind == WindowEvent::Kind::move && !held_ && !picture_area(whole_size).holds(event.x, event.y)) return;
  handle_in_picture(in_area(event, picture_area(whole_size)), size);
}

void App::handle_in_picture(const WindowEvent& event, const Size& size) {
  // What is held stays held until it is released, even while a run restarts and there are no handles.
  const bool handles = data_.state.slice_handles && data_.state.layers.shows(Layer::slice);
  if ((handles || slice_.hand.dragging()) && slice_.hand.handle(event, sight(size), data_.state.slice)) {
    slice_.placed = true;
    return stale_.redraw();
  }
  if (data_.live) {
    const bool placed = moved_.placing().handle(event, sight(size));
    place();
    if (placed) return stale_.redraw();
  }
  if (event.kind == WindowEvent::Kind::key && event.down) handle_key(event);
  if (event.kind == WindowEvent::Kind::press && event.ctrl && event.button == Button::left)
    return read_at(event.x, event.y, size);
  const Box home = home_of(options_, picture(), data_.state);
  if (controls_.handle(event, data_.state.viewpoint, home, size.width, size.height) == Reply::redraw) stale_.redraw();
}

void App::read_at(double x, double y, const Size& size) {
  data_.reading = pick(picture(), data_.state, x, y, size.width, size.height, ratio_);
  data_.state.picked = data_.reading ? std::optional(data_.reading->at) : std::nullopt;
  stale_.redraw();
}

void App::advance(double now_s, const Size& whole_size) {
  const Size size = beside_panels(whole_size);
  now_s_ = now_s;
  advance_log(now_s);
  advance_opening(now_s);
  do_asked(now_s, size);
  if (run_.session()) advance_live(now_s, size);
  show_doing();
  if (const std::string scene = data_.edit.options().scene; scene_watch_.look(scene, now_s)) open_again(scene, now_s);
  advance_slots(now_s);
  listen(now_s);
  advance_participant(now_s);
  if (std::ranges::any_of(data_.toasts, [&](const Toast& toast) { return now_s >= toast.until_s; })) stale_.redraw();
  stale_.look(data_.state);
}

void App::advance_log(double now_s) {
  for (const log::Line& line : tail_.take()) {
    if (line.level <= log::Level::warning) {
      say(line.level, line.text, now_s);
    } else {
      data_.log.push_back(line);
    }
  }
  while (data_.log.size() > log::Tail::most)
    data_.log.pop_front();
}

/// Shows what is being loaded, by a run that begins or in the background.
void App::show_doing() {
  const bool loads = data_.opening || (data_.live && data_.live_state == LiveState::loading);
  const std::optional<Doing> doing = loads ? palpa::doing() : std::nullopt;
  data_.doing = doing ? doing->what : std::string();
  data_.done = doing && doing->total > 0
                   ? std::optional(static_cast<double>(doing->done) / static_cast<double>(doing->total))
                   : std::nullopt;
  if (loads) stale_.redraw();
  const bool idle = data_.live_state == LiveState::ended || data_.live_state == LiveState::failed;
  const bool has_object = !data_.edit.options().scene.empty();
  data_.can_start = data_.live ? idle : has_object && static_cast<bool>(around_.goes_live);
  data_.empty = show_ && picture().solids.empty() && picture().transducers.empty() && !picture().skin;
}

/// Silence at once. Nothing begins until the user starts it.
void App::switch_off() {
  if (!run_.session()) return;
  const bool was_on = run_.switch_off();
  data_.asked.start = false;
  if (ui_) ui_->forget();  // discards a click on Start that no picture has shown yet
  if (was_on) say(log::Level::info, "all off", now_s_);
}

void App::do_asked(double now_s, const Size& size) {
  const PanelData::Asked asked = std::exchange(data_.asked, {});
  if (data_.live && ui_) do_placing(now_s);
  if (asked.all_off) switch_off();
  if (data_.ceiling) run_.set_ceiling(*data_.ceiling);  // while its slider is held
  do_views(asked, size);
  for (const OptionText& option : asked.options)
    set_option(option, now_s);
  if (!asked.open.empty()) open(asked.open, now_s);
  if (asked.copy) copy_command(now_s);
  if (asked.copy_picture) copy_picture(now_s, size);
  if (asked.play) player_.play(*asked.play);
  if (asked.go_to) player_.go_to(*asked.go_to);
  if (asked.participant) try_participant(*asked.participant);
  if (asked.cancel) cancel_opening();
  if (asked.record) record(now_s);
  if (asked.step != 0) player_.step(asked.step);
  if (asked.slots != 0) {
    SlotTime& time = data_.state.time;
    time.playing = false;
    const auto back = static_cast<std::uint64_t>(std::max(-asked.slots, 0));
    time.slot =
        asked.slots > 0 ? time.slot + static_cast<std::uint64_t>(asked.slots) : time.slot - std::min(time.slot, back);
    show_slot_now();
  }
  if (asked.start) stale_.redraw();
  if (asked.start && !asked.all_off) start_run();
}

void App::do_views(const PanelData::Asked& asked, const Size& size) {
  Viewpoint& viewpoint = data_.state.viewpoint;
  const double aspect = static_cast<double>(std::max(size.width, 1u)) / std::max(size.height, 1u);
  if (asked.plane) turn_slice(*asked.plane);
  if (asked.view) look(viewpoint, *asked.view);
  if (asked.frame || asked.view) fit(viewpoint, home_of(options_, picture(), data_.state), aspect);
  if (asked.frame_touch) fit(viewpoint, extent(picture(), Extent::touch, data_.state), aspect);
  if (asked.view || asked.frame || asked.frame_touch) stale_.redraw();
}

void App::show_slot_now() {
  const std::uint64_t slot = data_.state.time.slot;
  if (show_) {
    show_->go_to(slot);
  } else if (run_.scene()) {
    show_live_slot(live_.picture, *run_.scene(), run_.session()->snapshot(), slot, live_.slot);
  }
  stale_.add(Stale::marks);
}

void App::advance_slots(double now_s) {
  SlotTime& time = data_.state.time;
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
  if (data_.state.time.playing && changing()) sooner(next_slot_s_);
  for (const Toast& toast : data_.toasts)
    sooner(toast.until_s);
  if (!data_.edit.options().scene.empty()) sooner(scene_watch_.next_s());
  if (data_.opening) sooner(now_s_ + 0.1);
  if (data_.participant.says_how_to_leave) sooner(leave_line_until_s_);
  if (sounds_.busy()) sooner(now_s_ + 0.03);
  if (data_.sounding) sooner(now_s_ + lull_s);
  if (run_.under_way()) sooner(now_s_ + (data_.live_state == LiveState::loading ? 0.1 : tend_s));
  return next;
}

void App::update(DrawnPicture& drawn) {
  switch (stale_.take(data_.state)) {
    case Stale::surfaces:
      return drawn.update(picture(), data_.state);
    case Stale::skin:
      return drawn.update_skin(picture(), data_.state);
    case Stale::marks:
      return drawn.update_marks(picture(), data_.state);
    case Stale::nothing:
      return;
  }
}

App::Frame App::render(const Size& size, double ratio, double now_s) {
  Frame frame;
  ratio_ = ratio;
  if (ui_) {
    ui_->set_dark(data_.state.dark);
    ui_->begin(size.width, size.height, ratio, now_s - last_render_s_);
    data_.picture = &picture();
    show_marks(size);
    draw_panels(data_, now_s);
    take_placing();
    data_.places.list = ui_->has_list();
    frame.sheet = &ui_->end();
  }
  last_render_s_ = now_s;
  stale_.drew();
  const auto below = static_cast<std::int32_t>(picture_area(size).top);
  frame.views = views_from(data_.state.viewpoint, options_, picture(), beside_panels(size), ratio);
  for (View& view : frame.views)
    view.area.offset.y += below;
  return frame;
}

/// What lies flat on the picture, in a window of that size.
void App::show_marks(const Size& size) {
  data_.marks.clear();
  show_placing(beside_panels(size));
  show_reading(beside_panels(size));
  const Area area = picture_area(size);
  for (FlatMark& mark : data_.marks) {
    for (Vec2& point : mark.points)
      point += Vec2(area.left, area.top);
  }
}

bool App::finish(double patience_s) {
  memory_.remember(settings());
  return run_.finish(patience_s);
}

}  // namespace palpa::viewer
