// Recorded hands on one object: every fingertip has its own foci, and all fingertips sound in every slot. Camera frame
// = world. With PALPA_OBJECTS=FOLDER, the objects and their cameras are written there for the viewer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <glm/geometric.hpp>

#include "array/schedule.hpp"
#include "geometry/gltf/write.hpp"
#include "gpu/commands.hpp"
#include "sensing/grey_png.hpp"
#include "sensing/rig.hpp"
#include "session/plan/voice.hpp"
#include "support/device.hpp"
#include "support/hand_tips.hpp"
#include "support/shared_data.hpp"
#include "touch/foci/method.hpp"
#include "touch/points/passes.hpp"
#include "touch/stage.hpp"

namespace palpa::session {
namespace {

using test::HandTip;
using test::Pixel;

Vec3 point_at(const sensing::Camera& camera, const Pixel& p, double z) {
  return {(p.u - camera.cx) / camera.fx * z, (p.v - camera.cy) / camera.fy * z, z};
}
Pixel pixel_of(const sensing::Camera& camera, const Vec3& p) {
  return {camera.cx + camera.fx * p.x / p.z, camera.cy + camera.fy * p.y / p.z};
}

sensing::Camera recorded_camera(double f, double cx, double cy, double unit_m) {
  sensing::Camera camera;
  camera.name = "recorded";
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = f;
  camera.cx = cx;
  camera.cy = cy;
  camera.depth_unit_m = unit_m;
  camera.min_range_m = 0.1;
  camera.rate_hz = 30;
  return camera;
}
sensing::Camera sr305() {
  return recorded_camera(476.007, 313.683, 242.755, 0.000125);
}
/// Nominal values of the first Kinect; the recording does not contain its own.
sensing::Camera kinect() {
  return recorded_camera(585, 320, 240, 0.001);
}

/// Facing outwards, whatever its original orientation.
geometry::Mesh outwards(geometry::Mesh mesh) {
  double volume = 0;
  for (const glm::uvec3& t : mesh.triangles)
    volume += glm::dot(mesh.positions[t.x], glm::cross(mesh.positions[t.y], mesh.positions[t.z]));
  if (volume < 0) {
    for (glm::uvec3& t : mesh.triangles)
      std::swap(t.y, t.z);
  }
  return mesh;
}

void add_quad(geometry::Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  mesh.triangles.emplace_back(a, b, c);
  mesh.triangles.emplace_back(a, c, d);
}

/// A band between two lines of the picture, point by point, along the camera's rays from depth `near` to `far`: the
/// camera sees its walls edge-on.
geometry::Mesh band(const sensing::Camera& camera, const std::vector<Pixel>& inner, const std::vector<Pixel>& outer,
                    double near, double far) {
  geometry::Mesh mesh;
  const auto count = static_cast<std::uint32_t>(inner.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    for (const double z : {near, far}) {
      mesh.positions.push_back(point_at(camera, inner[i], z));
      mesh.positions.push_back(point_at(camera, outer[i], z));
    }
  }
  // The indices for point i: 4 i inner near, + 1 outer near, + 2 inner far, + 3 outer far.
  for (std::uint32_t i = 0; i + 1 < count; ++i) {
    const std::uint32_t a = 4 * i, b = a + 4;
    add_quad(mesh, a, b, b + 1, a + 1);
    add_quad(mesh, a + 1, b + 1, b + 3, a + 3);
    add_quad(mesh, a + 3, b + 3, b + 2, a + 2);
    add_quad(mesh, a + 2, b + 2, b, a);
  }
  const std::uint32_t end = 4 * (count - 1);
  add_quad(mesh, 0, 1, 3, 2);
  add_quad(mesh, end, end + 2, end + 3, end + 1);
  return outwards(std::move(mesh));
}

/// A body in front of both hands, with a slope of its back for each hand: all ten fingertips reach into it, and nothing
/// else.
geometry::Mesh mask(const sensing::Camera& camera, const std::vector<HandTip>& tips) {
  // For each hand: the direction into the body, and the depth of its shallowest tip.
  const std::pair<Vec3, double> slopes[]{{{0.4931, 0.1606, -0.855}, 6e-3}, {{-0.1907, -0.1741, -0.9661}, 4e-3}};
  const auto back = [&](int hand, double x, double y) {
    const Vec3 n = glm::normalize(slopes[hand].first);
    double shallowest = 1e9;
    for (const HandTip& tip : tips) {
      if (tip.hand == hand + 1) shallowest = std::min(shallowest, glm::dot(n, point_at(camera, tip.pixel, tip.z)));
    }
    return Vec3(x, y, (shallowest - slopes[hand].second - n.x * x - n.y * y) / n.z);
  };
  geometry::Mesh mesh;
  constexpr double middle = 0.0, edge = 5e-3, front = 0.4;
  for (const double y : {-0.19, 0.07}) {
    for (const Vec3& p : {back(0, -0.26, y), back(0, middle - edge, y), back(1, middle + edge, y), back(1, 0.27, y)}) {
      mesh.positions.push_back(p);
      mesh.positions.emplace_back(p.x, p.y, front);
    }
  }
  // Column i of row 0: 2 i behind, + 1 in front; row 1: 8 more.
  for (std::uint32_t i = 0; i < 3; ++i) {
    const std::uint32_t a = 2 * i, b = a + 2;
    add_quad(mesh, a, b, b + 8, a + 8);
    add_quad(mesh, a + 1, a + 9, b + 9, b + 1);
    add_quad(mesh, a, a + 1, b + 1, b);
    add_quad(mesh, a + 8, b + 8, b + 9, a + 9);
  }
  add_quad(mesh, 0, 8, 9, 1);
  add_quad(mesh, 6, 7, 15, 14);
  return outwards(std::move(mesh));
}

struct Seen {
  std::vector<sensing::Camera> cameras;
  std::vector<geometry::Solid> solids;
  std::vector<sensing::DepthFrame> images;
};

Seen look(const std::string& name, const sensing::Camera& camera, geometry::Mesh object,
          const std::filesystem::path& image) {
  const std::vector<geometry::SceneMesh> scene{{name, std::move(object)}};
  if (const char* folder = std::getenv("PALPA_OBJECTS"); folder && *folder) {
    const std::filesystem::path file = std::filesystem::path(folder) / name;
    geometry::write_glb(file.string() + ".glb", scene);
    std::ofstream(file.string() + ".toml") << sensing::to_toml({.file = {}, .cameras = {camera}});
  }
  Seen seen{{camera}, geometry::make_solids({name, scene}), {{}}};
  sensing::read_png16(image, camera.width, camera.height, seen.images[0].depth);
  return seen;
}

touch::Touch touch_on_device(const Seen& seen, const touch::Parameters& parameters = {}) {
  static touch::Passes passes(test::test_device());
  touch::Stage stage(passes, seen.solids, seen.cameras, {.parameters = parameters});
  touch::Touch out;
  stage.touch(seen.images, out);
  return out;
}

/// Every finger has its own focus on its own skin in every slot, and all of its foci within ten slots.
void expect_own_foci(const touch::Touch& touch) {
  array::Schedule schedule;
  touch::Placement placement;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    touch::place_foci(touch, touch.fingers[f], {}, placement);
    make_voice(placement, f, touch.fingers[f].solid, {}, schedule.add_voice());
  }
  std::vector<std::vector<Vec3>> played(touch.finger_count);
  for (std::uint64_t slot = 0; slot < 10; ++slot) {
    std::vector<array::SlotFocus> foci;
    array::foci_of_slot(schedule, slot, foci);
    ASSERT_EQ(foci.size(), touch.finger_count);
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      double own = 1e9, others = 1e9;
      for (std::uint32_t g = 0; g < touch.finger_count; ++g) {
        for (const std::uint32_t i : touch.fingers[g].contacts) {
          double& nearest = f == g ? own : others;
          nearest = std::min(nearest, glm::distance(Vec3(foci[f].position), Vec3(touch.contacts[i].position)));
        }
      }
      EXPECT_LT(own, 4e-3) << "finger " << f << " slot " << slot;
      EXPECT_LT(own, others) << "finger " << f << " slot " << slot;
      played[f].emplace_back(foci[f].position);
    }
  }
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    ASSERT_FALSE(touch.fingers[f].point_like) << f;
    for (const touch::Focus& focus : touch.fingers[f].foci) {
      if (focus.points == 0) continue;
      EXPECT_TRUE(std::any_of(played[f].begin(), played[f].end(), [&](const Vec3& p) {
        return glm::distance(p, Vec3(focus.position)) < 1e-6;
      })) << f;
    }
  }
}

