#include "viewer/drawn_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "viewer/palette.hpp"
#include "viewer/shape.hpp"

namespace palpa::viewer {
namespace {

shader::vec4 pack(const glm::vec3& v, float w) {
  return {v.x, v.y, v.z, w};
}
shader::vec4 pack(const Colour& c, float w) {
  return {c.r, c.g, c.b, w};
}
shader::vec4 pack(const Colour& c) {
  return pack(c, c.a);
}

constexpr float unbounded = 1e6f;

shader::ViewStroke line(const glm::vec3& a, const glm::vec3& b, float width, const Colour& colour) {
  return {pack(a, width / 2), pack(b, 0), pack(colour)};
}

/// On the plane that the objects stand on, some way beyond them: a line every 10 mm, a stronger one every 50 mm.
void add_grid(const Box& box, const Theme& theme, std::vector<shader::ViewStroke>& out) {
  if (box.empty()) return;
  const double reach = std::max(box.high.x - box.low.x, box.high.z - box.low.z);
  if (!(reach < 1000)) return;  // a stray point far away: nothing a grid would help with
  double step = 0.01;
  while (reach / step > 60)
    step *= 10;
  const auto snap = [&](double v, double direction) {
    return static_cast<int>(std::floor(v / step * direction) + 2) * direction;
  };
  const double x0 = snap(box.low.x, -1), x1 = snap(box.high.x, 1), z0 = snap(box.low.z, -1), z1 = snap(box.high.z, 1);
  const auto point = [&](double x, double z) { return glm::vec3(Vec3(x * step, box.low.y, z * step)); };
  const auto colour = [&](double index) { return std::fmod(index, 5.0) == 0 ? theme.grid_major : theme.grid; };
  for (double x = x0; x <= x1; ++x)
    out.push_back(line(point(x, z0), point(x, z1), 1.0f, colour(x)));
  for (double z = z0; z <= z1; ++z)
    out.push_back(line(point(x0, z), point(x1, z), 1.0f, colour(z)));
}

void add_frustum(const CameraMark& camera, const Theme& theme, std::vector<shader::ViewStroke>& out) {
  for (std::size_t i = 0; i < 4; ++i) {
    out.push_back(line(camera.apex, camera.corners[i], 1.2f, theme.frustum));
    out.push_back(line(camera.corners[i], camera.corners[(i + 1) % 4], 1.2f, theme.frustum));
  }
}

/// Where the grid lies: under the objects, else under everything.
Box floor_of(const Picture& picture) {
  Picture objects;
  objects.solids = picture.solids;
  if (!picture.solids.empty()) return extent(objects, Extent::all);
  return extent(picture, Extent::all);
}

}  // namespace

template <typename T>
void DrawnPicture::fill(gpu::Upload& upload, const std::vector<T>& items, const char* name) {
  const VkDeviceSize bytes = items.size() * sizeof(T);
  if (upload.data() == nullptr || upload.ref().size < bytes) {
    upload = gpu::Upload(*device_, std::max<VkDeviceSize>(bytes + bytes / 2, sizeof(T)), name);
  }
  if (bytes != 0) std::memcpy(upload.data(), items.data(), bytes);
}

SurfaceItems DrawnPicture::add_surface(const geometry::Mesh& mesh) {
  const Shape shape = make_shape(mesh);
  SurfaceItems range;
  range.vertices = {static_cast<std::uint32_t>(new_vertices_.size()),
                    static_cast<std::uint32_t>(shape.vertices.size())};
  range.edges = {static_cast<std::uint32_t>(new_edges_.size()), static_cast<std::uint32_t>(shape.edges.size())};
  new_vertices_.insert(new_vertices_.end(), shape.vertices.begin(), shape.vertices.end());
  new_edges_.insert(new_edges_.end(), shape.edges.begin(), shape.edges.end());
  Box box;
  for (const Vec3& p : mesh.positions)
    box.add(p);
  range.centre = box.empty() ? Vec3(0) : box.centre();
  return range;
}

void DrawnPicture::update(const Picture& picture) {
  new_vertices_.clear();
  new_edges_.clear();
  solids_.clear();
  picture_.solids.clear();
  picture_.skin.reset();
  for (const SurfaceMark& solid : picture.solids) {
    solids_.push_back(add_surface(solid.mesh));
    solids_.back().part = solid.part;
    picture_.solids.push_back({solid.name, {}, solid.part});
  }
  skin_ = {};
  if (picture.skin) {
    skin_ = add_surface(picture.skin->mesh);
    picture_.skin = SurfaceMark{picture.skin->name, {}};
  }
  floor_ = floor_of(picture);
  fill(vertices_, new_vertices_, "surfaces");
  fill(edges_, new_edges_, "surface edges");
  surfaces_changed_ = true;
  update_marks(picture);
}

void DrawnPicture::update_marks(const Picture& picture) {
  picture_.title = picture.title;
  picture_.skin_points = picture.skin_points;
  picture_.skin_count = picture.skin_count;
  picture_.contacts = picture.contacts;
  picture_.fingers = picture.fingers;
  picture_.transducers = picture.transducers;
  picture_.driven = picture.driven;
  picture_.cameras = picture.cameras;
  picture_.spectra = picture.spectra;
  picture_.dark = picture.dark;
  picture_.legend = picture.legend;
  picture_.grid = picture.grid;
  const Theme& theme = picture.dark ? dark_theme() : light_theme();

  new_discs_.clear();
  const auto begin = [&] { return Items{static_cast<std::uint32_t>(new_discs_.size()), 0}; };
  const auto end = [&](Items& range) { range.count = static_cast<std::uint32_t>(new_discs_.size()) - range.first; };
  points_ = begin();
  for (const glm::vec3& p : picture.skin_points) {
    new_discs_.push_back({pack(p, 0.2e-3f), {0, 0, 0, 0.8f}, pack(theme.skin_point, 2.2f)});
  }
  end(points_);
  contacts_ = begin();
  for (const ContactMark& c : picture.contacts) {
    const Colour colour = c.finger ? finger_colour(*c.finger) : theme.loose_contact;
    new_discs_.push_back({pack(c.position, 0.34e-3f), {0, 0, 0, 1.6f}, pack(colour, 4.5f)});
  }
  end(contacts_);
  transducers_ = begin();
  for (const TransducerMark& t : picture.transducers) {
    const Colour colour = picture.driven ? drive_colour(t.amplitude, t.phase) : theme.idle_transducer;
    const glm::vec3 axis = glm::length(t.axis) > 0.5f ? t.axis : glm::vec3(0, 0, 1);
    new_discs_.push_back({pack(t.position, picture.transducer_radius_m), pack(axis, 0), pack(colour, unbounded)});
  }
  end(transducers_);
  fill(discs_, new_discs_, "points and transducers");

  new_strokes_.clear();
  if (picture.grid) add_grid(floor_, theme, new_strokes_);
  for (const CameraMark& camera : picture.cameras)
    add_frustum(camera, theme, new_strokes_);
  new_vertices_.clear();
  for (const BoardMark& board : picture.boards) {
    const glm::vec3 normal = glm::cross(board[1] - board[0], board[2] - board[0]);
    for (const std::size_t corner : {0, 1, 2, 0, 2, 3})
      new_vertices_.push_back({pack(board[corner], 1), pack(normal, 0)});
    for (std::size_t i = 0; i < 4; ++i)
      new_strokes_.push_back(line(board[i], board[(i + 1) % 4], 1.2f, theme.board_edge));
  }
  boards_ = {0, static_cast<std::uint32_t>(new_vertices_.size())};
  lines_ = {0, static_cast<std::uint32_t>(new_strokes_.size())};
  fill(board_vertices_, new_vertices_, "boards");
  fill(strokes_, new_strokes_, "lines");
  marks_changed_ = true;
}

void DrawnPicture::record_upload(VkCommandBuffer commands) {
  if (surfaces_changed_) {
    vertices_.record(commands);
    edges_.record(commands);
  }
  if (marks_changed_) {
    board_vertices_.record(commands);
    discs_.record(commands);
    strokes_.record(commands);
  }
  surfaces_changed_ = marks_changed_ = false;
}

}  // namespace palpa::viewer
