#include "viewer/picture/picture.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "acoustics/felt/skin.hpp"
#include "base/text.hpp"
#include "viewer/picture/depth_image.hpp"

namespace palpa::viewer {

namespace {

/// The middle of the part that lies within a millimetre of the top.
Vec3 middle_of_top(const geometry::Solid& solid) {
  Box top;
  for (const Vec3& p : solid.mesh.positions) {
    if (p.y > solid.bounds.high.y - 1e-3) top.add(p);
  }
  return top.empty() ? solid.bounds.centre() : top.centre();
}

}  // namespace

std::string feel_of(const geometry::Haptics& haptics) {
  std::string feel;
  const auto add = [&](bool has, const char* word) {
    if (has) feel += (feel.empty() ? "" : ", ") + std::string(word);
  };
  const auto differs = [&](const geometry::DepthForce& row) { return row.force != haptics.stiffness->front().force; };
  add(haptics.clicks(), "clicks");
  add(haptics.stiffness && std::ranges::any_of(*haptics.stiffness, differs), "spring");
  add(haptics.texture && ((*haptics.texture)[1] > 0 || (*haptics.texture)[2] > 0), "texture");
  return feel;
}

bool Picture::changes() const {
  return std::ranges::any_of(
      fingers, [](const FingerMarks& finger) { return finger.foci.size() > 1 || !finger.sensation.empty(); });
}

void show_solids(Picture& picture, std::span<const geometry::Solid> solids) {
  picture.solids.clear();
  picture.tile.reset();
  const auto highest = std::max_element(solids.begin(), solids.end(),
                                        [](const auto& a, const auto& b) { return a.bounds.high.y < b.bounds.high.y; });
  if (highest != solids.end() && !highest->bounds.empty()) {
    constexpr float half = 5e-3f;
    glm::vec3 at(middle_of_top(*highest));
    at.y = static_cast<float>(highest->bounds.high.y) + 0.3e-3f;  // above it, not half in it
    picture.tile_solid = static_cast<std::uint32_t>(highest - solids.begin());
    picture.tile = {at + glm::vec3(-half, 0, half), at + glm::vec3(half, 0, half), at + glm::vec3(half, 0, -half),
                    at + glm::vec3(-half, 0, -half)};
  }
  for (std::uint32_t s = 0; s < solids.size(); ++s) {
    const geometry::Solid& solid = solids[s];
    const std::string feel = feel_of(solid.haptics);
    if (solid.parts.parts.size() < 2)
      picture.solids.push_back({.name = solid.name, .mesh = solid.mesh, .solid = s, .feel = feel});
    for (std::uint32_t i = 0; solid.parts.parts.size() > 1 && i < solid.parts.parts.size(); ++i)
      picture.solids.push_back(
          {.name = solid.name, .mesh = solid.parts.parts[i].mesh, .part = i, .solid = s, .feel = feel});
  }
}

glm::vec3 section_tip(const SectionMark& section, std::size_t axis) {
  const float across = 0.9f * section.reach.y;
  return section.centre + section.axes[axis] * (axis == 2 ? across : 1.25f * section.reach[static_cast<int>(axis)]);
}

namespace {

std::optional<SectionMark> section_of(const touch::Finger& finger) {
  if (finger.point_like) return std::nullopt;
  const touch::CrossSection& section = finger.section;
  const auto& [w1, w2, w3] = section.axes;
  const auto spread = [&](std::size_t i) { return 2 * std::sqrt(std::max(section.eigenvalues[i], 0.0f)); };
  return SectionMark{section.centroid,
                     {section.turn.x * w1 + section.turn.y * w2, section.turn.x * w2 - section.turn.y * w1, w3},
                     {spread(0), spread(1)}};
}

}  // namespace

void show_touch(Picture& picture, std::span<const geometry::Solid> solids, std::span<const sensing::SkinPoint> points,
                const touch::Touch& touch) {
  picture.contacts.clear();
  for (const touch::Contact& contact : touch.contacts)
    picture.contacts.push_back({contact.position, std::nullopt});
  picture.skin_points.clear();
  auto contact = touch.contacts.begin();
  for (const sensing::SkinPoint& point : points) {
    while (contact != touch.contacts.end() && contact->point < point.index)
      ++contact;
    if (contact == touch.contacts.end() || contact->point != point.index) picture.skin_points.push_back(point.position);
  }
  picture.fingers.clear();
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    for (const std::uint32_t c : finger.contacts)
      picture.contacts[c].finger = f;
    FingerMarks marks;
    marks.solid = finger.solid < solids.size() ? solids[finger.solid].name : "";
    marks.contacts = static_cast<std::uint32_t>(finger.contacts.size());
    marks.section = section_of(finger);
    picture.fingers.push_back(std::move(marks));
  }
}