/// If clusters contain all skin inside, both backends find the same fingers.
touch::Touch touch_inside(const Seen& seen) {
  const touch::Parameters parameters{.cluster = touch::Cluster::inside};
  touch::Touch twin;
  touch::Stage(seen.solids, seen.cameras, {.parameters = parameters}).touch(seen.images, twin);
  touch::Touch out = touch_on_device(seen, parameters);
  EXPECT_GT(out.deep.size(), out.contacts.size());
  EXPECT_EQ(out.deep.size(), twin.deep.size());
  EXPECT_EQ(out.finger_count, twin.finger_count);
  for (std::uint32_t f = 0; f < std::min(out.finger_count, twin.finger_count); ++f)
    EXPECT_EQ(out.fingers[f].contacts, twin.fingers[f].contacts) << f;
  return out;
}

TEST(Hands, FiveFingertipsOnOneArch) {
  PALPA_SHARED_OR_SKIP(image, "depth-hand-sr305-ondris/20210326-230536_70.png");
  // A right hand, spread, palm to the camera; a band around it into which every fingertip reaches and the arm does not.
  const std::vector<Pixel> inner{{240, 285}, {240, 192}, {300, 192}, {318, 208}, {375, 208}};
  const std::vector<Pixel> outer{{200, 285}, {200, 150}, {300, 150}, {318, 150}, {375, 150}};
  const Seen seen = look("arch", sr305(), band(sr305(), inner, outer, 0.42, 0.72), image);
  const touch::Touch touch = touch_on_device(seen);
  ASSERT_EQ(touch.finger_count, 5u);
  // Little, ring, middle, index finger and thumb, at the places where they cross the inner line.
  const std::vector<Pixel> expected{{240, 256}, {240, 227}, {240, 204}, {276, 192}, {342, 208}};
  std::vector<bool> met(expected.size());
  for (std::uint32_t f = 0; f < 5; ++f) {
    const Pixel p = pixel_of(sr305(), Vec3(touch.fingers[f].section.centroid));
    for (std::size_t e = 0; e < expected.size(); ++e) {
      if (std::abs(p.u - expected[e].u) < 7 && std::abs(p.v - expected[e].v) < 7) met[e] = true;
    }
  }
  EXPECT_EQ(met, std::vector<bool>(5, true));
  expect_own_foci(touch);
  // Their parts inside are connected no more than at the places where they enter.
  const touch::Touch inside = touch_inside(seen);
  ASSERT_EQ(inside.finger_count, 5u);
  for (std::uint32_t f = 0; f < 5; ++f)
    EXPECT_EQ(inside.fingers[f].contacts, touch.fingers[f].contacts) << f;
  expect_own_foci(inside);
}

