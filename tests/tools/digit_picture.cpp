#include "digit_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/matrix.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "drawing/axes.hpp"
#include "drawing/canvas.hpp"
#include "drawing/ink.hpp"
#include "drawing/png.hpp"
#include "hand_chain.hpp"
#include "hand_truth.hpp"
#include "touch/fingers/sight.hpp"

namespace palpa::test {
namespace {

using drawing::Align;
using drawing::Colour;
using drawing::Ink;
using drawing::rgb;

constexpr std::size_t most_shown = 2;       // cameras
constexpr double around_m = 2.5e-3;         // skin this far above the surface is still shown
constexpr std::uint32_t rim = 3, cell = 9;  // pixels around the digit; the picture's per camera pixel
constexpr std::uint32_t gap = 26, top = 34, above = 18, below = 44;  // of the picture

/// A digit in one frame.
struct Shown {
  std::size_t frame = 0;
  std::uint32_t digit = 0;
};

/// The pixels of a camera that show the digit.
struct View {
  std::size_t camera = 0;
  std::uint32_t left = ~0U, low = ~0U, right = 0, high = 0, pixels = 0;

  void add(std::uint32_t u, std::uint32_t v) {
    left = std::min(left, u), right = std::max(right, u);
    low = std::min(low, v), high = std::max(high, v);
    ++pixels;
  }
  std::uint32_t width() const { return (right - left + 1) * cell; }
  std::uint32_t height() const { return (high - low + 1) * cell; }
};

enum Kind : std::size_t { nothing, outside, firm_contact, loose_contact, deep };
struct Shade {
  const char* says;
  Colour own, other;  ///< of the digit, and of other skin
};
constexpr std::array<Shade, 5> shades{{{"no data", rgb(0xffffff), rgb(0xffffff)},
                                       {"above the surface", rgb(0xb9c2cb), rgb(0xe4e8ec)},
                                       {"contact", rgb(0xd55e00), rgb(0xf3cfb3)},
                                       {"contact, not firm", rgb(0xf0b429), rgb(0xfae9bf)},
                                       {"deeper", rgb(0x0072b2), rgb(0xb3d4e7)}}};

class Digit {
 public:
  Digit(const RatedHand& hand, const char* name) : hand_(hand), name_(name), truth_(hand), shown_(choose()) {
    frame_ = truth_.at(hand_.time_of(shown_.frame));
    film(sensing::Noise::none, exact_);
    film(sensing::Noise::d415, noisy_);
    for (std::size_t c = 0; c < hand_.cameras.size(); ++c)
      views_.push_back(view_of(c));
    std::erase_if(views_, [](const View& view) { return view.pixels == 0; });
    if (views_.empty()) throw failure(fmt::format("no camera sees the digit of {} {}", name, hand.seed));
    std::ranges::stable_sort(views_, std::ranges::greater{}, &View::pixels);
    if (views_.size() > most_shown) views_.resize(most_shown);
    std::ranges::sort(views_, {}, &View::camera);
  }
  drawing::Pixels draw();

 private:
  struct Pixel {
    Kind kind = nothing;
    bool own = false;
  };

  Shown choose();
  void film(sensing::Noise noise, sensing::FrameSet& set) const;
  View view_of(std::size_t c);
  Vec3 place(const sensing::FrameSet& set, std::size_t c, std::uint32_t u, std::uint32_t v) const;
  double depth(const Vec3& place) const;
  Pixel look(const sensing::FrameSet& set, std::size_t c, std::uint32_t u, std::uint32_t v) const;
  std::string panel(drawing::Canvas& canvas, const sensing::FrameSet& set, const View& view, std::uint32_t left,
                    std::uint32_t from_top) const;

