#include "sensing/synthetic.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <set>
#include <thread>

#include "array/layouts/layout.hpp"
#include "geometry/files/ply.hpp"
#include "pixel_rays.hpp"
#include "random_rig.hpp"
#include "sensing/rig.hpp"
#include "sensing/skin_twin.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::sensing {
namespace {

using geometry::Mesh;
using test::sphere;

void add_quad(Mesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c, d});
  mesh.triangles.emplace_back(first, first + 1, first + 2);
  mesh.triangles.emplace_back(first, first + 2, first + 3);
}

/// A square around `centre` spanned by two half axes.
Mesh square(const Vec3& centre, const Vec3& x, const Vec3& y) {
  Mesh mesh;
  add_quad(mesh, centre - x - y, centre + x - y, centre + x + y, centre - x + y);
  return mesh;
}

/// Moeller and Trumbore's intersection: the z depth scale t with origin + t * direction on the triangle; < 0: none.
double cast(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c, double slack) {
  const Vec3 e1 = b - a, e2 = c - a, p = glm::cross(direction, e2);
  const double det = glm::dot(e1, p);
  if (det == 0) return -1;
  const Vec3 s = origin - a, q = glm::cross(s, e1);
  const double u = glm::dot(s, p) / det, v = glm::dot(direction, q) / det;
  if (u < -slack || v < -slack || u + v > 1 + slack) return -1;
  return glm::dot(e2, q) / det;
}

double nearest_hit(const Mesh& mesh, const Vec3& origin, const Vec3& direction, double slack = 0) {
  double nearest = 1e300;
  for (const glm::uvec3& t : mesh.triangles) {
    const double hit = cast(origin, direction, mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z], slack);
    if (hit > 1e-6) nearest = std::min(nearest, hit);
  }
  return nearest;
}

std::vector<std::uint16_t> render_one(const Camera& camera, const Mesh& mesh, Noise noise, std::uint64_t sequence = 0,
                                      const Mesh& occluders = {}) {
  SyntheticRig rig({camera}, occluders, noise, 1);
  FrameSet set;
  const Posed posed{&mesh, Transform(1.0)};
  rig.render(std::span(&posed, 1), sequence, set);
  return set.frames[0].depth;
}

TEST(Synthetic, DepthsAreThoseOfRaysCastInDouble) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::size_t hits = 0, misses = 0;
  for (int round = 0; round < 40; ++round) {
    Camera camera = test::random_camera(random);
    Mesh mesh;  // a soup around the camera, some of it behind or through the image plane
    for (std::uint32_t i = 0; i < 12; ++i) {
      const Vec3 centre = 0.25 * Vec3(normal(random), normal(random), normal(random));
      for (int k = 0; k < 3; ++k)
        mesh.positions.push_back(centre + 0.2 * Vec3(normal(random), normal(random), normal(random)));
      mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    const auto depth = render_one(camera, mesh, Noise::none);
    const Vec3 eye(camera.T_world_camera[3]);
    for (std::uint32_t v = 0; v < camera.height; ++v) {
      for (std::uint32_t u = 0; u < camera.width; ++u) {
        const Vec2 ray = test::undistort(camera, {static_cast<double>(u), static_cast<double>(v)});
        const std::uint16_t raw = depth[v * camera.width + u];
        if (std::isnan(ray.x)) {
          ASSERT_EQ(raw, 0);
          continue;
        }
        const Vec3 direction = transform_direction(camera.T_world_camera, Vec3(ray, 1));
        // Rays that pass an edge closely may hit or miss.
        const double outer = nearest_hit(mesh, eye, direction, 1e-5), inner = nearest_hit(mesh, eye, direction, -1e-5);
        const double limit = std::min(65535 * camera.depth_unit_m, 1e3);
        if (outer != inner || (inner > limit * 0.999 && inner < 1e300)) continue;
        if (inner > limit || inner < first_valid_depth(camera) * camera.depth_unit_m) {
          const bool at_limit = std::abs(inner / camera.depth_unit_m - first_valid_depth(camera)) <= 1;
          ASSERT_TRUE(raw == 0 || at_limit) << inner;
          ++misses;
          continue;
        }
        ASSERT_NEAR(raw * camera.depth_unit_m, inner, camera.depth_unit_m * 0.501 + 1e-6 * inner) << u << "," << v;
        ++hits;
      }
    }
  }
  EXPECT_GT(hits, 20000u);
  EXPECT_GT(misses, 20000u);
}

