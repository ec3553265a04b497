#include "viewer/render/overlay.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "base/text.hpp"
#include "drawing/ink.hpp"
#include "viewer/hands/slice_hand.hpp"
#include "viewer/picture/backing.hpp"
#include "viewer/picture/chart.hpp"
#include "viewer/picture/colour_bars.hpp"
#include "viewer/picture/palette.hpp"

namespace palpa::viewer {

using drawing::Align;
using drawing::Ink;
using drawing::text_size;

namespace {

struct Placed {
  Vec2 at;
  double depth;
  std::size_t index;
};

void draw_camera_names(Ink& ink, const Picture& picture, const shader::ViewPush& projection, const Theme& theme) {
  for (const CameraMark& mark : picture.cameras) {
    const Projected p = project(projection, Vec3(mark.apex));
    if (p.visible) ink.label(mark.name, Vec2(p.x, p.y - ink.px(8)), 8, theme.faint_ink, Align::centre);
  }
}

/// Above each solid, if there are several, and few enough to be told apart.
void draw_solid_names(Ink& ink, const Picture& picture, const shader::ViewPush& projection, const Theme& theme) {
  constexpr std::ptrdiff_t most = 8;
  const auto named = [](const SurfaceMark& solid) { return solid.name_at.has_value(); };
  const std::ptrdiff_t count = std::ranges::count_if(picture.solids, named);
  if (count < 2 || count > most) return;
  for (const SurfaceMark& solid : picture.solids) {
    if (!solid.name_at) continue;
    const Projected p = project(projection, *solid.name_at);
    if (p.visible) ink.label(solid.name.substr(0, 40), Vec2(p.x, p.y - ink.px(5)), 9, theme.ink, Align::centre, 1.1);
  }
}

/// w1, w2 and w3 at the ends of a cross-section's axes.
void draw_axis_names(Ink& ink, const Picture& picture, const shader::ViewPush& projection, const Theme& theme) {
  for (std::size_t f = 0; f < picture.fingers.size(); ++f) {
    const auto& section = picture.fingers[f].section;
    if (!section) continue;
    const Projected centre = project(projection, Vec3(section->centre));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Projected tip = project(projection, Vec3(section_tip(*section, axis)));
      const Vec2 way(tip.x - centre.x, tip.y - centre.y);
      // Too short to tell from the others: far away, or seen from its end.
      if (!tip.visible || !centre.visible || glm::length(way) < ink.px(18)) continue;
      const Vec2 at = Vec2(tip.x, tip.y) + ink.px(9) * glm::normalize(way);
      const Colour colour = mix(finger_colour(static_cast<std::uint32_t>(f)), theme.ink, 0.35f);
      ink.label(fmt::format("w{}", axis + 1), at + Vec2(0, ink.px(3)), 8, colour, Align::centre, 1.2);
    }
  }
}

/// A cross that leaves its middle free.
void draw_picked(Ink& ink, const Vec3& picked, const shader::ViewPush& projection, const Theme& theme) {
  const Projected p = project(projection, picked);
  if (!p.visible) return;
  const Vec2 at(p.x, p.y);
  for (const double width : {4.0, 1.4}) {
    const Colour& colour = width > 2 ? theme.background : theme.ink;
    ink.ring(at, 6, width, colour);
    for (const Vec2 way : {Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1)})
      ink.line(at + ink.px(6) * way, at + ink.px(12) * way, width, colour);
  }
}

/// The handles of a plane that the user may drag, and the frame that they move.
void draw_slice_handles(Ink& ink, const SliceState& slice, const shader::ViewPush& projection, const Theme& theme) {
  const auto at = [&](const Vec3& world) { return project(projection, world); };
  const Projected middle = at(place_of(SliceHandle::middle, slice)), tip = at(normal_tip(slice));
  const auto line = [&](const Projected& a, const Projected& b) {
    if (!a.visible || !b.visible) return;
    for (const double width : {3.6, 1.6})
      ink.line({a.x, a.y}, {b.x, b.y}, width, width > 2 ? theme.background : theme.ink);
  };
  for (const SliceHandle end : {SliceHandle::x_end, SliceHandle::y_end})
    line(middle, at(place_of(end, slice)));
  line(middle, tip);
  for (const SliceHandle handle : slice_handles) {
    const Projected p = at(place_of(handle, slice));
    if (!p.visible) continue;
    ink.disc({p.x, p.y}, 7, theme.background);
    ink.disc({p.x, p.y}, 5.5, theme.ink);
    if (handle != SliceHandle::middle) ink.disc({p.x, p.y}, 3, theme.background);
  }
}

