#include "viewer/picture/world_marks.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "viewer/picture/palette.hpp"
#include "viewer/picture/view_vertex.hpp"
#include "viewer/view/vec4.hpp"

namespace palpa::viewer {
namespace {

/// Draws the lines of one layer.
class Pen {
 public:
  Pen(float opacity, std::vector<shader::ViewStroke>& out) : opacity_(opacity), out_(out) {}
  void line(const glm::vec3& a, const glm::vec3& b, float width, const Colour& c) {
    out_.push_back({vec4_of(a, width / 2), vec4_of(b, 0), {c.r, c.g, c.b, c.a * opacity_}});
  }

 private:
  float opacity_;
  std::vector<shader::ViewStroke>& out_;
};

/// The grid on the plane on which the objects stand, extending beyond them: a line every 10 mm, a stronger one every 50
/// mm.
void add_grid(const Box& box, const Theme& theme, Pen pen) {
  if (box.empty()) return;
  const double reach = std::max(box.high.x - box.low.x, box.high.z - box.low.z);
  if (!(reach < 1000)) return;  // a stray point far away: a grid would not help
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
    pen.line(point(x, z0), point(x, z1), 1.0f, colour(x));
  for (double z = z0; z <= z1; ++z)
    pen.line(point(x0, z), point(x1, z), 1.0f, colour(z));
}

void add_frustum(const CameraMark& camera, const Theme& theme, Pen& pen) {
  for (std::size_t i = 0; i < 4; ++i) {
    pen.line(camera.apex, camera.corners[i], 1.2f, theme.frustum);
    pen.line(camera.corners[i], camera.corners[(i + 1) % 4], 1.2f, theme.frustum);
  }
}

void add_board(const BoardMark& board, const Theme& theme, Pen& pen, std::vector<shader::ViewVertex>& faces) {
  const glm::vec3 normal = glm::cross(board[1] - board[0], board[2] - board[0]);
  for (const std::size_t corner : {0, 1, 2, 0, 2, 3})
    faces.push_back(plain(board[corner], normal));
  for (std::size_t i = 0; i < 4; ++i)
    pen.line(board[i], board[(i + 1) % 4], 1.2f, theme.board_edge);
}

/// An ellipse of two standard deviations, which is a little larger than a ring of contacts, and the axes from its
/// middle.
void add_section(const SectionMark& section, const Colour& colour, Pen& pen, std::vector<shader::ViewVertex>& faces) {
  constexpr int pieces = 48;
  const auto rim = [&](int i) {
    const float a = 2 * std::numbers::pi_v<float> * static_cast<float>(i % pieces) / pieces;
    return section.centre + std::cos(a) * section.reach.x * section.axes[0] +
           std::sin(a) * section.reach.y * section.axes[1];
  };
  for (int i = 0; i < pieces; ++i) {
    for (const glm::vec3& corner : {section.centre, rim(i), rim(i + 1)})
      faces.push_back(coloured(corner, section.axes[2], colour));
    pen.line(rim(i), rim(i + 1), 1.4f, colour);
  }
  for (std::size_t i = 0; i < 3; ++i)
    pen.line(section.centre, section_tip(section, i), i == 2 ? 1.4f : 2.2f, colour);
}

/// Where foci were seen that play ahead of their finger, and the way from there.
void add_seen(const FingerMarks& finger, const Theme& theme, Pen& pen) {
  if (finger.seen.empty() || finger.foci.empty()) return;
  glm::vec3 from(0), to(0);
  for (std::size_t i = 0; i < finger.seen.size(); ++i) {
    pen.line(finger.seen[i], finger.seen[(i + 1) % finger.seen.size()], 1.4f, theme.ink);
    from += finger.seen[i] / static_cast<float>(finger.seen.size());
  }
  for (const FocusMark& focus : finger.foci)
    to += focus.position / static_cast<float>(finger.foci.size());
  pen.line(from, to, 2.0f, theme.ink);
}

}  // namespace

void build_marks(const Picture& picture, const ViewState& state, const Box& floor, WorldMarks& marks) {
  const Theme& theme = theme_of(state.dark);
  marks.lines.clear();
  marks.boards.clear();
  marks.sections.clear();
  marks.tile.clear();
  const auto pen = [&](Layer layer) { return Pen(state.layers.opacity(layer), marks.lines); };
  if (state.layers.shows(Layer::grid)) add_grid(floor, theme, pen(Layer::grid));
  if (state.layers.shows(Layer::cameras)) {
    Pen frusta = pen(Layer::cameras);
    for (const CameraMark& camera : picture.cameras)
      add_frustum(camera, theme, frusta);
  }
  if (state.layers.shows(Layer::transducers)) {
    Pen edges = pen(Layer::transducers);
    for (const BoardMark& board : picture.boards)
      add_board(board, theme, edges, marks.boards);
  }
  if (state.layers.shows(Layer::slice)) {
    Pen frame = pen(Layer::slice);
    for (const ImageMark& image : picture.images) {
      for (std::size_t i = 0; i < 4 && image.layer == Layer::slice; ++i)
        frame.line(image.corners[i], image.corners[(i + 1) % 4], 1.2f, theme.board_edge);
    }
  }
  if (picture.tile && state.layers.shows(Layer::tile)) {
    Pen edges = pen(Layer::tile);
    const auto& corners = *picture.tile;
    for (const std::size_t corner : {0, 1, 2, 0, 2, 3})
      marks.tile.push_back(coloured(corners[corner], {0, 1, 0}, theme.tile));
    for (std::size_t i = 0; i < 4; ++i)
      edges.line(corners[i], corners[(i + 1) % 4], 1.5f, theme.edge);
  }
  if (state.layers.shows(Layer::foci)) {
    Pen outlines = pen(Layer::foci);
    for (const FingerMarks& finger : picture.fingers)
      add_seen(finger, theme, outlines);
  }
  if (state.layers.shows(Layer::sections)) {
    Pen outlines = pen(Layer::sections);
    for (std::size_t f = 0; f < picture.fingers.size(); ++f) {
      if (const auto& section = picture.fingers[f].section)
        add_section(*section, finger_colour(static_cast<std::uint32_t>(f)), outlines, marks.sections);
    }
  }
}

}  // namespace palpa::viewer