TEST(Synthetic, AClosedSurfaceHasNoCracks) {
  const Mesh ball = sphere(0.1, 64, 128);
  const Camera camera = test::d415(test::look_at(Vec3(0.3, 0.2, 0.35), Vec3(0)));
  const auto depth = render_one(camera, ball, Noise::none);
  const Vec3 eye(camera.T_world_camera[3]);
  std::size_t inside = 0;
  for (std::uint32_t v = 0; v < 480; ++v) {
    for (std::uint32_t u = 0; u < 848; ++u) {
      const Vec3 ray = glm::normalize(transform_direction(
          camera.T_world_camera, Vec3(test::undistort(camera, {static_cast<double>(u), static_cast<double>(v)}), 1)));
      const double off_axis = glm::length(eye - glm::dot(eye, ray) * ray);
      if (off_axis > 0.0995) continue;
      ++inside;
      ASSERT_NE(depth[v * 848 + u], 0) << u << "," << v;
    }
  }
  EXPECT_GT(inside, 50000u);
}

TEST(Synthetic, OccludersHideAndAreSeen) {
  const Camera camera = test::d415(Transform(1.0));
  const Mesh wall = square(Vec3(0, 0, 0.9), Vec3(2, 0, 0), Vec3(0, 2, 0));
  const Mesh board = square(Vec3(-1, 0, 0.5), Vec3(1, 0, 0), Vec3(0, 2, 0));  // the image's left half
  const auto depth = render_one(camera, wall, Noise::none, 0, board);
  EXPECT_EQ(depth[240 * 848 + 200], 5000);
  EXPECT_EQ(depth[240 * 848 + 600], 9000);
  const Mesh near = square(Vec3(0, 0, 0.27), Vec3(2, 0, 0), Vec3(0, 2, 0));  // nearer than the range: no data, but it
                                                                             // hides what is behind it
  EXPECT_EQ(render_one(camera, near, Noise::none, 0, board)[240 * 848 + 200], 0);
}

struct Statistics {
  double mean = 0, sigma = 0, lag1 = 0, lag2 = 0, lag3 = 0, lag1_down = 0, holes = 0;
};

/// Statistics of the errors relative to `z` in a rectangle of the image.
Statistics measure(const std::vector<std::uint16_t>& depth, const Camera& camera, double z) {
  Statistics s;
  std::vector<double> error(depth.size(), NAN);
  double count = 0, zeros = 0, squares = 0;
  for (std::uint32_t v = 40; v < 440; ++v) {
    for (std::uint32_t u = 40; u < 800; ++u) {
      const std::size_t i = std::size_t{v} * camera.width + u;
      if (depth[i] == 0) {
        ++zeros;
        continue;
      }
      error[i] = depth[i] * camera.depth_unit_m - z;
      s.mean += error[i];
      squares += error[i] * error[i];
      ++count;
    }
  }
  s.mean /= count;
  s.sigma = std::sqrt(squares / count - s.mean * s.mean);
  s.holes = zeros / (zeros + count);
  const auto correlation = [&](std::size_t step) {
    double sum = 0, pairs = 0;
    for (std::size_t i = 0; i + step < error.size(); ++i) {
      if (std::isnan(error[i]) || std::isnan(error[i + step])) continue;
      sum += (error[i] - s.mean) * (error[i + step] - s.mean);
      ++pairs;
    }
    return sum / pairs / (s.sigma * s.sigma);
  };
  s.lag1 = correlation(1);
  s.lag2 = correlation(2);
  s.lag3 = correlation(3);
  s.lag1_down = correlation(camera.width);
  return s;
}

