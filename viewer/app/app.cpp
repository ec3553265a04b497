#include "viewer/app/app.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "setup/process/interrupt.hpp"
#include "viewer/app/flat_marks.hpp"
#include "viewer/app/keys.hpp"
#include "viewer/app/own_files.hpp"
#include "viewer/app/pick.hpp"
#include "viewer/options/view_line.hpp"
#include "viewer/panels/key_sheet.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/stroke_font.hpp"
#include "viewer/picture/colour_bars.hpp"

namespace palpa::viewer {
namespace {

constexpr double silence_check_s = 0.1;  ///< the strip notices silence this soon, even if no frame comes
constexpr double tend_s = 1;             ///< a live run is looked after at least this often, see LiveSession::look
constexpr double quit_again_s = 2;       ///< while the array sounds, a second press within this time quits
constexpr double above_object_m = 0.03;  ///< where a held finger has room

/// The event with its place counted from the area's top left.
WindowEvent in_area(WindowEvent event, const Area& area) {
  event.x -= area.left;
  event.y -= area.top;
  return event;
}

double aspect_of(const Size& size) {
  return static_cast<double>(std::max(size.width, 1u)) / std::max(size.height, 1u);
}

}  // namespace

App::App(const ViewerOptions& options, const Size& size, AppHost host)
    : host_(std::move(host)),
      memory_(host_.settings),
      content_(options, host_.kinds, *host_.stop, host_.wake, host_.goes_live, data_.content, data_.messages, stale_),
      slice_(options.slice),
      participant_(data_.participant, data_.messages, stale_) {
  data_.state = first_state(options);
  data_.placing = &content_.run().placing();
  data_.panels = host_.panels && !options.no_panels;
  recall();
  if (host_.panels) {
    ui_ = std::make_unique<Ui>(data_.state.dark, host_.copy, host_.paste);
    list_own_files(data_);
  }
  content_.begin();
  if (!data_.content.live) data_.state.time.playing = content_.picture().changes();
  if (const ShownTouch* const touch = content_.touch(); touch && touch->slot_s())
    data_.state.time.slots_per_s = 1 / *touch->slot_s();  // as fast as it plays; remembered for touches alone
  if (options.participant) open_participant();
  ratio_ = options.pixel_ratio.value_or(host_.ratio);
  data_.state.viewpoint = first_viewpoint(options, picture(), data_.state, free_size(size));
  if (data_.content.empty) {
    data_.state.viewpoint.covered_right = welcome_share(free_size(size).width, text_height * ratio_);
    data_.asked.frame = true;
  }
  see_framed();
}

App::~App() {
  if (session()) session()->all_off();  // before waiting for a disk
  memory_.remember(settings());
}

/// The command line has precedence.
void App::recall() {
  if (!memory_.remembers()) return;
  try {
    memory_.load();
  } catch (const Error& error) {
    data_.messages.say(log::Level::warning, error.what());
  }
  const ViewerOptions& options = content_.options();
  const Preferences& recalled = memory_.recalled();
  data_.state.layers = first_state(options, recalled.layers).layers;
  data_.state.dark = data_.state.dark || recalled.dark;
  if (!options.given.contains("--fine")) data_.state.fine = recalled.fine;
  if (!options.heat) data_.state.skin_colour = recalled.skin_colour;
  data_.state.time.slots_per_s = recalled.slots_per_s;
  data_.panels = data_.panels && recalled.panels;
  data_.headings = recalled.headings;
  data_.content.recent = recalled.recent;
  window_ = recalled.window;
  memory_.begin(settings());
}

Preferences App::settings() const {
  return {.layers = data_.state.layers,
          .dark = data_.state.dark,
          .panels = data_.panels,
          .fine = data_.state.fine,
          .skin_colour = data_.state.skin_colour,
          .slots_per_s =
              content_.options().sensation.empty() ? data_.state.time.slots_per_s : memory_.recalled().slots_per_s,
          .headings = data_.headings,
          .window = window_,
          .recent = data_.content.recent};
}

bool App::finish(double patience_s) {
  memory_.remember(settings());
  return content_.run().control().finish(patience_s);
}

// ---- events -------------------------------------------------------------------------------------------------------

Area App::picture_area(const Size& size) const {
  const double width = size.width, height = size.height, line = text_height * ratio_;
  if (!ui_) return {0, 0, width, height};
  const double panels = data_.panels ? panels_width(width, line) : 0;
  return {0, std::clamp(strip_height(line), 0.0, std::max(height - 1, 0.0)), std::max(width - panels, 1.0), height};
}

Size App::free_size(const Size& size) const {
  const Area area = picture_area(size);
  return {static_cast<std::uint32_t>(area.right - area.left), static_cast<std::uint32_t>(area.bottom - area.top)};
}

Sight App::sight(const Size& size) const {
  return {data_.state.viewpoint, static_cast<double>(size.width), static_cast<double>(size.height), ratio_};
}

void App::handle(const WindowEvent& event, const Size& whole_size) {
  if (event.kind == WindowEvent::Kind::damage) stale_.redraw();
  if (host_.guide && host_.guide->takes(event, content_.run())) return stale_.redraw();
  if (event.kind == WindowEvent::Kind::drop) return content_.open(event.text);
  const bool press = event.kind == WindowEvent::Kind::press;
  const auto here = [&](const Area& area) { return area.holds(event.x, event.y); };
  // Before any picture, even if something lies over the button.
  if (press && data_.places.all_off && here(*data_.places.all_off)) switch_off();
  const bool escape = event.kind == WindowEvent::Kind::key && event.down && event.key == Key::escape;
  if (escape && ui_ && ui_->let_go()) {
    data_.ceiling.reset();
    if (data_.drag) data_.drag->cancelled = true;
    content_.run().control().set_ceiling(data_.content.edit.options().safety.ceiling);
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
  const Area area = picture_area(whole_size);
  if (event.kind == WindowEvent::Kind::move && !held_ && !area.holds(event.x, event.y)) return;
  handle_in_picture(in_area(event, area), free_size(whole_size));
}

void App::handle_in_picture(const WindowEvent& event, const Size& size) {
  if (slice_.handle(event, sight(size), data_.state)) return stale_.redraw();
  if (data_.content.live) {
    const bool placed = content_.run().placing().handle(event, sight(size));
    content_.run().place();
    if (placed) return stale_.redraw();
  }
  if (event.kind == WindowEvent::Kind::key && event.down) handle_key(event);
  if (event.kind == WindowEvent::Kind::press && event.ctrl && event.button == Button::left)
    return read_at(event.x, event.y, size);
  const Box home = home_of(content_.options(), picture(), data_.state);
  if (controls_.handle(event, data_.state.viewpoint, home, size.width, size.height) == Reply::redraw) stale_.redraw();
}

void App::read_at(double x, double y, const Size& size) {
  data_.reading = pick(picture(), data_.state, x, y, size.width, size.height, ratio_);
  data_.state.picked = data_.reading ? std::optional(data_.reading->at) : std::nullopt;
  stale_.redraw();
}

void App::handle_key(const WindowEvent& event) {
  stale_.redraw();
  data_.picture = &picture();
  const bool only_with_ctrl = event.key == key_of('z') && !event.ctrl;
  if (const std::string reason = idle_reason(data_, event.key); !reason.empty() && !only_with_ctrl)
    return data_.messages.say(log::Level::info, reason);
  if (event.key == Key::escape) return close_innermost();
  if (event.key == key_of('o')) return switch_off();
  if (!participant_key(event.key)) ask_by_key(event, data_);
}

void App::handle_participant(const WindowEvent& event) {
  if (event.kind != WindowEvent::Kind::key || !event.down || event.repeat) return;
  stale_.redraw();
  if (event.key == Key::escape) return try_participant(false);
  if (event.key == key_of('o')) return switch_off();
  participant_key(event.key);
}

/// Handles the keys that both windows take.
bool App::participant_key(Key key) {
  if (key == key_of('v')) {
    data_.participant.hidden = !data_.participant.hidden;
  } else if (key == key_of('p')) {
    data_.asked.participant = !data_.participant.open;
  } else if (key == key_of('q')) {
    ask_to_quit();
  } else if (key == Key::page_up || key == Key::page_down) {
    content_.open_neighbour(key == Key::page_down ? 1 : -1);
  } else {
    return false;
  }
  return true;
}

/// Lists that have dropped down, and what is dragged, have had the key before.
void App::close_innermost() {
  stale_.redraw();
  if (data_.picker) return data_.picker.reset();
  if (content_.is_opening()) return content_.cancel_opening();
  if (data_.help) return void(data_.help = false);
  if (data_.reading) {
    data_.reading.reset();
    data_.state.picked.reset();
    return;
  }
  if (data_.content.live) return data_.messages.say(log::Level::info, "nothing is open; Q quits");
  quitting_ = true;
}

void App::ask_to_quit() {
  const bool again = now_s_ - quit_asked_s_ <= quit_again_s;
  quitting_ = again || !data_.content.run.sounding;
  if (quitting_) return;
  quit_asked_s_ = now_s_;
  data_.messages.say(log::Level::warning, "the array sounds: press Q again within 2 s to quit");
}

/// Silence at once. Nothing begins until the user starts it.
void App::switch_off() {
  if (!session()) return;
  const bool was_on = content_.run().control().switch_off();
  data_.asked.start = false;
  if (ui_) ui_->forget();  // discards a click on Start that no picture has shown yet
  if (was_on) data_.messages.say(log::Level::info, "all off");
}

/// The rig's screen is read only when it is needed, because a rig may have none.
void App::open_participant() {
  ViewerOptions options = content_.options();
  if (const std::string& rig = data_.content.edit.options().rig.rig; !rig.empty()) options.input.rig = rig;
  participant_.open(options, now_s_);
}

void App::try_participant(bool open) {
  try {
    open ? open_participant() : participant_.close();
  } catch (const Error& error) {
    data_.messages.say(log::Level::error, error.what());
  }
}

// ---- what time does, and what was asked for -----------------------------------------------------------------------

void App::advance(double now_s, const Size& whole_size) {
  const Size size = free_size(whole_size);
  now_s_ = now_s;
  data_.messages.advance(now_s, tail_.take());
  const bool was_live = data_.content.live;
  if (content_.take_opened()) data_.asked.frame = true;
  see_framed();
  do_asked(size);
  if (data_.content.live && !was_live) data_.state.time.playing = true;
  if (session()) advance_run(size);
  if (host_.guide && host_.guide->advance(content_.run(), data_)) quitting_ = true;
  content_.update_status();
  content_.watch_scene(now_s);
  advance_slots();
  advance_sound();
  leave_room_for_bars(size);
  participant_.advance(now_s);
  stale_.look(data_.state);
}

void App::do_asked(const Size& size) {
  const PanelData::Asked asked = std::exchange(data_.asked, {});
  ShownRun& run = content_.run();
  if (data_.content.live) run.place();
  if (asked.all_off) switch_off();
  if (data_.ceiling) run.control().set_ceiling(*data_.ceiling);  // while its slider is held
  do_views(asked, size);
  for (const OptionText& option : asked.options)
    content_.set_option(option);
  if (!asked.open.empty()) content_.open(asked.open);
  if (asked.copy) copy_run();
  if (asked.copy_picture) copy_picture(size);
  if (asked.play) run.player().play(*asked.play);
  if (asked.go_to) run.player().go_to(*asked.go_to);
  if (asked.participant) try_participant(*asked.participant);
  if (asked.cancel) content_.cancel_opening();
  if (asked.record) run.record();
  if (asked.save_scene) save_scene(data_.moved_file);
  if (asked.step != 0) run.player().step(asked.step);
  if (asked.slots != 0) step_slots(asked.slots);
  if (asked.start) stale_.redraw();
  if (asked.start && !asked.all_off) content_.start();
}

void App::do_views(const PanelData::Asked& asked, const Size& size) {
  Viewpoint& viewpoint = data_.state.viewpoint;
  if (asked.plane) slice_.turn(*asked.plane, data_.state, picture());
  if (asked.view) look(viewpoint, *asked.view);
  if (asked.frame || asked.view) fit(viewpoint, home_of(content_.options(), picture(), data_.state), aspect_of(size));
  if (asked.frame_touch) fit(viewpoint, extent(picture(), Extent::touch, data_.state), aspect_of(size));
  if (asked.view || asked.frame || asked.frame_touch) stale_.redraw();
}

void App::step_slots(int by) {
  SlotTime& time = data_.state.time;
  time.playing = false;
  const auto steps = static_cast<std::uint64_t>(std::abs(by));
  time.slot = by > 0 ? time.slot + steps : time.slot - std::min(time.slot, steps);
  content_.show_slot(time.slot);
}

void App::copy(const std::string& command) {
  if (host_.copy) host_.copy(command);
  data_.messages.say(log::Level::info, "copied: " + command);
  if (content_.run().placing().moved())
    data_.messages.say(log::Level::warning,
                       "the command line does not have the moved things: save the scene, then copy");
}

void App::copy_run() {
  const LiveEdit& edit = data_.content.edit;
  if (data_.content.live || edit.line().contains("--source")) return copy(edit.command());
  data_.messages.say(log::Level::info, "Ctrl C: this is one touch and no run; C copies the picture's command line");
}

void App::copy_picture(const Size& size) {
  const SeenView seen{data_.state, size, ratio_, slice_.placed(), data_.content.run.numbers.frames, slice_.plane()};
  const line::Given run = data_.content.live ? data_.content.edit.line() : line::Given();
  copy(picture_command(content_.options(), run, seen));
}

void App::advance_run(const Size& size) {
  if (setup::Interrupt::signalled()) quitting_ = true;
  if (content_.look_at_run()) frame_object(size);
  content_.run().show_frame(data_.state.time.slot, data_.state.layers.shows(Layer::depth));
  content_.follow_run(quitting());
}

/// The viewpoint was set to the solids of a touch.
void App::see_framed() {
  if (content_.touch()) framed_ = picture().solids.empty() ? "" : data_.content.edit.options().scene;
}

/// The first object is seen as the command line says, another one from the same side. If the pointer holds the finger,
/// objects are seen from near, because the pointer has to hit them.
void App::frame_object(const Size& size) {
  const ViewerOptions& options = content_.options();
  const setup::LiveOptions& run = content_.run().control().options();
  const bool first = framed_.empty(), other = framed_ != run.scene;
  const auto given = [&](const char* option) { return options.given.contains(option); };
  const bool as_given = first && (given("--view") || given("--eye") || given("--frame"));
  framed_ = run.scene;
  if (first) data_.state.viewpoint = first_viewpoint(options, picture(), data_.state, size);
  if (!other || as_given) return;
  if (!HeldFinger::is_held(run.source)) {
    data_.asked.frame = !first;
    return;
  }
  Box box = extent(picture(), Extent::objects, data_.state);
  box.add(Vec3(box.centre().x, box.high.y + above_object_m, box.centre().z));
  fit(data_.state.viewpoint, box, aspect_of(size));
}

void App::advance_slots() {
  SlotTime& time = data_.state.time;
  const bool plays = time.playing && content_.picture().changes();
  if (plays && now_s_ < next_slot_s_) return;
  if (plays) {
    const double late = std::clamp((now_s_ - next_slot_s_) * time.slots_per_s, 0.0, 1e4);
    time.slot += 1 + static_cast<std::uint64_t>(late);
    content_.show_slot(time.slot);
  }
  next_slot_s_ = now_s_ + 1 / time.slots_per_s;
}

void App::advance_sound() {
  ViewState& state = data_.state;
  slice_.place_once(state, picture());
  const bool slice = state.layers.shows(Layer::slice);  // only the slice needs the slot
  const Sounding now = content_.sounding(slice ? std::optional(state.time.slot) : std::nullopt);
  state.slice_handles = host_.hands && now.layout != nullptr;
  Sounds& sounds = content_.sounds();
  const Change change = sounds.look(now, state, data_.wants_spectrum, content_.picture(), now_s_);
  stale_.add(change.skin ? Stale::skin : change.marks ? Stale::marks : Stale::nothing);
  data_.spectra = sounds.spectra();
  for (const std::string& fault : sounds.faults())
    data_.messages.say(log::Level::error, fault);
}

void App::leave_room_for_bars(const Size& size) {
  Viewpoint& viewpoint = data_.state.viewpoint;
  const double share = bars_share(picture(), data_.state.layers, size.width, size.height, ratio_);
  if (share == viewpoint.covered_below) return;
  cover_below(viewpoint, share, content_.options().given.contains("--eye"));
  stale_.redraw();
}

void App::leave_room_for_close_up(const Size& size) {
  Viewpoint& viewpoint = data_.state.viewpoint;
  const ViewerOptions& options = content_.options();
  if (options.given.contains("--eye") || viewpoint.frustum) return;
  if (views_from(viewpoint, options, picture(), free_size(size), ratio_).size() < 2) return;
  viewpoint.covered_right = inset_share;
  fit(viewpoint, home_of(options, picture(), data_.state), aspect_of(free_size(size)));
}

void App::hold() {
  content_.run().hold();
  data_.state.time.playing = false;
}

std::optional<double> App::next_s() const {
  std::optional<double> next;
  const auto sooner = [&](double at) { next = next ? std::min(*next, at) : at; };
  if (data_.state.time.playing && content_.picture().changes()) sooner(next_slot_s_);
  for (const Toast& toast : data_.messages.toasts())
    sooner(toast.until_s);
  const Content& content = data_.content;
  if (!content.edit.options().scene.empty()) sooner(content_.next_watch_s());
  if (content.opening) sooner(now_s_ + 0.1);
  if (data_.participant.says_how_to_leave) sooner(participant_.leave_line_until_s());
  if (content_.sounds().busy()) sooner(now_s_ + 0.03);
  if (content.run.sounding) sooner(now_s_ + silence_check_s);
  if (content_.run().control().under_way()) sooner(now_s_ + (content.run.state == LiveState::loading ? 0.1 : tend_s));
  return next;
}

// ---- the picture --------------------------------------------------------------------------------------------------

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
    draw_panels(data_);
    data_.places.list = ui_->has_list();
    frame.sheet = &ui_->end();
  }
  last_render_s_ = now_s;
  stale_.drew();
  data_.messages.drew();
  const auto below = static_cast<std::int32_t>(picture_area(size).top);
  frame.views = views_from(data_.state.viewpoint, content_.options(), picture(), free_size(size), ratio);
  for (View& view : frame.views)
    view.area.offset.y += below;
  return frame;
}

/// What lies flat on the picture, in a window of that size.
void App::show_marks(const Size& size) {
  const Sight seen = sight(free_size(size));
  data_.marks.clear();
  data_.depths.clear();
  if (data_.content.live) data_.marks = data_.placing->marks(seen);
  const std::shared_ptr<const LiveScene>& scene = content_.run().control().scene();
  if (host_.guide) host_.guide->mark(seen, data_.marks);
  if (scene && !host_.guide)
    show_depths(session()->snapshot().touch, scene->solid_names, seen, data_.depths, data_.marks);
  if (data_.reading) show_reading(*data_.reading, seen, data_.marks);
  const Area area = picture_area(size);
  for (FlatMark& mark : data_.marks) {
    for (Vec2& point : mark.points)
      point += Vec2(area.left, area.top);
  }
}

}  // namespace palpa::viewer