TEST(Hands, RingAndMiddleFingerInAPlateAreTwo) {
  PALPA_SHARED_OR_SKIP(image, "depth-hand-sr305-ondris/20210326-230536_90.png");
  // A right hand, fingers up, side by side; a plate of 3 mm that they lie in. Between ring and middle finger (columns
  // 297 to 312 and 315 to 331) there is a gap of a few pixels without data, and a place where they touch.
  const Seen seen =
      look("plate", sr305(), band(sr305(), {{268, 200}, {370, 200}}, {{268, 135}, {370, 135}}, 0.563, 0.566), image);
  const auto holds_both = [&](const touch::Touch& touch) {
    int both = 0;
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      std::size_t ring = 0, middle = 0;
      for (const std::uint32_t i : touch.fingers[f].contacts) {
        const std::uint32_t u = touch.contacts[i].point % 640;
        ring += u >= 297 && u < 312 ? 1 : 0;
        middle += u >= 315 && u < 331 ? 1 : 0;
      }
      const std::size_t all = touch.fingers[f].contacts.size();
      both += 10 * ring >= all && 10 * middle >= all ? 1 : 0;
    }
    return both;
  };
  EXPECT_EQ(holds_both(touch_on_device(seen, {.finger_width_m = 0})), 1);
  EXPECT_EQ(holds_both(touch_on_device(seen)), 0);
}

TEST(Hands, TenFingertipsOnOneBody) {
  PALPA_SHARED_OR_SKIP(folder, "depth-hand-kinect1-candescent");
  const std::vector<HandTip> tips = test::read_tips(folder / "two_hands_labels.csv");
  ASSERT_EQ(tips.size(), 10u);
  const Seen seen = look("mask", kinect(), mask(kinect(), tips), folder / "two_hands.png");
  const touch::Touch touch = touch_on_device(seen);
  ASSERT_EQ(touch.finger_count, 10u);
  // The ring of contacts where a finger enters may be centimetres from its tip. With a shell as thick as the body, a
  // cluster is the whole part of a finger that is inside: each holds exactly one labelled tip and one of the rings.
  const touch::Parameters thick{.delta_m = 0.5};
  touch::Touch whole;
  touch::Stage(seen.solids, seen.cameras, {.parameters = thick}).touch(seen.images, whole);
  ASSERT_EQ(whole.finger_count, 10u);
  const auto points_of = [](const touch::Touch& from, std::uint32_t f) {
    std::vector<std::uint32_t> points;
    for (const std::uint32_t i : from.fingers[f].contacts)
      points.push_back(from.contacts[i].point);
    return points;
  };
  for (std::uint32_t f = 0; f < 10; ++f) {
    const std::vector<std::uint32_t> points = points_of(whole, f);
    const auto holds = [&](std::uint32_t point) { return std::binary_search(points.begin(), points.end(), point); };
    EXPECT_EQ(std::count_if(tips.begin(), tips.end(),
                            [&](const HandTip& tip) {
                              return holds(static_cast<std::uint32_t>(tip.pixel.v * 640 + tip.pixel.u));
                            }),
              1);
    int rings = 0;
    for (std::uint32_t g = 0; g < 10; ++g) {
      const std::vector<std::uint32_t> ring = points_of(touch, g);
      rings += std::all_of(ring.begin(), ring.end(), holds) ? 1 : 0;
    }
    EXPECT_EQ(rings, 1);
  }
  expect_own_foci(touch);
}

}  // namespace
}  // namespace palpa::session