TEST(Synthetic, NoiseOnAPlaneIsAsStated) {
  const Camera camera = test::d415(Transform(1.0));
  for (const double z : {0.35, 0.45, 0.8}) {
    const Mesh wall = square(Vec3(0, 0, z), Vec3(2, 0, 0), Vec3(0, 2, 0));
    const Statistics s = measure(render_one(camera, wall, Noise::d415, 5), camera, z);
    // sigma = z^2 * 0.08 px / (fx * 55 mm), plus the effect of the steps of 1/32 px and 0.1 mm.
    const double per_pixel = z * z / (640 * 0.055);
    const double expected = std::sqrt(std::pow(0.08 * per_pixel, 2) + std::pow(per_pixel / 32, 2) / 12 + 1e-8 / 12);
    EXPECT_NEAR(s.sigma / expected, 1, 0.02) << z;
    // Disparity steps beat with depth units, so the average of a few need not be zero.
    EXPECT_NEAR(s.mean, 0, 0.03 * expected + camera.depth_unit_m / 5) << z;
    EXPECT_NEAR(s.lag1, 2.0 / 3, 0.03) << z;
    EXPECT_NEAR(s.lag1_down, 2.0 / 3, 0.03) << z;
    EXPECT_NEAR(s.lag2, 1.0 / 6, 0.03) << z;
    EXPECT_NEAR(s.lag3, 0, 0.02) << z;
    EXPECT_EQ(s.holes, 0) << z;
  }
  EXPECT_NEAR(0.45 * 0.45 * 0.08 / (640 * 0.055), 0.46e-3, 1e-5);  // the figure known for the D415
}

TEST(Synthetic, DepthsAreThoseOfWholeDisparitySteps) {
  const Camera camera = test::d415(Transform(1.0));
  const Mesh wall = square(Vec3(0, 0, 0.8), Vec3(2, 0, 0), Vec3(0, 2, 0));
  const auto depth = render_one(camera, wall, Noise::d415);
  const std::set<std::uint16_t> values(depth.begin(), depth.end());
  EXPECT_LT(values.size(), 40u);  // 10 sigma are 0.8 px, so 26 steps
  for (const std::uint16_t raw : values) {
    if (raw == 0) continue;
    const double steps = 640 * 0.055 / (raw * 1e-4) * 32;
    EXPECT_NEAR(steps, std::round(steps), 0.1);  // a depth unit is 0.18 steps here
  }
}

TEST(Synthetic, SilhouettesHaveHolesAndFlyingPixels) {
  const Camera camera = test::d415(Transform(1.0));
  Mesh scene = square(Vec3(0, 0, 0.8), Vec3(2, 0, 0), Vec3(0, 2, 0));
  geometry::append(scene, square(Vec3(0, 0, 0.4), Vec3(0.1, 0, 0), Vec3(0, 0.1, 0)));  // 320 x 320 pixels
  const auto exact = render_one(camera, scene, Noise::none);
  double rim = 0, holes = 0, flying = 0, elsewhere = 0;
  for (int sequence = 0; sequence < 8; ++sequence) {
    const auto depth = render_one(camera, scene, Noise::d415, sequence);
    for (int v = 80; v < 400; ++v) {
      for (int u = 200; u < 650; ++u) {
        const int i = v * 848 + u;
        bool near_edge = false;
        for (const int step : {-2, -1, 1, 2}) {
          near_edge |= std::abs(exact[i + step] - exact[i]) > 100 || std::abs(exact[i + 848 * step] - exact[i]) > 100;
        }
        const bool hole = depth[i] == 0;
        const bool between = depth[i] > 4100 && depth[i] < 7700;
        if (!near_edge) elsewhere += hole || between;
        if (!near_edge) continue;
        ++rim;
        holes += hole;
        flying += between;
      }
    }
  }
  EXPECT_EQ(elsewhere, 0);
  ASSERT_GT(rim, 20000);
  EXPECT_NEAR(holes / rim, D415::rim_holes, 0.02);
  EXPECT_NEAR(flying / rim, D415::rim_flying * 0.91, 0.02);  // some of them hardly leave their side
}

