// Foci glide: a finger that slides, leans and is seen with the D415's noise, with and without following; and equal arc
// lengths.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "geometry/files/ply.hpp"
#include "sensing/synthetic.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "touch/fingertips.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

/// A finger that slowly slides by a few millimetres, leans and turns about its own axis.
Transform sliding(double t, double press_m) {
  const double turn = 0.5 * t, lean = 0.25 * std::sin(2 * t);
  const Vec3 body(std::sin(lean) * std::cos(t), std::cos(lean), std::sin(lean) * std::sin(t));
  const Vec3 side = glm::normalize(glm::cross(Vec3(std::sin(turn), 0, std::cos(turn)), body));
  Transform T(Vec4(side, 0), Vec4(body, 0), Vec4(glm::cross(side, body), 0), Vec4(0, 0, 0, 1));
  T[3] = Vec4(0.003 * std::sin(1.5 * t), -press_m, 0.003 * std::sin(1.1 * t), 1);
  return T;
}

struct Steps {
  std::vector<double> way;  ///< of each focus from frame to frame, less the centroid's
  double quantile(double share) {
    std::sort(way.begin(), way.end());
    return way.empty() ? 0 : way[static_cast<std::size_t>(share * static_cast<double>(way.size() - 1))];
  }
};

/// Frames of the sliding finger on an object, each by itself and followed.
struct Slide {
  Steps alone, followed;
  std::size_t frames = 0;
};

Slide slide_on(const std::string& name, Spacing spacing) {
  const geometry::Ply ply = geometry::read_ply(palpa::test::source_file("assets/finger.ply"));
  const geometry::Mesh finger{ply.positions, ply.triangles};
  const auto cameras = paper_cameras(3);
  sensing::SyntheticRig rig(cameras, {}, sensing::Noise::d415, 4);
  const Parameters parameters{.spacing = spacing, .finger_width_m = 0.016};
  Stage alone(object(name), cameras, {.parameters = parameters});
  Stage followed(object(name), cameras, {.parameters = parameters, .follow = true});
  std::array<Touch, 2> before, now;
  Slide slide;
  for (int k = 0; k < 60; ++k) {
    const double t = k / 90.0;
    const sensing::Posed posed{&finger, sliding(t, 3e-3)};
    sensing::FrameSet set;
    rig.render(std::span(&posed, 1), static_cast<std::uint64_t>(k), set);
    alone.touch(set.frames, now[0]);
    followed.touch(set.frames, now[1], t);
    for (int way = 0; way < 2; ++way) {
      Steps& steps = way == 0 ? slide.alone : slide.followed;
      if (k > 0 && before[way].finger_count == 1 && now[way].finger_count == 1) {
        const Finger &a = before[way].fingers[0], &b = now[way].fingers[0];
        const glm::vec3 shift = b.section.centroid - a.section.centroid;
        for (std::size_t n = 0; n < std::min(a.foci.size(), b.foci.size()); ++n) {
          if (a.foci[n].points && b.foci[n].points)
            steps.way.push_back(glm::distance(b.foci[n].position, a.foci[n].position + shift));
        }
      }
    }
    before = now;
    ++slide.frames;
  }
  return slide;
}

TEST(Steady, FociGlideOnRoundCrossSections) {
  for (const char* name : {"cube", "semi-sphere"}) {
    for (const Spacing spacing : {Spacing::angle, Spacing::arc}) {
      Slide slide = slide_on(name, spacing);
      ASSERT_GT(slide.followed.way.size(), 500u) << name;
      std::printf(
          "%s, %s: foci move by %.2f mm (median), %.2f (95 %%), %.2f (most) each frame by itself; "
          "%.2f, %.2f, %.2f followed\n",
          name, spacing == Spacing::arc ? "arc" : "angle", slide.alone.quantile(0.5) * 1e3,
          slide.alone.quantile(0.95) * 1e3, slide.alone.quantile(1) * 1e3, slide.followed.quantile(0.5) * 1e3,
          slide.followed.quantile(0.95) * 1e3, slide.followed.quantile(1) * 1e3);
      EXPECT_LT(slide.followed.quantile(0.95), 0.8e-3) << name;
      EXPECT_LT(slide.followed.quantile(1), 2e-3) << name;
    }
  }
}

/// Points of an ellipse's rim in the plane y = 0, evenly by its angle, a band of 0.8 mm.
std::vector<glm::vec3> rim(double a, double b, std::uint32_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<glm::vec3> points;
  // Evenly along the rim: angles are kept in proportion to the rim's length there.
  const double most = std::max(a, b);
  while (points.size() < count) {
    const double angle = 2 * std::numbers::pi * unit(random),
                 speed = std::hypot(a * std::sin(angle), b * std::cos(angle));
    if (unit(random) * most > speed) continue;
    const double wide = 1 + (unit(random) - 0.5) * 0.8e-3 / most;
    points.emplace_back(a * wide * std::cos(angle), 2e-4 * (unit(random) - 0.5), b * wide * std::sin(angle));
  }
  return points;
}