void draw_finger(Ink& ink, const FingerMarks& finger, std::uint32_t index, const shader::ViewPush& projection,
                 const Theme& theme) {
  const Colour colour = finger_colour(index);
  std::vector<Placed> placed;
  for (std::size_t i = 0; i < finger.foci.size(); ++i) {
    const Projected p = project(projection, Vec3(finger.foci[i].position));
    if (p.visible) placed.push_back({{p.x, p.y}, p.depth, i});
  }
  if (placed.empty()) return;
  // As large as the gaps between neighbours allow, so that a distant finger is small dots instead of one blot.
  double nearest = 1e9;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    for (std::size_t j = i + 1; j < placed.size(); ++j) {
      const double gap = glm::distance(placed[i].at, placed[j].at);
      if (finger.foci[placed[i].index].own && finger.foci[placed[j].index].own && gap > 1e-3) {
        nearest = std::min(nearest, gap);
      }
    }
  }
  double span = 0;
  for (const Placed& p : placed)
    span = std::max(span, glm::distance(p.at, placed[0].at));
  const double radius = std::clamp(std::max(0.46 * nearest, 0.1 * span) / ink.px(1), 2.2, 10.5);
  const bool open = !finger.sensation.empty(), numbered = radius >= 6.0 && !open;

  const std::size_t lines = placed.size() > 1 && !finger.together ? placed.size() - (open ? 1 : 0) : 0;
  for (std::size_t i = 0; i < lines; ++i) {
    ink.line(placed[i].at, placed[(i + 1) % placed.size()].at, 1.3, with_alpha(mix(colour, theme.ink, 0.25f), 0.75f));
  }
  std::stable_sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) { return a.depth > b.depth; });
  // The running focus comes last, so it is on top.
  std::stable_partition(placed.begin(), placed.end(), [&](const Placed& p) { return finger.running != p.index; });
  for (const Placed& p : placed) {
    const FocusMark& focus = finger.foci[p.index];
    const bool running = finger.together || finger.running == p.index;
    if (!focus.own && !running) continue;
    if (running) ink.disc(p.at, radius + 5.5, with_alpha(colour, 0.30f));
    ink.disc(p.at, radius + (running ? 1.6 : 0.9), theme.background);
    ink.disc(p.at, radius + (running ? 0.8 : 0.1), colour);
    if (!running) ink.disc(p.at, radius - std::min(1.6, 0.4 * radius), rgb(0xffffff));
    if (numbered && focus.own && !finger.together) {
      const std::string number = fmt::format("{}", focus.number);
      const double size = number.size() > 1 ? radius * 0.80 : radius * 0.95;
      ink.text(number, p.at + Vec2(0, ink.px(size / 2)), size, running ? rgb(0xffffff) : rgb(0x1f2933), Align::centre,
               1.1);
    }
  }
}

/// A line of the legend: a sign, drawn around its middle, and words.
struct Entry {
  std::function<void(const Vec2& middle)> sign;
  std::string words;
};

std::string names_of_solids(const Picture& picture) {
  std::string names;
  std::size_t named = 0;
  for (const SurfaceMark& solid : picture.solids) {
    if (solid.part.value_or(0) != 0) continue;  // named with its first part
    if (named < 4) {
      names += (named > 0 ? ", " : "") + solid.name.substr(0, 40);
      if (!solid.feel.empty() && solid.feel != solid.name) names += fmt::format(" ({})", solid.feel);
    }
    ++named;
  }
  return named > 4 ? names + fmt::format(" and {} more", named - 4) : names;
}