TEST(Synthetic, GrazingSurfacesLoseData) {
  const Camera camera = test::d415(Transform(1.0));
  // Planes through (0, 0, 0.6) whose normal is tilted so that the middle of the image sees them at a given cosine.
  for (const auto& [cosine, share] : {std::pair(0.5, 0.0), std::pair(0.2, 0.5), std::pair(0.05, 1.0)}) {
    const double sine = std::sqrt(1 - cosine * cosine);
    const Mesh plane = square(Vec3(0, 0, 0.6), 0.3 * Vec3(cosine, 0, sine), Vec3(0, 2, 0));
    const auto depth = render_one(camera, plane, Noise::d415);
    double holes = 0, count = 0;
    for (int v = 200; v < 280; ++v) {
      for (int u = 423; u < 425; ++u) {
        ++count;
        holes += depth[v * 848 + u] == 0;
      }
    }
    EXPECT_NEAR(holes / count, share, 0.13) << cosine;
  }
}

TEST(Synthetic, TheSameSeedGivesTheSameBytesOnAnyThread) {
  const Camera camera = test::d415(test::look_at(Vec3(0.1, -0.2, 0.4), Vec3(0)));
  const Mesh ball = sphere(0.06, 24, 48);
  std::vector<std::vector<std::uint16_t>> results(4);
  std::vector<std::thread> threads;
  threads.reserve(results.size());
  for (auto& result : results)
    threads.emplace_back([&] { result = render_one(camera, ball, Noise::d415, 7); });
  for (auto& thread : threads)
    thread.join();
  for (const auto& result : results)
    EXPECT_EQ(result, results[0]);
  EXPECT_NE(render_one(camera, ball, Noise::d415, 8), results[0]);
  const Posed posed{&ball, Transform(1.0)};
  FrameSet set;
  SyntheticRig({camera}, {}, Noise::d415, 2).render(std::span(&posed, 1), 7, set);
  EXPECT_NE(set.frames[0].depth, results[0]);
}

TEST(Synthetic, SourceDeliversEveryFrameUnlessPaced) {
  const Camera camera = test::d415(test::look_at(Vec3(0, -0.2, 0.3), Vec3(0)));
  SyntheticOptions options;
  options.paced = false;
  options.frames = 5;
  const auto source = make_synthetic_source({camera}, sphere(0.01, 8, 16), {}, options);
  FrameSet set;
  for (std::uint64_t i = 0; i < 5; ++i) {
    ASSERT_TRUE(source->next(set, 1));
    EXPECT_EQ(set.sequence, i);
    EXPECT_EQ(set.time_s, static_cast<double>(i) / 90);
    EXPECT_EQ(set.frames.at(0).time_s, set.time_s);
  }
  EXPECT_FALSE(source->next(set, 1));

  options.paced = true;
  options.rate_hz = 1;
  options.frames = 2;
  const auto slow = make_synthetic_source({camera}, sphere(0.01, 8, 16), {}, options);
  ASSERT_TRUE(slow->next(set, 1));
  EXPECT_EQ(set.sequence, 0u);
  ASSERT_TRUE(slow->next(set, 0.001));  // the next one is a second away
  EXPECT_TRUE(set.frames.empty());
  EXPECT_ERROR(make_synthetic_source({}, sphere(0.01, 8, 16), {}, {}), Exit::usage, "needs a camera");
}

TEST(Synthetic, FingertipDips) {
  EXPECT_EQ(dipping_motion(0)[3].y, 0);
  EXPECT_NEAR(dipping_motion(0.5)[3].y, -0.004, 1e-12);
  EXPECT_NEAR(dipping_motion(1.5)[3].y, 0.004, 1e-12);
}

/// The contacts of a 3 mm touch of the 4 cm cube whose top is at y = 0: vertices less than 1.5 mm below the top.
std::vector<Vec3> cube_contacts(const Mesh& finger) {
  std::vector<Vec3> contacts;
  for (const Vec3& p : finger.positions) {
    if (p.y < 0 && p.y > -1.5e-3 && std::max(std::abs(p.x), std::abs(p.z)) < 0.0185) contacts.push_back(p);
  }
  return contacts;
}