std::string why_untouched(const Picture& picture, const std::string& nearest) {
  if (!picture.fingers.empty()) return {};
  if (picture.contacts.empty()) return nearest;
  return counted(picture.contacts.size(), "contact") + ", too few or too far apart for a finger";
}

void show_schedule(Picture& picture, const array::Schedule& schedule, std::span<const touch::Placement> placements) {
  const std::size_t count = std::min({std::size_t{schedule.voice_count}, picture.fingers.size(), placements.size()});
  for (std::size_t f = 0; f < count; ++f) {
    const array::Voice& voice = schedule.voices[f];
    auto& foci = picture.fingers[f].foci;
    picture.fingers[f].together = placements[f].together;
    foci.clear();
    for (const std::uint32_t sector : voice.order) {
      // For foci that sound together, empty sectors are already left out.
      const bool own = placements[f].together || placements[f].has(sector);
      foci.push_back({glm::vec3(voice.foci[sector]), static_cast<std::uint32_t>(foci.size() + 1), own});
    }
  }
}

void show_spectra(Picture& picture, std::span<const acoustics::Spectrum> spectra) {
  picture.spectra.clear();
  for (const acoustics::Spectrum& spectrum : spectra) {
    std::vector<SpectrumMark>& marks = picture.spectra.emplace_back();
    for (const acoustics::Line& line : spectrum.lines)
      marks.push_back(
          {line.frequency_hz, line.around, line.around * acoustics::vibration_sensitivity(line.frequency_hz)});
  }
}

void show_slot(Picture& picture, const array::Schedule& schedule, std::uint64_t slot) {
  // In whole nanoseconds, as the schedule itself counts.
  const auto nanoseconds = [](double s) { return static_cast<std::uint64_t>(std::max(std::llround(s * 1e9), 1ll)); };
  const std::size_t count = std::min<std::size_t>(schedule.voice_count, picture.fingers.size());
  for (std::size_t f = 0; f < count; ++f) {
    const array::Voice& voice = schedule.voices[f];
    const std::size_t foci = picture.fingers[f].foci.size();
    if (foci == 0) continue;
    const std::uint64_t step = slot * nanoseconds(schedule.slot_s) / nanoseconds(voice.dwell_s);
    picture.fingers[f].running = static_cast<std::uint32_t>(step * voice.foci_per_slot % foci);
  }
}

void show_array(Picture& picture, const array::Layout& layout) {
  picture.transducers.clear();
  picture.driven = false;
  for (const auto& t : layout.transducers)
    picture.transducers.push_back({glm::vec3(t.position), glm::vec3(t.axis), 0, 0});
  picture.boards.clear();
  for (const array::Board& board : layout.boards) {
    const double w = board.width_m / 2, h = board.height_m / 2;
    BoardMark mark;
    const std::array<Vec3, 4> corners{Vec3(-w, -h, 0), Vec3(w, -h, 0), Vec3(w, h, 0), Vec3(-w, h, 0)};
    for (std::size_t i = 0; i < 4; ++i)
      mark[i] = glm::vec3(transform_point(board.T_layout_board, corners[i]));
    picture.boards.push_back(mark);
  }
}

void show_drive(Picture& picture, std::span<const array::TransducerDrive> drive) {
  picture.driven = true;
  for (std::size_t i = 0; i < std::min(drive.size(), picture.transducers.size()); ++i) {
    picture.transducers[i].amplitude = drive[i].amplitude;
    picture.transducers[i].phase = drive[i].phase;
  }
}