std::string words_of(const FingerMarks& finger, std::size_t index) {
  if (!finger.sensation.empty()) return finger.sensation;
  const auto own = std::count_if(finger.foci.begin(), finger.foci.end(), [](const FocusMark& m) { return m.own; });
  std::string foci = counted(static_cast<std::size_t>(own), "focus");
  if (own != 1) foci = fmt::format("{} foci {}", own, finger.together ? "at once" : "in order");
  return fmt::format("finger {}: {}, {}", index, counted(finger.contacts, "contact"), foci);
}

std::vector<Entry> legend_entries(Ink& ink, const Picture& picture, const Layers& layers, const Theme& theme) {
  std::vector<Entry> entries;
  const auto disc = [&ink](double radius, const Colour& colour) {
    return [&ink, radius, colour](const Vec2& at) { ink.disc(at, radius, colour); };
  };
  if (!picture.solids.empty() && (layers.shows(Layer::solids) || layers.shows(Layer::edges)))
    entries.push_back({[&](const Vec2& at) { ink.swatch(at, theme.solid_rim, theme.edge); }, names_of_solids(picture)});
  if (picture.skin && layers.shows(Layer::skin))
    entries.push_back({[&](const Vec2& at) { ink.swatch(at, theme.skin_rim, theme.skin_point); }, picture.skin->name});
  if (picture.skin_count > 0 && layers.shows(Layer::points))
    entries.push_back({disc(3, theme.skin_point), counted(picture.skin_count, "skin point")});
  if (picture.dropped_count > 0 && layers.shows(Layer::points)) {
    entries.push_back(
        {disc(3, theme.dropped_point), fmt::format("{}, no skin", counted(picture.dropped_count, "point"))});
  }
  std::size_t loose = 0;
  for (const ContactMark& c : picture.contacts)
    loose += c.finger ? 0 : 1;
  constexpr std::size_t most_fingers = 8;
  for (std::size_t f = 0; f < std::min(picture.fingers.size(), most_fingers); ++f) {
    const Colour colour = finger_colour(static_cast<std::uint32_t>(f));
    const auto sign = [&ink, colour](const Vec2& at) {
      ink.disc(at - Vec2(ink.px(5), 0), 3.4, colour);
      ink.disc(at + Vec2(ink.px(5), 0), 5, colour);
      ink.disc(at + Vec2(ink.px(5), 0), 3.5, rgb(0xffffff));
    };
    entries.push_back({sign, words_of(picture.fingers[f], f)});
  }
  if (picture.fingers.size() > most_fingers)
    entries.push_back({{}, fmt::format("and {} more", counted(picture.fingers.size() - most_fingers, "finger"))});
  if (loose > 0 && layers.shows(Layer::contacts))
    entries.push_back({disc(3.4, theme.loose_contact), fmt::format("{} of no finger", counted(loose, "contact"))});
  if (!picture.transducers.empty() && !picture.driven && layers.shows(Layer::transducers))
    entries.push_back({disc(4, theme.idle_transducer), counted(picture.transducers.size(), "transducer")});
  return entries;
}

/// As much of the words as is no wider.
std::string cut_to(std::string words, double height, double width) {
  if (drawing::text_width(words, height) <= width) return words;
  while (!words.empty() && drawing::text_width(words + "...", height) > width)
    words.pop_back();
  return words + "...";
}

/// At the top left. Returns its lower right corner; the top left of the picture if there is nothing to say.
Vec2 draw_legend(Ink& ink, const Picture& picture, const Layers& layers, double width, const Theme& theme) {
  const double x = ink.px(22), line_height = ink.px(19), letters = ink.px(text_size), title_letters = 1.3 * letters;
  const double room = std::max(width - 2 * x, 1.0), indent = ink.px(20);
  std::vector<Entry> entries = legend_entries(ink, picture, layers, theme);
  const std::string title = cut_to(picture.title, title_letters, room);
  double right = title.empty() ? 0 : x + drawing::text_width(title, title_letters);
  for (Entry& entry : entries) {
    entry.words = cut_to(std::move(entry.words), letters, room - indent);
    right = std::max(right, x + indent + drawing::text_width(entry.words, letters));
  }
  if (right == 0) return {0, 0};
  double y = ink.px(30);
  const double lines = static_cast<double>(entries.size()) + (title.empty() ? 0 : 1.35);
  const Vec2 low(x - ink.px(10), y - letters - ink.px(7)),
      high(right + ink.px(10), low.y + lines * line_height + ink.px(5));
  draw_backing(ink, low, high, theme);
  if (!title.empty()) {
    ink.text(title, {x, y}, text_size * 1.3, theme.ink, Align::left, 1.15);
    y += line_height * 1.35;
  }
  for (const Entry& entry : entries) {
    if (entry.sign) entry.sign({x + ink.px(5), y - letters / 2});
    ink.text(entry.words, {x + indent, y}, text_size, theme.ink);
    y += line_height;
  }
  if (picture.untouched.empty()) return high;
  // Without a backing: the line is long, and the finger is often behind it.
  ink.label(cut_to("nothing touches: " + picture.untouched, letters, room), {x, y + ink.px(4)}, text_size, theme.ink);
  return high + Vec2(0, line_height);
}