Mesh lowered_finger() {
  const geometry::Ply ply = geometry::read_ply(test::source_file("assets/finger.ply"));
  Mesh finger{ply.positions, ply.triangles};
  for (Vec3& p : finger.positions)
    p.y -= 3e-3;
  return finger;
}

Mesh boards_of(const Rig& rig) {
  const array::Layout layout = array::transformed(array::load_layout(rig.array->layout), *rig.array->T_world_layout);
  Mesh boards;
  for (const array::Board& board : layout.boards) {
    const Vec3 x = transform_direction(board.T_layout_board, Vec3(board.width_m / 2, 0, 0));
    const Vec3 y = transform_direction(board.T_layout_board, Vec3(0, board.height_m / 2, 0));
    geometry::append(boards, square(Vec3(board.T_layout_board[3]), x, y));
  }
  return boards;
}

TEST(PaperRig, SeesTheContactsOfTheCubeTouch) {
  const Rig rig = load_rig(test::source_file("assets/rigs/paper.toml"));
  ASSERT_EQ(rig.cameras.size(), 3u);
  ASSERT_TRUE(rig.array && rig.screen);
  const Mesh finger = lowered_finger(), boards = boards_of(rig);
  ASSERT_EQ(boards.triangles.size(), 32u);
  const std::vector<Vec3> contacts = cube_contacts(finger);
  ASSERT_GT(contacts.size(), 100u);
  std::vector<int> seen_by(4, 0);
  int seen = 0;
  for (const Vec3& contact : contacts) {
    bool any = false;
    for (std::size_t c = 0; c < 3; ++c) {
      const Camera& camera = rig.cameras[c];
      const Vec3 eye(camera.T_world_camera[3]);
      EXPECT_GE(glm::length(eye - contact), 0.31);
      const Vec2 pixel = project(camera, transform_point(glm::inverse(camera.T_world_camera), contact));
      ASSERT_TRUE(pixel.x > 0 && pixel.y > 0 && pixel.x < 847 && pixel.y < 479);
      // Nothing lies in front of the contact itself, to within a tenth of a millimetre.
      const bool visible =
          std::min(nearest_hit(finger, eye, contact - eye), nearest_hit(boards, eye, contact - eye)) > 1 - 3e-4;
      any |= visible;
      seen_by[c] += visible;
    }
    seen += any;
  }
  const double share = static_cast<double>(seen) / static_cast<double>(contacts.size());
  EXPECT_GE(share, 0.9);
  for (int c = 0; c < 3; ++c)
    EXPECT_GT(seen_by[c], 0);
}

// An object appears where it is felt if each eye sees its places where the line of sight meets the screen. These places
// must be on the screen, with no board in between.
TEST(PaperRig, BothEyesSeeAllOfTheWorkspaceOnTheScreen) {
  const Rig rig = load_rig(test::source_file("assets/rigs/paper.toml"));
  const Mesh boards = boards_of(rig);
  const Screen& screen = *rig.screen;
  const Transform T_screen_world = glm::inverse(screen.T_world_screen);
  for (const double beside : {-0.0315, 0.0, 0.0315}) {
    const Vec3 eye = screen.eye_m + beside * Vec3(screen.T_world_screen[0]);
    const Vec3 e = transform_point(T_screen_world, eye);
    for (int i = 0; i < 8; ++i) {  // around the paper's four objects
      const Vec3 corner(i & 1 ? 0.02 : -0.02, i & 2 ? 0 : -0.0483, i & 4 ? 0.02 : -0.02);
      const Vec3 c = transform_point(T_screen_world, corner);
      const Vec3 on = e + (c - e) * (e.z / (e.z - c.z));
      EXPECT_LT(std::abs(on.x), screen.width_m / 2) << beside << ' ' << i;
      EXPECT_LT(std::abs(on.y), screen.height_m / 2) << beside << ' ' << i;
      EXPECT_GT(nearest_hit(boards, eye, transform_point(screen.T_world_screen, on) - eye), 1) << beside << ' ' << i;
    }
  }
}

