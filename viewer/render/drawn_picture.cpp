#include "viewer/render/drawn_picture.hpp"

#include <algorithm>
#include <cstring>
#include <glm/geometric.hpp>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "viewer/picture/detail.hpp"
#include "viewer/picture/shape.hpp"
#include "viewer/view/vec4.hpp"

namespace palpa::viewer {
namespace {

constexpr float unbounded = 1e6f;

/// More surfaces than this in exactly the same place look the same. Except in a few pixels at the rims of lines,
/// another layer of a solid's colour changes less than one step of the picture's colours.
constexpr std::uint32_t enough_layers = 128;

struct BySurface {
  bool operator()(const SurfaceMark* a, const SurfaceMark* b) const {
    const auto order = [](const SurfaceMark& s) {
      return std::tuple(s.mesh.triangles.size(), s.mesh.positions.size(), s.part);
    };
    if (order(*a) != order(*b)) return order(*a) < order(*b);
    const auto compare = [](const auto& left, const auto& right) {
      return left.empty() ? 0 : std::memcmp(left.data(), right.data(), left.size() * sizeof(left[0]));
    };
    const int positions = compare(a->mesh.positions, b->mesh.positions);
    return positions != 0 ? positions < 0 : compare(a->mesh.triangles, b->mesh.triangles) < 0;
  }
};

}  // namespace

void DrawnPicture::begin_surfaces() {
  new_vertices_.clear();
  new_corners_.clear();
}

void DrawnPicture::end_surfaces(SurfaceMemory& memory, const char* name, const char* corners_name) {
  memory.vertices.fill(*device_, new_vertices_, name);
  memory.corners.fill(*device_, new_corners_, corners_name);
  memory.changed = true;
}

SurfaceItems DrawnPicture::add_surface(const SurfaceMark& surface) {
  Shape shape = make_shape(surface.mesh, surface.colours);
  SurfaceItems range;
  const auto first_vertex = static_cast<std::uint32_t>(new_vertices_.size());
  const auto append = [&](std::span<const std::uint32_t> corners) {
    const Items items{static_cast<std::uint32_t>(new_corners_.size()), static_cast<std::uint32_t>(corners.size())};
    for (const std::uint32_t corner : corners)
      new_corners_.push_back(first_vertex + corner);
    return items;
  };
  range.corners = append(shape.corners);
  // Colours must be visible everywhere.
  if (surface.colours.empty()) {
    for (const Detail& detail : coarser(shape.vertices, shape.corners))
      range.coarser.push_back({append(detail.corners), detail.error_m});
  }
  new_vertices_.insert(new_vertices_.end(), shape.vertices.begin(), shape.vertices.end());
  range.edges = std::move(shape.edges);
  range.bounds = geometry::bounds(surface.mesh);
  range.part = surface.part;
  return range;
}

void DrawnPicture::update(const Picture& picture, const ViewState& state) {
  begin_surfaces();
  solids_.clear();
  picture_.solids.clear();
  const std::vector<Vec3> ways = apart(picture.solids);
  std::map<const SurfaceMark*, std::uint32_t, BySurface> layers;
  std::size_t whole = 0;  // the first part of the solid that `around` holds
  Box around;
  for (std::size_t i = 0; i < picture.solids.size(); ++i) {
    const SurfaceMark& solid = picture.solids[i];
    if (!solid.colours.empty() || ++layers[&solid] <= enough_layers) {
      solids_.push_back(add_surface(solid));
      solids_.back().away = ways[i];
    }
    picture_.solids.push_back(
        {.name = solid.name, .mesh = {}, .part = solid.part, .solid = solid.solid, .feel = solid.feel});
    const Box box = geometry::bounds(solid.mesh);
    if (box.empty()) continue;
    if (solid.part.value_or(0) == 0) whole = i;  // its other parts follow
    if (whole == i) around = Box();
    around.add(box.low);
    around.add(box.high);
    picture_.solids[whole].name_at = Vec3(around.centre().x, around.high.y, around.centre().z);
  }
  end_surfaces(solids_memory_, "solids", "solids' corners");
  update_skin(picture, state);
}

void DrawnPicture::update_skin(const Picture& picture, const ViewState& state) {
  begin_surfaces();
  picture_.skin.reset();
  skin_has_colours_ = false;
  skin_ = {};
  if (picture.skin) {
    skin_ = add_surface(*picture.skin);
    picture_.skin = SurfaceMark{picture.skin->name, {}};
    skin_has_colours_ = !picture.skin->colours.empty();
  }
  end_surfaces(skin_memory_, "skin", "skin's corners");
  everything_ = solids_.empty() ? extent(picture, Extent::all) : Box();
  update_marks(picture, state);
}

void DrawnPicture::update_marks(const Picture& picture, const ViewState& state) {
  state_ = state;
  static_cast<PictureNotes&>(picture_) = picture;
  const Theme& theme = theme_of(state.dark);
  add_discs(picture, theme);
  build_marks(picture, state, floor(), new_marks_);
  new_vertices_ = new_marks_.boards;
  boards_ = {0, static_cast<std::uint32_t>(new_vertices_.size())};
  const auto append = [&](Items& range, const std::vector<shader::ViewVertex>& faces) {
    range = {static_cast<std::uint32_t>(new_vertices_.size()), static_cast<std::uint32_t>(faces.size())};
    new_vertices_.insert(new_vertices_.end(), faces.begin(), faces.end());
  };
  append(sections_, new_marks_.sections);
  append(tile_, new_marks_.tile);
  add_images(picture);
  lines_ = {0, static_cast<std::uint32_t>(new_marks_.lines.size())};
  face_vertices_.fill(*device_, new_vertices_, "faces");
  pixels_.fill(*device_, new_pixels_, "images");
  strokes_.fill(*device_, new_marks_.lines, "lines");
  marks_changed_ = true;
}

/// The grid lies under the objects, or, without objects, under everything.
Box DrawnPicture::floor() const {
  Box box = everything_;
  for (const SurfaceItems& solid : solids_) {
    if (solid.bounds.empty()) continue;
    box.add(solid.bounds.low + state_.explode * solid.away);
    box.add(solid.bounds.high + state_.explode * solid.away);
  }
  return box;
}

void DrawnPicture::add_discs(const Picture& picture, const Theme& theme) {
  new_discs_.clear();
  const auto begin = [&] { return Items{static_cast<std::uint32_t>(new_discs_.size()), 0}; };
  const auto end = [&](Items& range) { range.count = static_cast<std::uint32_t>(new_discs_.size()) - range.first; };
  points_ = begin();
  points_box_ = {};
  for (const glm::vec3& p : picture.dropped_points) {
    points_box_.add(Vec3(p));
    new_discs_.push_back({vec4_of(p, 0.2e-3f), {0, 0, 0, 0.8f}, vec4_of(theme.dropped_point, 2.2f)});
  }
  for (const glm::vec3& p : picture.skin_points) {
    points_box_.add(Vec3(p));
    new_discs_.push_back({vec4_of(p, 0.2e-3f), {0, 0, 0, 0.8f}, vec4_of(theme.skin_point, 2.2f)});
  }
  end(points_);
  contacts_ = begin();
  for (const ContactMark& c : picture.contacts) {
    const Colour colour = c.finger ? finger_colour(*c.finger) : theme.loose_contact;
    new_discs_.push_back({vec4_of(c.position, 0.34e-3f), {0, 0, 0, 1.6f}, vec4_of(colour, 4.5f)});
  }
  end(contacts_);
  transducers_ = begin();
  for (const TransducerMark& t : picture.transducers) {
    const Colour colour = picture.driven ? drive_colour(t.amplitude, t.phase) : theme.idle_transducer;
    const glm::vec3 axis = glm::length(t.axis) > 0.5f ? t.axis : glm::vec3(0, 0, 1);
    new_discs_.push_back(
        {vec4_of(t.position, picture.transducer_radius_m), vec4_of(axis, 0), vec4_of(colour, unbounded)});
  }
  end(transducers_);
  discs_.fill(*device_, new_discs_, "points and transducers");
}

void DrawnPicture::add_images(const Picture& picture) {
  images_.clear();
  new_pixels_.clear();
  for (const ImageMark& image : picture.images) {
    if (image.pixels.empty() || !state_.layers.shows(image.layer)) continue;
    images_.push_back({image.layer,
                       {static_cast<std::uint32_t>(new_vertices_.size()), 6},
                       static_cast<std::uint32_t>(new_pixels_.size()),
                       image.width,
                       image.height});
    for (const std::size_t corner : {0, 1, 2, 0, 2, 3}) {
      const float x = corner == 1 || corner == 2 ? 1 : 0, y = corner >= 2 ? 1 : 0;
      new_vertices_.push_back({vec4_of(image.corners[corner], x), {0, 0, 0, y}});
    }
    new_pixels_.insert(new_pixels_.end(), image.pixels.begin(), image.pixels.end());
  }
}

void DrawnPicture::record_upload(VkCommandBuffer commands) {
  for (SurfaceMemory* memory : {&solids_memory_, &skin_memory_}) {
    if (!std::exchange(memory->changed, false)) continue;
    memory->vertices.record(commands);
    memory->corners.record(commands);
  }
  if (marks_changed_) {
    face_vertices_.record(commands);
    pixels_.record(commands);
    discs_.record(commands);
    strokes_.record(commands);
  }
  marks_changed_ = false;
}

}  // namespace palpa::viewer