/// Phase as hue around a wheel, amplitude as brightness from its centre outwards. At the top right; below the legend if
/// there is no room beside it.
void draw_drive_wheel(Ink& ink, const Picture& picture, const Vec2& legend, double width, double height,
                      const Theme& theme) {
  const double radius = 26, half = 66, above = 44, below = 68;
  Vec2 centre(width - ink.px(half + 18), ink.px(64));
  if (legend.x > centre.x - ink.px(half)) centre = Vec2(ink.px(half + 12), legend.y + ink.px(above + 6));
  const double axes = ink.px(104);
  if (centre.x + ink.px(half) > width || centre.y + ink.px(below) + axes > height) return;
  draw_backing(ink, centre - Vec2(ink.px(half), ink.px(above)), centre + Vec2(ink.px(half), ink.px(below)), theme);
  constexpr int sectors = 96, rings = 9;
  for (int ring = 0; ring < rings; ++ring) {
    const double r = ink.px(radius * (ring + 0.5) / rings);
    for (int s = 0; s < sectors; ++s) {
      const double from = 2 * std::numbers::pi * s / sectors, to = 2 * std::numbers::pi * (s + 1) / sectors;
      const Colour c = drive_colour(static_cast<float>((ring + 0.5) / rings), static_cast<float>((from + to) / 2));
      ink.line(centre + r * Vec2(std::cos(from), -std::sin(from)), centre + r * Vec2(std::cos(to), -std::sin(to)),
               radius / rings + 0.6, c);
    }
  }
  ink.text("0", centre + Vec2(ink.px(radius + 9), ink.px(4)), 8, theme.ink);
  ink.text("\u03c0", centre + Vec2(-ink.px(radius + 9), ink.px(4)), 8, theme.ink, Align::right);
  ink.text("hue: phase", centre + Vec2(0, -ink.px(radius + 8)), 8, theme.ink, Align::centre);
  ink.text("brightness: amplitude", centre + Vec2(0, ink.px(radius + 18)), 8, theme.ink, Align::centre);
  ink.text(counted(picture.transducers.size(), "transducer"), centre + Vec2(0, ink.px(radius + 36)), 8, theme.ink,
           Align::centre);
}

void draw_axes(Ink& ink, const Viewpoint& viewpoint, double height) {
  constexpr std::array names{"x", "y", "z"};
  const Basis b = basis(viewpoint);
  const Vec2 origin(ink.px(52), height - ink.px(52));
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int i, int j) { return b.forward[i] > b.forward[j]; });
  for (const int i : order) {
    const Vec2 d(b.right[i], -b.up[i]);
    if (glm::length(d) < 0.08) continue;  // end-on: a letter on the origin would only blot it
    const Colour& colour = axis_colours[i];
    ink.line(origin, origin + ink.px(28) * d, 2, colour);
    const Vec2 at = origin + ink.px(28) * d + ink.px(9) * d / glm::length(d);
    ink.label(names[static_cast<std::size_t>(i)], at + Vec2(0, ink.px(3)), text_size, colour, Align::centre, 1.2);
  }
}