void show_cameras(Picture& picture, std::span<const sensing::Camera> cameras) {
  constexpr double depth_m = 0.08;
  picture.cameras.clear();
  for (const sensing::Camera& camera : cameras) {
    CameraMark mark;
    mark.name = camera.name;
    mark.frustum = through(camera);
    mark.apex = glm::vec3(transform_point(camera.T_world_camera, Vec3(0)));
    const double w = camera.width, h = camera.height;
    const std::array<Vec2, 4> pixels{Vec2(0, 0), Vec2(w, 0), Vec2(w, h), Vec2(0, h)};
    for (std::size_t i = 0; i < 4; ++i) {
      // The ideal pinhole: a few pixels of distortion do not show in a frustum.
      const Vec3 ray((pixels[i].x - 0.5 - camera.cx) / camera.fx, (pixels[i].y - 0.5 - camera.cy) / camera.fy, 1.0);
      mark.corners[i] = glm::vec3(transform_point(camera.T_world_camera, ray * depth_m));
    }
    picture.cameras.push_back(mark);
  }
}

void show_depth(Picture& picture, std::span<const sensing::Camera> cameras,
                std::span<const sensing::DepthFrame> frames) {
  std::erase_if(picture.images, [](const ImageMark& image) { return image.layer == Layer::depth; });
  const std::size_t count = std::min({cameras.size(), frames.size(), picture.cameras.size()});
  for (std::size_t i = 0; i < count; ++i) {
    ImageMark& mark = picture.images.emplace_back();
    mark.layer = Layer::depth;
    mark.corners = picture.cameras[i].corners;
    paint_depth(cameras[i], frames[i], mark);
  }
}

std::vector<Vec3> apart(std::span<const SurfaceMark> solids) {
  std::vector<Vec3> ways(solids.size(), Vec3(0));
  for (std::size_t first = 0; first < solids.size();) {
    std::size_t end = first + 1;
    while (end < solids.size() && solids[first].part && solids[end].part && *solids[end].part != 0)
      ++end;
    Box whole;
    for (std::size_t i = first; i < end && end - first > 1; ++i) {
      const Box part = geometry::bounds(solids[i].mesh);
      ways[i] = part.empty() ? Vec3(0) : part.centre();
      whole.add(part.low);
      whole.add(part.high);
    }
    for (std::size_t i = first; i < end && end - first > 1; ++i)
      ways[i] = 2.0 * (ways[i] - whole.centre());
    first = end;
  }
  return ways;
}

Box extent(const Picture& picture, Extent extent, const ViewState& state) {
  Box box;
  for (const ContactMark& c : picture.contacts) {
    if (c.finger || extent != Extent::touch) box.add(Vec3(c.position));
  }
  for (const FingerMarks& finger : picture.fingers) {
    for (const FocusMark& focus : finger.foci)
      box.add(Vec3(focus.position));
  }
  if (extent == Extent::touch && !box.empty()) {
    const Vec3 margin(0.8e-3);
    box.low -= margin;
    box.high += margin;
    return box;
  }
  const std::vector<Vec3> ways = state.explode > 0 ? apart(picture.solids) : std::vector<Vec3>(picture.solids.size());
  for (std::size_t i = 0; i < picture.solids.size(); ++i) {
    for (const Vec3& p : picture.solids[i].mesh.positions)
      box.add(p + state.explode * ways[i]);
  }
  if (extent != Extent::all && !box.empty()) {
    constexpr double near = 0.03;
    const Box core = box;
    const auto add_near = [&](const Vec3& p) {
      if (glm::all(glm::greaterThanEqual(p, core.low - near)) && glm::all(glm::lessThanEqual(p, core.high + near))) {
        box.add(p);
      }
    };
    for (const glm::vec3& p : picture.skin_points)
      add_near(Vec3(p));
    if (picture.skin) std::for_each(picture.skin->mesh.positions.begin(), picture.skin->mesh.positions.end(), add_near);
    return box;
  }
  for (const glm::vec3& p : picture.skin_points)
    box.add(Vec3(p));
  if (picture.skin) {
    for (const Vec3& p : picture.skin->mesh.positions)
      box.add(p);
  }
  for (const TransducerMark& t : picture.transducers)
    box.add(Vec3(t.position));
  for (std::size_t i = 0; i < picture.cameras.size() && state.layers.shows(Layer::cameras); ++i)
    box.add(Vec3(picture.cameras[i].apex));
  return box;
}

}  // namespace palpa::viewer