  const RatedHand& hand_;
  const char* name_;
  HandTruth truth_;
  Shown shown_;
  TrueFrame frame_;
  sensing::FrameSet exact_, noisy_;
  std::vector<View> views_;
  const sensing::RayTables tables_ = sensing::make_rays(hand_.cameras);
  const std::vector<touch::SightCamera> sight_ = touch::sight_cameras(hand_.cameras, tables_);
};

/// The visible digit with the most contacts that is no finger of its own.
std::optional<std::uint32_t> missed(const HandTruth& truth, const TrueFrame& frame, const touch::Touch& touch) {
  std::vector<bool> found(frame.contacts.size(), false);
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    std::vector<int> of(frame.contacts.size(), 0);
    for (const std::uint32_t i : touch.fingers[f].contacts)
      ++of[truth.part_at(frame, Vec3(touch.contacts[i].position))];
    found[static_cast<std::size_t>(std::ranges::max_element(of) - of.begin())] = true;
  }
  std::optional<std::uint32_t> most;
  for (std::uint32_t p = 0; p < found.size(); ++p) {
    if (!found[p] && frame.contacts[p] >= 5 && (!most || frame.contacts[p] > frame.contacts[*most])) most = p;
  }
  return most;
}

Shown Digit::choose() {
  HandChain chain(hand_, {});
  sensing::SyntheticRig rig(hand_.cameras, {}, sensing::Noise::d415, hand_.seed);
  sensing::FrameSet set;
  std::vector<Shown> wrong;
  for (std::size_t k = 0; k < hand_.frames(); ++k) {
    const double time_s = hand_.time_of(k);
    std::vector<sensing::Posed> skin;
    for (const HandBody& body : hand_.bodies)
      skin.push_back({&body.skin->mesh, body.pose(time_s)});
    rig.render(skin, k, set);
    chain.see(set.frames, time_s);
    const TrueFrame& frame = truth_.at(time_s);
    const touch::Touch& seen = chain.seen();
    if (time_s < 0.1 || (seen.finger_count >= frame.least && seen.finger_count <= frame.most)) continue;
    if (const auto digit = missed(truth_, frame, seen)) wrong.push_back({k, *digit});
  }
  if (!wrong.empty()) return wrong[wrong.size() / 2];
  const std::size_t last = hand_.frames() - 1;
  const TrueFrame& frame = truth_.at(hand_.time_of(last));
  std::uint32_t nearest = 0;
  for (std::uint32_t p = 0; p < frame.depth_m.size(); ++p) {
    if (std::abs(frame.depth_m[p]) < std::abs(frame.depth_m[nearest])) nearest = p;
  }
  return {last, nearest};
}

void Digit::film(sensing::Noise noise, sensing::FrameSet& set) const {
  sensing::SyntheticRig rig(hand_.cameras, {}, noise, hand_.seed);
  std::vector<sensing::Posed> skin;
  for (std::size_t b = 0; b < hand_.bodies.size(); ++b)
    skin.push_back({&hand_.bodies[b].skin->mesh, frame_.T_world_body[b]});
  rig.render(skin, shown_.frame, set);
}

Vec3 Digit::place(const sensing::FrameSet& set, std::size_t c, std::uint32_t u, std::uint32_t v) const {
  const touch::SightCamera& camera = sight_[c];
  const glm::vec2& ray = tables_.rays[camera.first_pixel + std::size_t{v} * camera.pitch + u];
  const double z = set.frames[c].depth[std::size_t{v} * camera.width + u] * hand_.cameras[c].depth_unit_m;
  return transform_point(hand_.cameras[c].T_world_camera, Vec3(ray.x * z, ray.y * z, z));
}

double Digit::depth(const Vec3& place) const {
  double deepest = -1;
  for (const geometry::Solid& solid : hand_.solids)
    deepest = std::max(deepest, geometry::depth(solid, place));
  return deepest;
}

Digit::Pixel Digit::look(const sensing::FrameSet& set, std::size_t c, std::uint32_t u, std::uint32_t v) const {
  if (set.frames[c].depth[std::size_t{v} * hand_.cameras[c].width + u] == 0) return {};
  const Vec3 at = place(set, c, u, v);
  const bool own = truth_.part_at(frame_, at) == shown_.digit;
  const double depth_m = depth(at);
  if (depth_m <= 0) return {outside, own};
  if (depth_m >= touch::FingerOptions().delta_m) return {deep, own};
  const touch::Sight sight{sight_, tables_, set.frames};
  const std::uint32_t point = sight_[c].first_index + v * sight_[c].width + u;
  return {touch::is_firm(sight, point) ? firm_contact : loose_contact, own};
}

View Digit::view_of(std::size_t c) {
  View view{c};
  const sensing::Camera& camera = hand_.cameras[c];
  for (std::uint32_t v = 0; v < camera.height; ++v) {
    for (std::uint32_t u = 0; u < camera.width; ++u) {
      if (exact_.frames[c].depth[std::size_t{v} * camera.width + u] == 0) continue;
      const Vec3 at = place(exact_, c, u, v);
      if (depth(at) > -around_m && truth_.part_at(frame_, at) == shown_.digit) view.add(u, v);
    }
  }
  if (view.pixels == 0) return view;
  view.left -= std::min(view.left, rim), view.low -= std::min(view.low, rim);
  view.right = std::min(view.right + rim, camera.width - 1), view.high = std::min(view.high + rim, camera.height - 1);
  return view;
}

/// Returns what stands above it.
std::string Digit::panel(drawing::Canvas& canvas, const sensing::FrameSet& set, const View& view, std::uint32_t left,
                         std::uint32_t from_top) const {
  int firm = 0, loose = 0;
  for (std::uint32_t v = view.low; v <= view.high; ++v) {
    for (std::uint32_t u = view.left; u <= view.right; ++u) {
      const Pixel pixel = look(set, view.camera, u, v);
      if (pixel.own && pixel.kind == firm_contact) ++firm;
      if (pixel.own && pixel.kind == loose_contact) ++loose;
      const std::uint32_t x = left + (u - view.left) * cell, y = from_top + (v - view.low) * cell;
      canvas.fill(x, y, x + cell - 2, y + cell - 2, pixel.own ? shades[pixel.kind].own : shades[pixel.kind].other);
    }
  }
  return fmt::format("contacts {}, firm {}", firm + loose, firm);
}

drawing::Pixels Digit::draw() {
  constexpr double letters = 9;
  std::uint32_t width = 0, height = top;
  for (const View& view : views_) {
    width = std::max({width, 3 * gap + 2 * std::max(view.width(), 200U)});
    height += view.height() + above + gap;
  }
  width = std::max(width, 600U);
  drawing::Canvas canvas(width, height + below, drawing::picture_paper);
  std::vector<shader::ViewStroke> strokes;
  Ink ink(1, drawing::picture_paper, strokes);
  const std::uint32_t part = shown_.digit % hand_parts;
  constexpr std::array digits{"thumb", "index finger", "middle finger", "ring finger", "little finger", "palm"};
  ink.text(
      fmt::format("{} {}: {}, deepest skin {:.2f} mm {} the surface", name_, hand_.seed,
                  hand_.bodies[truth_.body_of(shown_.digit)].skin->parts == 1 ? "finger" : digits[part],
                  std::abs(frame_.depth_m[shown_.digit]) * 1e3, frame_.depth_m[shown_.digit] > 0 ? "below" : "above"),
      {gap, 20}, 10, drawing::axis_ink);
  std::uint32_t y = top + above;
  for (const View& view : views_) {
    const std::uint32_t second = gap + std::max(view.width(), (width - 3 * gap) / 2) + gap;
    const std::string exact = panel(canvas, exact_, view, gap, y), noisy = panel(canvas, noisy_, view, second, y);
    ink.text(fmt::format("camera {}, no noise: {}", view.camera + 1, exact), {gap, y - 7.0}, letters,
             drawing::note_ink);
    ink.text(fmt::format("with noise: {}", noisy), {second, y - 7.0}, letters, drawing::note_ink);
    for (const std::uint32_t x : {gap, second})
      drawing::frame(ink, x - 1.0, y - 1.0, view.width(), view.height());
    y += view.height() + above + gap;
  }
  double x = gap;
  for (const Shade& shade : shades) {
    ink.swatch({x + 9.5, y - above + 2.0}, shade.own, drawing::note_ink);
    ink.text(shade.says, {x + 23, y - above + 6.0}, letters, drawing::axis_ink);
    x += 23 + drawing::text_width(shade.says, letters) + 16;
  }
  const sensing::Camera& camera = hand_.cameras[views_.front().camera];
  const Vec3 eye = transform_point(glm::inverse(camera.T_world_camera), Vec3(0));
  ink.text(fmt::format("Squares are pixels, {:.1f} mm at the surface. Pale: other skin.", eye.z / camera.fx * 1e3),
           {gap, y - above + 24.0}, letters, drawing::note_ink);
  canvas.draw(strokes);
  return canvas.pixels();
}

}  // namespace

void draw_digit(const RatedHand& hand, const char* name, const std::filesystem::path& file) {
  drawing::write_png(file, Digit(hand, name).draw());
}

}  // namespace palpa::test