/// At the lower right; above the chart if there is no room beside it.
void draw_scale(Ink& ink, const Picture& picture, const Viewpoint& viewpoint, const OverlayOptions& options,
                const Theme& theme) {
  // Metres at the target's depth. Taken from the projection, because a frustum does not come from the orbit.
  const double at_one = projection(viewpoint, options.width, options.height).window.z;
  const double per_pixel = (viewpoint.orthographic ? 1 : viewpoint.distance) / at_one;
  const double length = scale_bar_length(std::min(ink.px(150), options.width * 0.3) * per_pixel);
  const double pixels = length / per_pixel;
  const double below =
      options.inset ? 0 : chart_in_the_way(picture, options.width, options.height, options.ratio, pixels + ink.px(40));
  const Vec2 right(options.width - ink.px(24), options.height - ink.px(28) - below), left = right - Vec2(pixels, 0);
  const Vec2 tick(0, ink.px(4));
  draw_backing(ink, left - Vec2(ink.px(10), ink.px(22)), right + Vec2(ink.px(10), ink.px(8)), theme);
  ink.line(left, right, 1.6, theme.ink);
  ink.line(left - tick, left + tick, 1.6, theme.ink);
  ink.line(right - tick, right + tick, 1.6, theme.ink);
  ink.label(fmt::format("{:g} mm", length * 1e3), (left + right) * 0.5 - Vec2(0, ink.px(9)), text_size, theme.ink,
            Align::centre);
}

}  // namespace

double scale_bar_length(double longest_m) {
  if (!(longest_m > 1e-9) || longest_m > 1e9) return 1e-3;
  const double power = std::pow(10.0, std::floor(std::log10(longest_m) + 1e-9));
  const double mantissa = longest_m / power;
  return power * (mantissa >= 5 ? 5 : mantissa >= 2 ? 2 : 1);
}

void build_overlay(const Picture& picture, const ViewState& state, const Viewpoint& viewpoint,
                   const OverlayOptions& options, std::vector<shader::ViewStroke>& strokes) {
  const Layers& layers = state.layers;
  const Theme& theme = theme_of(state.dark);
  Ink ink(options.ratio, theme.background, strokes);
  const shader::ViewPush view = projection(viewpoint, options.width, options.height);
  /// Draws the strokes of a layer with its opacity.
  const auto in_layer = [&](Layer layer, const auto& draw) {
    if (!layers.shows(layer)) return;
    const std::size_t first = strokes.size();
    draw();
    for (std::size_t i = first; i < strokes.size(); ++i)
      strokes[i].colour.w *= layers.opacity(layer);
  };
  in_layer(Layer::cameras, [&] { draw_camera_names(ink, picture, view, theme); });
  in_layer(Layer::sections, [&] { draw_axis_names(ink, picture, view, theme); });
  in_layer(Layer::foci, [&] {
    for (std::size_t f = 0; f < picture.fingers.size(); ++f)
      draw_finger(ink, picture.fingers[f], static_cast<std::uint32_t>(f), view, theme);
  });
  if (state.slice_handles && !options.inset)
    in_layer(Layer::slice, [&] { draw_slice_handles(ink, state.slice, view, theme); });
  if (state.picked) draw_picked(ink, *state.picked, view, theme);
  if (options.inset) {
    const Vec2 far(options.width, options.height);
    const std::array<Vec2, 4> corners{Vec2(0, 0), Vec2(far.x, 0), far, Vec2(0, far.y)};
    for (std::size_t i = 0; i < 4; ++i)
      ink.line(corners[i], corners[(i + 1) % 4], 2, theme.faint_ink);
    in_layer(Layer::legend, [&] { draw_scale(ink, picture, viewpoint, options, theme); });
    return;
  }
  if (layers.shows(Layer::solids) || layers.shows(Layer::edges))
    in_layer(Layer::legend, [&] { draw_solid_names(ink, picture, view, theme); });
  in_layer(Layer::legend, [&] {
    const Vec2 legend = draw_legend(ink, picture, layers, options.width, theme);
    if (picture.driven && layers.shows(Layer::transducers))
      draw_drive_wheel(ink, picture, legend, options.width, options.height, theme);
    draw_axes(ink, viewpoint, options.height);
    draw_scale(ink, picture, viewpoint, options, theme);
    draw_chart(ink, picture, options.width, options.height, theme);
    draw_bars(ink, picture, layers, options.width, options.height,
              chart_share(picture, options.width, options.height, options.ratio), theme);
  });
}

}  // namespace palpa::viewer
