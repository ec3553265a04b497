#include "viewer/options/viewer_options.hpp"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <glm/geometric.hpp>
#include <initializer_list>
#include <utility>

#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "base/units.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "setup/sessions/play.hpp"
#include "viewer/live/live_line.hpp"
#include "viewer/picture/chart.hpp"
#include "viewer/picture/colour_bars.hpp"

namespace palpa::viewer {
namespace {

bool has_skin(const ViewerOptions& o) {
  return !o.input.points.empty() || !o.input.depths.empty();
}

Vec3 point(const std::string& option, const std::string& text) {
  const auto p = line::parse_point(option, text);
  return {p[0], p[1], p[2]};
}

/// The part of --view before a colon.
std::string_view standard_view(const ViewerOptions& o) {
  const std::string_view view = o.view;
  return view.starts_with("camera:") ? view.substr(0, 6) : view;
}

const CameraMark& camera_of(const ViewerOptions& o, const Picture& picture) {
  const std::string_view name = std::string_view(o.view).substr(standard_view(o).size());
  std::string names;
  for (const CameraMark& camera : picture.cameras) {
    if (name.empty() || name.substr(1) == camera.name) return camera;
    names += (names.empty() ? "" : ", ") + camera.name;
  }
  throw bad_usage(fmt::format("--view: unknown camera '{}'; give one of {}", name.substr(1), names));
}

/// The parts of "a,b,c". An empty text has none.
std::vector<std::string_view> items_of(std::string_view text) {
  std::vector<std::string_view> items;
  if (text.empty()) return items;
  for (std::size_t comma = text.find(','); comma != std::string_view::npos; comma = text.find(',')) {
    items.push_back(text.substr(0, comma));
    text.remove_prefix(comma + 1);
  }
  items.push_back(text);
  return items;
}

Layer layer_of(const char* option, std::string_view word) {
  if (const std::optional<Layer> layer = value_of(layer_words, word)) return *layer;
  throw bad_usage(fmt::format("{}: '{}' is not a layer; give {}", option, word, one_of(layer_words)));
}

std::vector<Layer> layers_in(const char* option, std::string_view text) {
  std::vector<Layer> layers;
  for (const std::string_view word : items_of(text))
    layers.push_back(layer_of(option, word));
  return layers;
}

/// The layers that are normally visible, or those that are not.
std::string names_of_layers(bool visible) {
  std::string names;
  for (const Word<Layer>& entry : layer_words) {
    if (Layers()[entry.value].visible == visible) names += std::string(names.empty() ? "" : ", ") + entry.word;
  }
  return names;
}

void add_sensation_options(CLI::App& app, ViewerOptions& o) {
  const line::Group sensation(app, "A sensation, as palpa play");
  sensation.text("--sensation", o.sensation, "FILE|NAME",
                 fmt::format("plays a pattern of Adaptics, or {}, with the array and the focus [none]",
                             fmt::join(setup::sensation_names(), ", ")));
  setup::add_parameters(sensation, o.parameters);
}

void add_live_options(CLI::App& app, ViewerOptions& o) {
  const line::Group live(app, "Live, as palpa run");
  o.live.source.clear();  // unlike palpa run, the viewer has no source unless it is given one
  live.text("--source", o.live.source, "SOURCE",
            "shows a live run whose depth frames come from synthetic[:MESH], mouse[:MESH] (the pointer holds it), "
            "recording:DIR, v4l2:/dev/videoN[,...], realsense:SERIAL[,...] or bag:FILE; or a tracker of hands, "
            "joints:udp:PORT or joints:FILE [no live run]");
  add_loop_options(live, o.live);
  add_link_options(live, o.live);
  add_following_options(app, o.live);
}

void add_picture_options(CLI::App& app, ViewerOptions& o) {
  const line::Group what(app, "Picture");
  what.text("--skin", o.skin, "FILE",
            "PLY file with the surface of the finger or hand, to be drawn faintly; --penetration moves it, too");
  what.text("--title", o.title, "TEXT", "text above the legend");
  what.text("--show", o.shown, "LAYER,...",
            fmt::format("draws these layers, which are off by default: {}", names_of_layers(false)));
  what.text("--hide", o.hidden, "LAYER,...", fmt::format("does not draw these layers: {}", names_of_layers(true)));
  what.text("--opacity", o.opacities, "LAYER=0..1,...", "opacity of layers, such as array=0.3; 1 is their usual look");
  what.number("--explode", o.explode, {0, 1}, "NUMBER",
              "how far apart the convex parts of solids are drawn, in sizes of their solid");
  what.choice("--slice", o.slice.plane, setup::plane_words,
              "shows the sound field of the slot in a plane; its two letters are axes of the world [none; xz with "
              "--show slice]");
  what.point("--slice-at", o.slice.at, "centre of the plane of --slice [the touch's centre]");
  what.quantity("--slice-size", o.slice.size_m, Quantity::length, line::positive(10),
                "length of the sides of the plane of --slice");
  what.choice("--heat", o.heat, skin_colour_words,
              "colours the finger by the pressure or by the rates of a class of its afferents [none; pressure with "
              "--show heat]");
  what.flag("--dark", o.dark, "draws on a dark background");
  what.choice("--fine", o.fine, fine_words,
              "when pictures have four samples for each pixel; auto means, on slow devices, only while nothing moves; "
              "without a window, it means always");
}

void add_view_options(CLI::App& app, ViewerOptions& o) {
  const line::Group where(app, "View");
  where.text("--view", o.view, "FROM",
             "viewpoint: front, right, top, iso, camera (through the first camera of --depth), or camera:NAME");
  where.point("--eye", o.eye, "place of the eye, which looks at --target; instead of --view [no eye]");
  where.point("--target", o.target, "point that --eye looks at [0,0,0]");
  where.choice("--frame", o.frame, {{"touch", Extent::touch}, {"objects", Extent::objects}, {"all", Extent::all}},
               "what fills the picture [all if an array is drawn, else objects]");
  where.flag("--ortho", o.orthographic, "draws in parallel projection");
  where.flag("--inset", o.inset,
             "draws a close-up of the touch in the corner; a live run has one if the touch is small in the picture");
}

void add_participant_options(CLI::App& app, ViewerOptions& o) {
  const line::Group participant(app, "What the participant sees");
  participant.flag(
      "--participant", o.participant,
      "shows objects and marker tile on the rig's screen, as its eye or --eye sees them, in a second window that "
      "fills a monitor; with --headless, in the only picture");
  participant.text("--monitor", o.monitor, "NAME|NUMBER", "monitor of that second window [the last]");
  participant.text("--screen", o.screen, "FILE", "rig TOML with a screen [--rig's, or the paper's]");
  participant.choice("--stereo", o.stereo, stereo_words, "how the pictures of two eyes become one");
  setup::add_eyes_options(participant, o);
}

void add_hands_options(CLI::App& app, ViewerOptions& o) {
  const line::Group hands(app, "Mouse and keys, panels");
  hands.text("--interact", o.interact, "FILE",
             "does what a script says, which has a line for each move (docs/viewer.md) [no script]");
  hands.flag("--no-panels", o.no_panels,
             "shows a window without panels; in a live run, the strip with the array's state stays");
  hands.flag("--panels", o.panels, "draws panels without a window, too");
}

void add_options_without_window(CLI::App& app, ViewerOptions& o) {
  const line::Group how(app, "Without a window");
  how.flag("--headless", o.headless, "opens no window");
  how.integer(
      "--frames", o.frames, 1, 1'000'000,
      "number of frames to draw, a slot each, before it exits [no end; with --headless 1, and of a live run the "
      "first with a touch]");
  how.flag("--at-touch", o.at_touch,
           "the last frame waits up to 5 s for one of the run in which a finger touches [without --frames and "
           "--interact, it waits]");
  how.text("--screenshot", o.screenshot, "FILE", "writes the last frame as PNG [no file]");
  how.text("--video", o.video, "FOLDER",
           "writes every picture, also those of a window, as PNG into a new folder: 000000.png and so on");
  how.text("--size", o.size, "WxH", "size of the picture or window in pixels");
  how.number("--pixel-ratio", o.pixel_ratio, {0.5, 8}, "NUMBER",
             "pixels per point, which sets how large text and lines are [1]");
  how.text("--reference", o.reference, "FILE", "compares the last frame with this PNG [no comparison]");
  how.number("--threshold", o.threshold, {0, 1}, "NUMBER",
             "mean difference from --reference above which the exit code is 1 [0.02]");
}

/// Which of them go together.
void relate_options(CLI::App& app) {
  line::need(app, {"--param"}, "--sensation");
  line::exclude(app, "--sensation", {"--scene", "--points", "--depth", "--rig", "--source", "--skin"});
  line::need(app, {"--target"}, "--eye");
  line::need(app, {"--panels", "--screenshot", "--reference", "--at-touch"}, "--headless");
  line::need(app, {"--at-touch"}, "--source");
  line::need(app, {"--threshold"}, "--reference");
  line::need(app, {"--monitor", "--screen", "--stereo"}, "--participant");
  line::exclude(app, "--interact", {"--at-touch"});
  line::exclude(app, "--headless", {"--no-panels", "--monitor"});
  line::exclude(app, "--participant", {"--target", "--inset"});
  line::exclude(app, "--source", {"--points", "--depth", "--spectrum"});
  line::exclude(app, "--eye", {"--view"});
}

}  // namespace

void add_options(CLI::App& app, ViewerOptions& o) {
  setup::add_touch_input(app, o.input);
  setup::add_allow_outside(line::Group(app, "What touches what"), o.common);
  setup::add_touch_options(app, o.touch);
  setup::add_felt_options(app, o.felt);
  const line::Group array(app, "Array");
  setup::add_layout(array, o.layout, "array to draw", " [no array]");
  array.integer("--slot", o.slot, 0, std::uint64_t{1} << 40,
                "first slot to show, with its focus highlighted and its drive in colours");
  setup::add_drive_options(app, o.drive);
  add_sensation_options(app, o);
  add_live_options(app, o);
  add_picture_options(app, o);
  add_view_options(app, o);
  add_participant_options(app, o);
  add_hands_options(app, o);
  add_options_without_window(app, o);
  relate_options(app);
}

namespace {

/// Every option with the parser of its text.
struct Reader {
  CLI::App app{"", "palpa-viewer"};
  ViewerOptions options;
  Reader() {
    add_options(app, options);
    setup::add_common(app, options.common);
  }
};

}  // namespace

const std::vector<line::OptionInfo>& viewer_table() {
  static const std::vector<line::OptionInfo> table = line::option_table(Reader().app);
  return table;
}

ViewerOptions options_of(const line::Given& given) {
  Reader reader;
  line::read_given(reader.app, line::known_to(viewer_table(), given));
  reader.options.given = given;
  return std::move(reader.options);
}

bool is_of_touch(const line::OptionInfo& option) {
  if (option.name == "--scene" || option.name == "--gltf-scene" || option.name == "--allow-outside") return true;
  return option.heading != "What to run" && option.heading != "From frame to frame";
}

namespace {

/// Throws bad_usage for the first of these that is given; `reason` follows its name.
void refuse_given(const ViewerOptions& o, std::initializer_list<const char*> names, const std::string& reason) {
  for (const char* name : names)
    if (o.given.contains(name)) throw bad_usage(fmt::format("{} {}", name, reason));
}

/// The same of all options under one of the headings.
void refuse_headings(const ViewerOptions& o, std::initializer_list<std::string_view> headings,
                     const std::string& reason) {
  for (const line::OptionInfo& info : live_table()) {
    const bool among = std::ranges::find(headings, info.heading) != headings.end();
    if (among && o.given.contains(info.name)) throw bad_usage(fmt::format("{} {}", info.name, reason));
  }
}

/// Options without an effect in a single picture, which nobody can change afterwards.
void refuse_idle_in_picture(const ViewerOptions& o) {
  const Layers layers = first_state(o).layers;
  if (!layers.shows(Layer::slice)) refuse_given(o, {"--slice-size"}, "goes with --slice or --slice-at");
  if (!o.eye.empty()) refuse_given(o, {"--frame"}, "goes with --view: --eye sets what fills the picture");
  if (o.participant) {
    refuse_given(o, {"--view", "--frame", "--ortho"}, "sets the viewpoint: a participant looks through the screen");
    if (o.stereo == Stereo::none) refuse_given(o, {"--eyes-apart"}, "goes with --stereo");
  } else {
    refuse_given(o, {"--eyes-apart"}, "goes with --participant");
  }
  if (!o.participant || (o.stereo != Stereo::columns && o.stereo != Stereo::rows))
    refuse_given(o, {"--barrier-pitch", "--barrier-gap", "--barrier-phase"}, "goes with --stereo columns or rows");
  if (!has_skin(o)) {
    refuse_headings(o, {"Touch"}, "goes with --points or --depth: without them, nothing is touched");
    refuse_given(o, {"--tune-shortest", "--tune-longest"}, "goes with --points or --depth");
  }
  if (o.input.scene.empty()) {
    refuse_headings(o, {"Solids"}, "goes with --scene");
    refuse_given(o, {"--gltf-scene"}, "goes with --scene");
  }
  if (o.layout.empty() && o.input.rig.empty() && o.sensation.empty())
    refuse_headings(o, {"Drives", "Air and tone"}, "goes with --layout or --rig: it sets how an array is driven");
}

void refuse_idle(const ViewerOptions& o) {
  if (o.is_live()) {
    refuse_given(o, {"--camera"}, "goes with --depth: --source uses the cameras of --rig");
    refuse_given(o, {"--tune-shortest", "--tune-longest"},
                 "goes with --points or --depth: while running, --tune chooses strides alone");
  } else if (o.headless && o.interact.empty()) {
    refuse_given(o, {"--panels"}, "goes with --source or --interact where there is no window");
    refuse_idle_in_picture(o);
  }
  if (!o.is_live() && !o.input.points.empty()) setup::refuse_finger_width(o.touch, "--depth or --source");
}

/// What is shown: a live run, a touch, or objects and an array alone.
void check_shown(const ViewerOptions& o) {
  const bool panels = o.headless ? o.panels && !o.interact.empty() : !o.no_panels;
  const bool may_be_empty = panels && !o.is_live() && !has_skin(o);  // then a file is opened in the window
  if (o.input.scene.empty() && o.layout.empty() && o.sensation.empty() && !may_be_empty) {
    throw bad_usage("nothing to show: give --scene FILE, such as assets/cube.glb, or --layout NAME");
  }
  if (o.is_live()) {
    live_options(o.given);
  } else if (has_skin(o)) {
    setup::check(o.input);
    setup::check(o.touch);
    setup::check(o.felt, o.touch);
  } else if (o.felt.spectrum) {
    throw bad_usage("--spectrum goes with --points or --depth: it needs a touch");
  } else if (o.touch.spot_m) {
    throw bad_usage("--spot goes with --spectrum or --tune");
  } else if (!o.input.cameras.empty() || !o.input.rig.empty()) {
    throw bad_usage("--camera and --rig go with --depth: give the depth images");
  }
  if (o.input.penetration_m && o.input.points.empty() && o.skin.empty()) {
    throw bad_usage("--penetration moves --points and --skin: give one of them");
  }
  if (o.input.penetration_m && o.input.scene.empty()) throw bad_usage("--penetration goes with --scene");
}

/// The layers that show an array's sound need a touch, and what drives the array.
void check_sound_layers(const ViewerOptions& o) {
  const Layers layers = first_state(o).layers;
  if (o.is_live() || !(layers.shows(Layer::slice) || layers.shows(Layer::heat))) return;
  const auto asks = [&](const char* option) { return o.given.contains(option); };
  const char* what = layers.shows(Layer::heat) ? (asks("--heat") ? "--heat" : "--show heat")
                     : asks("--slice")         ? "--slice"
                     : asks("--slice-at")      ? "--slice-at"
                                               : "--show slice";
  if (!o.sensation.empty() && !layers.shows(Layer::heat)) return;
  if (!has_skin(o) || o.input.scene.empty())
    throw bad_usage(fmt::format("{} goes with --points or --depth: it needs a touch", what));
  if (o.layout.empty() && o.input.rig.empty())
    throw bad_usage(fmt::format("{} goes with --layout or --rig: it shows an array's sound", what));
  if (layers.shows(Layer::heat) && o.skin.empty())
    throw bad_usage("--show heat goes with --skin: it needs the finger's closed mesh");
}

void check_view(const ViewerOptions& o) {
  if (!value_of(view_words, standard_view(o)))
    throw bad_usage(fmt::format("--view: '{}' is not a view; give {}, or camera:NAME", o.view, one_of(view_words)));
  if (standard_view(o) == "camera" && o.input.depths.empty()) throw bad_usage("--view camera goes with --depth");
}

void check_participant(const ViewerOptions& o) {
  if (!o.participant) return;
  if (o.headless && (o.is_live() || !o.interact.empty()))
    throw bad_usage("--participant with --headless excludes --source and --interact");
  if (o.input.scene.empty()) throw bad_usage("--participant goes with --scene: give the objects");
}

void check_eyes(const ViewerOptions& o) {
  if (o.barrier_gap_m && *o.barrier_gap_m == 0)
    throw bad_usage(
        "--barrier-gap: a barrier on the screen hides nothing; give a gap above 0, or below 0 for a barrier "
        "behind the screen");
  if (o.eye.empty()) return;
  const Vec3 target = o.target.empty() ? Vec3(0) : point("--target", o.target);
  if (point("--eye", o.eye) == target) throw bad_usage("--eye and --target are the same point");
}

}  // namespace

void check(const ViewerOptions& o) {
  static const Reader reader;
  if (const std::string fault = line::misfit(reader.app, o.given); !fault.empty()) throw bad_usage(fault);
  check_shown(o);
  check_view(o);
  check_sound_layers(o);
  if (!o.slice.at.empty()) point("--slice-at", o.slice.at);
  check_participant(o);
  if (!o.is_live()) {
    for (const line::OptionInfo& info : live_table()) {
      if (!is_of_touch(info) && o.given.contains(info.name))
        throw bad_usage(info.name + " goes with --source: it needs a live run");
    }
  }
  check_eyes(o);
  picture_size(o);
  check(o.drive, setup::FingerMesh::unknown);
  refuse_idle(o);
}

Size picture_size(const ViewerOptions& o) {
  const setup::WindowSize size = setup::parse_window_size("--size", o.size);
  return {size.width, size.height};
}

Fineness fineness_without_window(const ViewerOptions& o) {
  return o.fine == FinePictures::never ? Fineness::quick : Fineness::fine;
}

ViewState first_state(const ViewerOptions& o, const Layers& layers) {
  ViewState state;
  state.layers = layers;
  for (const Layer layer : layers_in("--show", o.shown))
    state.layers[layer].visible = true;
  for (const Layer layer : layers_in("--hide", o.hidden))
    state.layers[layer].visible = false;
  for (const std::string_view item : items_of(o.opacities)) {
    const std::size_t equals = std::min(item.find('='), item.size());
    const std::optional<double> opacity = parse_number(item.substr(std::min(equals + 1, item.size())));
    if (!opacity || !(*opacity >= 0 && *opacity <= 1))
      throw bad_usage(fmt::format("--opacity: '{}' is not layer=0..1, such as solids=0.5", item));
    state.layers[layer_of("--opacity", item.substr(0, equals))].opacity = static_cast<float>(*opacity);
  }
  if (o.slice.plane || !o.slice.at.empty()) state.layers[Layer::slice].visible = true;
  if (o.heat) state.layers[Layer::heat].visible = true;
  state.skin_colour = o.heat.value_or(SkinColour::pressure);
  state.explode = o.explode;
  state.time.slot = o.slot;
  state.dark = o.dark;
  state.fine = o.fine;
  return state;
}

void place_slice(ViewState& state, const AskedSlice& asked, const Picture& picture) {
  Transform& T = state.slice.T_world_slice;
  const std::string_view letters = word_of(setup::plane_words, asked.plane.value_or(setup::Plane::xz));
  for (int column = 0; column < 2; ++column) {
    T[column] = Vec4(0);
    T[column][letters[static_cast<std::size_t>(column)] - 'x'] = 1;
  }
  T[2] = Vec4(glm::cross(Vec3(T[0]), Vec3(T[1])), 0);
  const Box touch = extent(picture, Extent::touch, state);
  T[3] = Vec4(!asked.at.empty() ? point("--slice-at", asked.at) : touch.empty() ? Vec3(0) : touch.centre(), 1);
  state.slice.size_m = Vec2(asked.size_m);
}

Box home_of(const ViewerOptions& o, const Picture& picture, const ViewState& state) {
  return extent(picture, o.frame.value_or(picture.transducers.empty() ? Extent::objects : Extent::all), state);
}

Viewpoint first_viewpoint(const ViewerOptions& o, const Picture& picture, const ViewState& state, const Size& size) {
  const double ratio = o.pixel_ratio.value_or(1);
  Viewpoint viewpoint{.orthographic = o.orthographic};
  if (o.inset && !picture.fingers.empty()) viewpoint.covered_right = inset_share;
  if (state.layers.shows(Layer::legend)) viewpoint.covered_left = chart_share(picture, size.width, size.height, ratio);
  if (o.guided) viewpoint.covered_left = guidance_share;
  viewpoint.covered_below = bars_share(picture, state.layers, size.width, size.height, ratio);
  if (!o.eye.empty()) {
    look(viewpoint, point("--eye", o.eye), o.target.empty() ? Vec3(0) : point("--target", o.target));
    return viewpoint;
  }
  const Box home = home_of(o, picture, state);
  const StandardView view = *value_of(view_words, standard_view(o));
  if (view == StandardView::camera) {
    look(viewpoint, camera_of(o, picture).frustum, home.empty() ? Vec3(0) : home.centre());
    return viewpoint;
  }
  look(viewpoint, view);
  fit(viewpoint, home, static_cast<double>(std::max(size.width, 1u)) / std::max(size.height, 1u));
  return viewpoint;
}

Participant participant_of(const ViewerOptions& o) {
  Participant participant =
      participant_before(o.screen.empty() ? o.input.rig : o.screen, "; give a rig with one as --screen", o, o.stereo);
  if (!o.eye.empty()) participant.screen.eye_m = point("--eye", o.eye);
  const Eyes eyes = eyes_before(participant.screen, o.eyes_apart_m);
  for (const Vec3& eye : {eyes.left, eyes.right})
    (void)onto(participant.screen, eye);
  return participant;
}

namespace {

/// Whether the picture has a close-up of the touch. A live run has one without --inset if the touch is small in it.
bool wants_close_up(const ViewerOptions& o, const Viewpoint& viewpoint, const Picture& picture, const Size& size) {
  constexpr double small = 0.2;  // of the picture's height
  if (picture.fingers.empty() || o.inset || o.guided || !o.is_live()) return o.inset && !picture.fingers.empty();
  const Box touch = extent(picture, Extent::touch);
  return glm::length(touch.high - touch.low) < small * size.height * metres_per_pixel(viewpoint, size.height);
}

}  // namespace

std::vector<View> views_from(const Viewpoint& viewpoint, const ViewerOptions& o, const Picture& picture,
                             const Size& size, double ratio) {
  std::vector<View> views{whole(viewpoint, size.width, size.height)};
  if (wants_close_up(o, viewpoint, picture, size)) {
    views.push_back(close_up(viewpoint, extent(picture, Extent::touch), size.width, size.height, ratio));
  }
  return views;
}

}  // namespace palpa::viewer