struct Polar {
  double angle = 0, radius = 0;  ///< in the scaled plane, the angle in [0, 2 pi)
};

double angle_of(const Vec2& p) {
  const double angle = std::atan2(p.y, p.x);
  return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

/// Where the sectors begin, as docs/touch.md says it: equal angles, or equal lengths of the outline.
std::vector<double> borders_of(const std::vector<Polar>& contacts, const CrossSection& section, std::uint32_t foci,
                               Spacing spacing) {
  constexpr std::uint32_t bins = 64;
  std::vector<double> borders;
  if (spacing == Spacing::angle) {
    for (std::uint32_t n = 0; n < foci; ++n)
      borders.push_back(2 * std::numbers::pi * n / foci);
    return borders;
  }
  std::array<double, bins> sums{}, counts{}, radii{};
  for (const Polar& p : contacts) {
    const auto bin = static_cast<std::uint32_t>(p.angle / (2 * std::numbers::pi) * bins) % bins;
    sums[bin] += p.radius;
    ++counts[bin];
  }
  for (std::uint32_t m = 0; m < bins; ++m) {
    std::uint32_t back = 0, on = 0;
    for (; counts[(m + bins - back) % bins] == 0; ++back) {
    }
    for (; counts[(m + on) % bins] == 0; ++on) {
    }
    const std::uint32_t before = (m + bins - back) % bins, after = (m + on) % bins;
    const double share = back + on == 0 ? 0 : static_cast<double>(back) / (back + on);
    radii[m] = (1 - share) * sums[before] / counts[before] + share * sums[after] / counts[after];
  }
  const auto corner = [&](std::uint32_t m) {
    const double radius = (radii[(m + bins - 2) % bins] + 3 * radii[(m + bins - 1) % bins] + 3 * radii[m % bins] +
                           radii[(m + 1) % bins]) /
                          8;
    const double angle = 2 * std::numbers::pi * m / bins;
    return radius * Vec2(std::cos(angle), std::sin(angle));
  };
  const Vec2 metres(std::sqrt(section.eigenvalues[0]), std::sqrt(section.eigenvalues[1]));
  std::array<double, bins + 1> way{};
  for (std::uint32_t m = 0; m < bins; ++m)
    way[m + 1] = way[m] + glm::length((corner(m + 1) - corner(m)) * metres);
  for (std::uint32_t n = 0; n < foci; ++n) {
    const double cut = way[bins] * n / foci;
    const auto side = static_cast<std::uint32_t>(std::upper_bound(way.begin(), way.end(), cut) - way.begin()) - 1;
    const double share = (cut - way[side]) / (way[side + 1] - way[side]);
    borders.push_back(angle_of(glm::mix(corner(side), corner(side + 1), share)));
  }
  return borders;
}

/// How many of a finger's sectors hold contacts: in double precision and by arctangents, from its axes and eigenvalues.
std::size_t sectors_with_contacts(const Touch& touch, const Finger& finger, std::uint32_t foci, Spacing spacing) {
  const CrossSection& s = finger.section;
  Vec3 centroid(0);
  for (const std::uint32_t i : finger.contacts)
    centroid += Vec3(touch.contacts[i].position) / static_cast<double>(finger.contacts.size());
  std::vector<Polar> contacts;
  for (const std::uint32_t i : finger.contacts) {
    const Vec3 d = Vec3(touch.contacts[i].position) - centroid;
    // Clockwise seen from the tip of w3.
    const Vec2 p(glm::dot(d, Vec3(s.axes[0])) / std::sqrt(s.eigenvalues[0]),
                 -glm::dot(d, Vec3(s.axes[1])) / std::sqrt(s.eigenvalues[1]));
    contacts.push_back({angle_of(p), glm::length(p)});
  }
  const std::vector<double> borders = borders_of(contacts, s, foci, spacing);
  std::vector<bool> held(foci, false);
  for (const Polar& p : contacts)
    held[static_cast<std::size_t>(std::upper_bound(borders.begin(), borders.end(), p.angle) - borders.begin()) - 1] =
        true;
  return static_cast<std::size_t>(std::count(held.begin(), held.end(), true));
}

/// Largest gap between neighbouring foci over the smallest, of as many as there must be; a sector without contacts has
/// none.
double unevenness(const Finger& finger, std::size_t count) {
  std::vector<glm::vec3> foci;
  for (const Focus& focus : finger.foci) {
    if (focus.points) foci.push_back(focus.position);
  }
  EXPECT_EQ(foci.size(), count);
  double least = 1e300, most = 0;
  for (std::size_t n = 0; n < foci.size(); ++n) {
    const double gap = glm::distance(foci[n], foci[(n + 1) % foci.size()]);
    least = std::min(least, gap);
    most = std::max(most, gap);
  }
  return most / least;
}

TEST(Arc, SpacesTheFociOfAnEllipseEvenly) {
  for (const double length : {5e-3, 8e-3, 12e-3, 16e-3}) {
    Parameters parameters = everything_is_contact();
    const auto points = rim(length, 4e-3, 3000, 2);
    const double angle = unevenness(touch_on(Backend::cpu, points, {everything()}, parameters).fingers.at(0), 10);
    parameters.spacing = Spacing::arc;
    const double arc = unevenness(touch_on(Backend::cpu, points, {everything()}, parameters).fingers.at(0), 10);
    std::printf("ellipse %g x 4 mm: largest over smallest gap %.2f by angle, %.2f by arc\n", length * 1e3, angle, arc);
    // Not 1: a sector that goes round the sharp end has its centroid well inside of the rim.
    EXPECT_LT(arc, 1.9);
    if (length > 6e-3) {
      EXPECT_LT(arc, 0.9 * angle);
    }
  }
}

TEST(Arc, CutsAnOutlineIntoPiecesOfEqualLength) {
  // The rim's points are evenly along it, so that equal lengths have equally many: an independent measure.
  Parameters parameters = everything_is_contact();
  parameters.spacing = Spacing::arc;
  for (const std::uint32_t foci : {1U, 2U, 3U, 7U, 10U, 24U, 64U}) {
    parameters.foci = foci;
    const Touch touch = touch_on(Backend::cpu, rim(12e-3, 4e-3, 30'000, 3), {everything()}, parameters);
    const Finger& finger = touch.fingers.at(0);
    ASSERT_EQ(finger.foci.size(), foci);
    std::uint32_t members = 0;
    for (const Focus& focus : finger.foci) {
      EXPECT_NEAR(focus.points, 30'000.0 / foci, 0.06 * 30'000 / foci + 40) << foci;
      members += focus.points;
    }
    EXPECT_EQ(members, 30'000u);
  }
}

TEST(ArcOnThePrism, MakesGapsMoreEqual) {
  // A finger across the ridge: two faces make a long cross-section. It is about as high as it is wide there, so that
  // noise turns its plane about the ridge (w3 leans by 11 to 72 degrees); upright, the plane shows a roof that is
  // open below, and sectors there have no contacts.
  const auto cameras = paper_cameras(3);
  Touch touch;
  std::array<double, 2> sums{};
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto images = images_of(cameras, {{.press_m = 4e-3}}, seed);
    for (const Spacing spacing : {Spacing::angle, Spacing::arc}) {
      const Parameters parameters{.spacing = spacing, .finger_width_m = 0.016};
      Stage(object("prism"), cameras, {.parameters = parameters}).touch(images, touch);
      ASSERT_EQ(touch.finger_count, 1u);
      const Finger& finger = touch.fingers[0];
      const std::size_t held = sectors_with_contacts(touch, finger, parameters.foci, spacing);
      sums[spacing == Spacing::arc ? 1 : 0] += unevenness(finger, held) / 5;
    }
  }
  std::printf("prism: largest over smallest gap %.2f by angle, %.2f by arc\n", sums[0], sums[1]);
  EXPECT_LT(sums[1], sums[0]);
}

TEST(Arc, EverySolidMayHaveItsOwnNumberOfFoci) {
  std::vector<geometry::Solid> solids{box(Vec3(-1, -1, -1), Vec3(0, 1, 1), "left"),
                                      box(Vec3(0.01, -1, -1), Vec3(1), "right")};
  solids[1].haptics.foci = 7;
  auto points = rim(8e-3, 5e-3, 1000, 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i].x += i < 500 ? -0.05F : 0.05F;
  const Touch touch = touch_on(Backend::cpu, points, solids, everything_is_contact());
  ASSERT_EQ(touch.finger_count, 2u);
  EXPECT_EQ(touch.fingers[0].foci.size(), 10u);
  EXPECT_EQ(touch.fingers[1].foci.size(), 7u);
  for (const Focus& focus : touch.fingers[1].foci)
    EXPECT_GT(focus.points, 0u);
  solids[1].haptics.foci = 65;
  EXPECT_ERROR(touch_on(Backend::cpu, points, solids, everything_is_contact()), Exit::usage,
               "solid 'right' asks for 65 foci");
}

}  // namespace
}  // namespace palpa::touch::test