TEST(PaperRig, NoiseKeepsThePointsInTheShell) {
  const Rig rig = load_rig(test::source_file("assets/rigs/paper.toml"));
  const Mesh finger = lowered_finger();
  const Box shell{Vec3(-0.02, -1.5e-3, -0.02), Vec3(0.02, 0, 0.02)};
  for (const Noise noise : {Noise::none, Noise::d415}) {
    SyntheticRig synthetic(rig.cameras, boards_of(rig), noise, 1);
    FrameSet set;
    const Posed posed{&finger, Transform(1.0)};
    synthetic.render(std::span(&posed, 1), 0, set);
    const auto skin = find_skin(rig.cameras, set.frames, shell);
    double radius = 0;
    for (const SkinPoint& point : skin)
      radius += std::hypot(point.position.x, point.position.z) / static_cast<double>(skin.size());
    EXPECT_GT(skin.size(), 200u);
    EXPECT_NEAR(radius, 5.6e-3, 0.6e-3);
  }
}

TEST(Synthetic, AFrameIsTheSameWhateverWasRenderedBefore) {
  const Rig rig = load_rig(test::source_file("assets/rigs/paper.toml"));
  const Mesh occluders = square(Vec3(0, -0.15, 0), Vec3(0.1, 0, 0), Vec3(0, 0, 0.08)), ball = sphere(0.02, 12, 24);
  const auto at = [](double x, double y, double z) { return glm::translate(Transform(1.0), Vec3(x, y, z)); };
  // In the middle, moved a little, none, at the images' borders, half outside, two, a large one, none.
  const std::vector<std::vector<Posed>> scenes{{{&ball, at(0, 0, 0)}},
                                               {{&ball, at(0.001, 0, 0)}},
                                               {},
                                               {{&ball, at(0.14, 0, 0)}},
                                               {{&ball, at(-0.2, 0.1, 0.1)}},
                                               {{&ball, at(0, 0, 0.03)}, {&ball, at(-0.05, 0.02, 0)}},
                                               {{&ball, at(0, 0.15, 0)}},
                                               {}};
  for (const Noise noise : {Noise::none, Noise::d415}) {
    SyntheticRig live(rig.cameras, occluders, noise, 7);
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      SyntheticRig fresh(rig.cameras, occluders, noise, 7);
      FrameSet got, expected;
      live.render(scenes[s], s, got);
      fresh.render(scenes[s], s, expected);
      for (std::size_t c = 0; c < rig.cameras.size(); ++c)
        EXPECT_EQ(got.frames[c].depth, expected.frames[c].depth) << "scene " << s << ", camera " << c;
    }
  }
}

TEST(Synthetic, AFrameTakesAtMostThreeQuartersOfItsTime) {
#if defined(PALPA_ADDRESS_SANITIZER) || defined(PALPA_THREAD_SANITIZER) || !defined(NDEBUG)
  GTEST_SKIP() << "skipped: this build slows programs down";
#endif
  const Rig rig = load_rig(test::source_file("assets/rigs/paper.toml"));
  const geometry::Ply finger = geometry::read_ply(test::source_file("assets/finger.ply"));
  const Mesh skin{finger.positions, finger.triangles};
  SyntheticRig synthetic(rig.cameras, square(Vec3(0, -0.15, 0), Vec3(0.1, 0, 0), Vec3(0, 0, 0.08)), Noise::d415, 1);
  const auto processor_s = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
  };
  std::vector<double> taken_s;
  FrameSet set;
  for (std::uint64_t s = 0; s < 20; ++s) {
    const Posed posed{&skin, dipping_motion(static_cast<double>(s) / 45)};
    double least_s = 1;
    for (int again = 0; again < 3; ++again) {  // programs beside this one make it slower, too
      const double begin_s = processor_s();
      synthetic.render(std::span(&posed, 1), s, set);
      least_s = std::min(least_s, processor_s() - begin_s);
    }
    taken_s.push_back(least_s);
  }
  std::nth_element(taken_s.begin(), taken_s.begin() + 10, taken_s.end());
  EXPECT_LT(taken_s[10], 0.75 / 90);
}

}  // namespace
}  // namespace palpa::sensing
