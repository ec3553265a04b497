#include "viewer/viewer_options.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>

#include "base/error.hpp"
#include "setup/values.hpp"
#include "viewer/chart.hpp"

namespace palpa::viewer {
namespace {

bool has_skin(const ViewerOptions& o) {
  return !o.input.points.empty() || !o.input.depths.empty();
}

Vec3 point(const std::string& option, const std::string& text) {
  const auto p = setup::parse_point(option, text);
  return {p[0], p[1], p[2]};
}

}  // namespace

void add_options(CLI::App& app, ViewerOptions& o) {
  setup::add_touch_input(app, o.input);
  setup::add_touch_options(app, o.touch);
  setup::add_felt_options(app, o.felt);
  const setup::Group array(app, "Array");
  array.text("--layout", o.layout, "NAME|FILE",
             "array to draw: autd3, paper, openmpd, openmpd-pair, sonicsurface or a TOML");
  array.integer("--slot", o.slot, 0, std::uint64_t{1} << 40,
                "first slot to show: its focus is highlighted, its drive coloured");
  setup::add_drive_options(app, o.drive);

  const setup::Group what(app, "Picture");
  what.text("--skin", o.skin, "FILE",
            "surface of the finger or hand as PLY, drawn faintly; --penetration moves it too");
  what.text("--title", o.title, "TEXT", "above the legend");
  what.flag("--show-cameras", o.show_cameras, "draw the cameras of --depth");
  what.flag("--dark", o.dark, "dark background");
  what.flag("--no-legend", o.no_legend, "neither legend nor axes nor scale");
  what.flag("--no-grid", o.no_grid, "no grid");

  const setup::Group where(app, "View");
  where.choice("--view", o.view, view_words, "from where; camera: as the first camera of --depth sees it");
  where.text("--eye", o.eye, "X,Y,Z", "in place of --view: the eye, looking at --target");
  where.text("--target", o.target, "X,Y,Z", "what --eye looks at [0,0,0]");
  where.choice("--frame", o.frame, {{"touch", Extent::touch}, {"objects", Extent::objects}, {"all", Extent::all}},
               "what fills the picture, normally all where an array is drawn, else objects");
  where.flag("--ortho", o.orthographic, "parallel projection");
  where.flag("--inset", o.inset, "a close-up of the touch in the corner");

  const setup::Group how(app, "Without a window");
  how.flag("--headless", o.headless, "open no window");
  how.integer("--frames", o.frames, 1, 1'000'000, "frames to draw, a slot each, then exit [headless: 1]");
  how.text("--screenshot", o.screenshot, "FILE", "write the last frame as PNG");
  how.text("--size", o.size, "WxH", "of picture or window, pixels [1280x800]");
  how.number("--pixel-ratio", o.pixel_ratio, {0.5, 8}, "NUMBER", "pixels per point: how large text and lines are [1]");
  how.text("--reference", o.reference, "FILE", "compare the last frame with this PNG");
  how.number("--threshold", o.threshold, {0, 1}, "NUMBER",
             "mean difference from --reference above which the exit code is 1 [0.02]");
}

void check(const ViewerOptions& o) {
  if (o.input.scene.empty() && o.layout.empty()) {
    throw bad_usage("nothing to show: give --scene FILE, such as assets/cube.glb, or --layout NAME");
  }
  if (has_skin(o)) {
    setup::check(o.input);
    setup::check(o.touch);
    setup::check(o.felt, o.touch);
  } else if (o.felt.spectrum) {
    throw bad_usage("--spectrum goes with --points or --depth: it is of a touch");
  } else if (o.touch.spot_m) {
    throw bad_usage("--spot goes with --spectrum or --tune");
  } else if (!o.input.cameras.empty() || !o.input.rig.empty()) {
    throw bad_usage("--camera and --rig go with --depth: give the depth images");
  }
  if (o.input.penetration_m && o.input.points.empty() && o.skin.empty()) {
    throw bad_usage("--penetration moves --points and --skin: give one of them");
  }
  if (o.input.penetration_m && o.input.scene.empty()) throw bad_usage("--penetration goes with --scene");
  if (o.view == StandardView::camera && o.input.depths.empty()) throw bad_usage("--view camera goes with --depth");
  if (!o.target.empty() && o.eye.empty()) throw bad_usage("--target goes with --eye");
  if (!o.eye.empty()) {
    const Vec3 target = o.target.empty() ? Vec3(0) : point("--target", o.target);
    if (point("--eye", o.eye) == target) throw bad_usage("--eye and --target are the same point");
  }
  picture_size(o);
  if (!o.headless) {
    if (!o.screenshot.empty()) throw bad_usage("--screenshot goes with --headless");
    if (!o.reference.empty()) throw bad_usage("--reference goes with --headless");
  }
  if (o.threshold && o.reference.empty()) throw bad_usage("--threshold goes with --reference");
  setup::drive_options(o.drive);
}

Size picture_size(const ViewerOptions& o) {
  Size size;
  const char* end = o.size.data() + o.size.size();
  const auto width = std::from_chars(o.size.data(), end, size.width);
  if (width.ec == std::errc() && width.ptr != end && *width.ptr == 'x') {
    const auto height = std::from_chars(width.ptr + 1, end, size.height);
    const auto fits = [](std::uint32_t v) { return v >= 16 && v <= 8192; };
    if (height.ec == std::errc() && height.ptr == end && fits(size.width) && fits(size.height)) return size;
  }
  throw bad_usage(
      fmt::format("--size: '{}' is no size; give width x height, 16 to 8192 pixels each, such as 1280x800", o.size));
}

Box home_of(const ViewerOptions& o, const Picture& picture) {
  return extent(picture, o.frame.value_or(picture.transducers.empty() ? Extent::objects : Extent::all));
}

Viewpoint first_viewpoint(const ViewerOptions& o, const Picture& picture, const Size& size) {
  Viewpoint viewpoint;
  viewpoint.orthographic = o.orthographic;
  if (o.inset && !picture.fingers.empty()) viewpoint.covered_right = inset_share;
  if (!o.no_legend) viewpoint.covered_left = chart_share(picture, size.width, size.height, o.pixel_ratio.value_or(1));
  if (!o.eye.empty()) {
    look(viewpoint, point("--eye", o.eye), o.target.empty() ? Vec3(0) : point("--target", o.target));
    return viewpoint;
  }
  if (o.view == StandardView::camera && picture.T_world_camera) {
    look(viewpoint, *picture.T_world_camera);
  } else {
    look(viewpoint, o.view);
  }
  fit(viewpoint, home_of(o, picture), static_cast<double>(std::max(size.width, 1u)) / std::max(size.height, 1u));
  return viewpoint;
}

std::vector<View> views_from(const Viewpoint& viewpoint, const ViewerOptions& o, const Picture& picture,
                             const Size& size, double ratio) {
  std::vector<View> views{whole(viewpoint, size.width, size.height)};
  if (o.inset && !picture.fingers.empty()) {
    views.push_back(close_up(viewpoint, extent(picture, Extent::touch), size.width, size.height, ratio));
  }
  return views;
}

}  // namespace palpa::viewer
