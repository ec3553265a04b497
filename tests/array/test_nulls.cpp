// Drives with nulls, by code of the test's own: how deep nulls are, and what they cost.
#include "array/nulls/nulls.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "array/drive.hpp"
#include "array/layouts/layout.hpp"
#include "backends.hpp"
#include "support/instrumented.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

constexpr double turn = 2 * std::numbers::pi;

/// The sound at a place: sum of amplitude D e^{i (phase + k d)} / d, in 1/m. Independent of the solvers.
Complex sound_at(const Layout& layout, const std::vector<Complex>& drive, const Vec3& place,
                 const Medium& medium = {}) {
  const double k = turn * medium.frequency / medium.sound_speed;
  Complex sum = 0;
  for (std::size_t n = 0; n < drive.size(); ++n) {
    const Vec3 way = place - layout.transducers[n].position;
    const double distance = glm::length(way);
    const double loud = directivity(Directivity::t4010a1, glm::dot(way, layout.transducers[n].axis) / distance, 0);
    sum += drive[n] * std::polar(loud / distance, k * distance);
  }
  return sum;
}

std::vector<Complex> complex_of(const Drive& drive) {
  std::vector<Complex> values;
  for (const TransducerDrive& one : drive)
    values.push_back(std::polar(double{one.amplitude}, double{one.phase}));
  return values;
}

/// Phases as a board has them.
std::vector<Complex> rounded(const Drive& drive, double steps) {
  std::vector<Complex> values;
  for (const TransducerDrive& one : drive)
    values.push_back(std::polar(double{one.amplitude}, turn * std::round(one.phase / turn * steps) / steps));
  return values;
}

double decibels(double ratio) {
  return 20 * std::log10(std::max(ratio, 1e-30));
}

struct Places {
  std::vector<SlotFocus> foci;
  std::vector<Null> nulls;
};

/// Places in a box, at least 10 mm apart across a flat board's beam, or in any direction.
Places random_places(std::mt19937& random, const Vec3& centre, bool flat, std::size_t foci = 4, std::size_t nulls = 4) {
  std::uniform_real_distribution<double> place(-1, 1);
  std::vector<Vec3> all;
  while (all.size() < foci + nulls) {
    const double x = place(random), y = place(random), z = place(random);
    const Vec3 next = centre + Vec3(30e-3, 30e-3, flat ? 20e-3 : 30e-3) * Vec3(x, y, z);
    const Vec3 across(1, 1, flat ? 0 : 1);
    if (std::ranges::all_of(all, [&](const Vec3& other) { return glm::length((other - next) * across) >= 10e-3; }))
      all.push_back(next);
  }
  Places places;
  for (std::size_t i = 0; i < all.size(); ++i)
    i < foci ? places.foci.push_back({all[i]}) : places.nulls.push_back({all[i]});
  return places;
}

/// Two rows of four, foci and nulls in turn: each null lies in the middle between foci, where their sounds meet in
/// phase.
Places checkerboard(const Vec3& centre, const Vec3& u, const Vec3& v, double spacing_m) {
  Places places;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 2; ++j) {
      const Vec3 at = centre + spacing_m * ((i - 1.5) * u + (j - 0.5) * v);
      (i + j) % 2 == 0 ? places.foci.push_back({at}) : places.nulls.push_back({at});
    }
  }
  return places;
}

DriveOptions options_for(const Layout& layout, const std::vector<Null>& nulls, Constraint constraint) {
  DriveOptions options;
  options.solver = Solver::gs_pat;
  options.constraint = constraint;
  if (!nulls.empty()) options.nulls = std::make_shared<const Nulls>(layout, options.medium, options.directivity, nulls);
  return options;
}

/// The drive for the foci with these nulls.
Drive drive_of(const Layout& layout, const Places& places, const std::vector<Null>& nulls, Constraint constraint) {
  const Drive drive = drive_for(layout, places.foci, options_for(layout, nulls, constraint));
  EXPECT_EQ(faults(drive), 0u);
  return drive;
}

struct Heard {
  double weakest = std::numeric_limits<double>::infinity(), strongest = 0, loudest_null = 0;
  double depth_db() const { return decibels(loudest_null / weakest); }
};
Heard hear(const Layout& layout, const std::vector<Complex>& drive, const Places& places) {
  Heard heard;
  for (const SlotFocus& focus : places.foci) {
    const double loud = std::abs(sound_at(layout, drive, focus.position)) / focus.gain;
    heard.weakest = std::min(heard.weakest, loud);
    heard.strongest = std::max(heard.strongest, loud);
  }
  for (const Null& null : places.nulls)
    heard.loudest_null = std::max(heard.loudest_null, std::abs(sound_at(layout, drive, null.position)));
  return heard;
}

Heard hear_with_nulls(const Layout& layout, const Places& places, Constraint constraint) {
  return hear(layout, complex_of(drive_of(layout, places, places.nulls, constraint)), places);
}

/// How much quieter the weakest focus is than without nulls.
double loss_db(const Layout& layout, const Places& places, Constraint constraint) {
  const double without = hear(layout, complex_of(drive_of(layout, places, {}, constraint)), places).weakest;
  return decibels(without / hear_with_nulls(layout, places, constraint).weakest);
}

void expect_figures(const Layout& layout, const Places& places, Constraint constraint, const std::string& what) {
  const Drive drive = drive_of(layout, places, places.nulls, constraint);
  const Heard heard = hear(layout, complex_of(drive), places);
  EXPECT_LE(heard.depth_db(), constraint == Constraint::normalise ? -90 : -80) << what;
  EXPECT_LE(decibels(heard.strongest / heard.weakest), 0.1) << what;
  EXPECT_LE(loss_db(layout, places, constraint), 3) << what;
  for (const auto& [steps, depth_db] : {std::pair(32, -35), std::pair(128, -45), std::pair(256, -50)})
    EXPECT_LE(hear(layout, rounded(drive, steps), places).depth_db(), depth_db) << what;
  if (constraint == Constraint::normalise) return;
  for (const TransducerDrive& one : drive)
    ASSERT_EQ(one.amplitude, 1) << what;
}

TEST(Nulls, AreDeepAndCostLittle) {
  std::mt19937 random(4);
  for (const bool board : {true, false}) {
    const Layout layout = load_layout(board ? "openmpd" : "paper");
    const Vec3 centre(0, 0, board ? 0.15 : 0);
    for (const Constraint constraint : constraints) {
      for (int set = 0; set < (board ? 25 : 4); ++set)
        expect_figures(layout, random_places(random, centre, board), constraint, "set " + std::to_string(set));
      for (const double spacing_m : {10e-3, 12.5e-3, 15e-3, 20e-3}) {
        if (!board && spacing_m > 10e-3) break;
        expect_figures(layout, checkerboard(centre, {1, 0, 0}, {0, 1, 0}, spacing_m), constraint,
                       "spacing " + std::to_string(spacing_m));
      }
      if (!board) expect_figures(layout, checkerboard(centre, {1, 0, 0}, {0, 0, 1}, 10e-3), constraint, "in x and z");
    }
  }
}

/// The loudest sound in the balls of the nulls relative to the weakest focus, at random places.
double ball_depth_db(const Layout& layout, const Places& places, const DriveOptions& options, std::mt19937& random) {
  std::normal_distribution<double> any;
  const std::vector<Complex> drive = complex_of(drive_for(layout, places.foci, options));
  const double weakest = hear(layout, drive, places).weakest;
  double loudest = 0;
  for (const Null& null : places.nulls) {
    for (int i = 0; i < 100; ++i) {
      const double x = any(random), y = any(random), z = any(random);
      const Vec3 way = glm::normalize(Vec3(x, y, z)) * (i % 2 == 0 ? 1.0 : 0.6);
      loudest = std::max(loudest, std::abs(sound_at(layout, drive, null.position + null.radius_m * way)));
    }
  }
  return decibels(loudest / weakest);
}

// A ball is silent, not only its centre.
TEST(Nulls, ABallIsSilentAsAWhole) {
  const Layout layout = load_layout("paper");
  std::mt19937 random(6);
  for (const double radius_m : {0.5e-3, 1e-3}) {
    Places places = random_places(random, {0, 0, 0}, false, 2, 2);
    for (Null& null : places.nulls)
      null.radius_m = radius_m;
    for (const Constraint constraint : constraints) {
      EXPECT_LE(ball_depth_db(layout, places, options_for(layout, places.nulls, constraint), random),
                constraint == Constraint::normalise ? -75 : -45)
          << radius_m;
    }
  }
}

// More silence than the array can give between foci would silence them, too: wide balls are less silent instead.
TEST(Nulls, WideBallsBetweenFociLeaveThemLoud) {
  const Layout layout = load_layout("openmpd");
  Places places = checkerboard({0, 0, 0.15}, {0, 1, 0}, {1, 0, 0}, 10e-3);
  for (Null& null : places.nulls)
    null.radius_m = 1e-3;
  std::mt19937 random(10);
  for (const Constraint constraint : constraints) {
    const Heard heard = hear_with_nulls(layout, places, constraint);
    EXPECT_LE(decibels(heard.strongest / heard.weakest), 0.1);
    EXPECT_LE(loss_db(layout, places, constraint), 7);
    EXPECT_LE(ball_depth_db(layout, places, options_for(layout, places.nulls, constraint), random), -18);
  }
}

/// One focus and one null beside it, or two to four foci and one to four nulls, some with a radius: random places that
/// the array resolves.
Places random_case(std::mt19937& random, bool flat, bool one, double most_radius_m) {
  std::uniform_real_distribution<double> part(0, 1);
  const Vec3 centre(0, 0, flat ? 0.15 : 0);
  const auto radius = [&] { return most_radius_m * (0.12 + 0.88 * part(random)); };
  if (!one) {
    const auto foci = static_cast<std::size_t>(2 + 3 * part(random));
    Places places = random_places(random, centre, flat, foci, static_cast<std::size_t>(1 + 4 * part(random)));
    for (Null& null : places.nulls)
      null.radius_m = most_radius_m > 0 && part(random) < 0.7 ? radius() : 0;
    return places;
  }
  Places places = random_places(random, centre, flat, 1, 0);
  const double turned = turn * part(random), rise = flat ? 0.4 * (2 * part(random) - 1) : 2 * part(random) - 1;
  const double across = std::sqrt(1 - rise * rise),
               apart_m = (most_radius_m > 0 ? 12e-3 : 10e-3) + 28e-3 * part(random);
  const Vec3 way(across * std::cos(turned), across * std::sin(turned), rise);
  places.nulls.push_back({places.foci[0].position + apart_m * way, most_radius_m > 0 ? radius() : 0});
  return places;
}

struct Array {
  const char* name;
  bool flat;
  std::uint32_t draws;
};
constexpr Array arrays[] = {{"openmpd", true, 40}, {"autd3", true, 40}, {"paper", false, 10}};

TEST(Nulls, ClampIsNeverQuieterThanUniform) {
  for (const Array& array : arrays) {
    const Layout layout = load_layout(array.name);
    std::mt19937 random(21);
    for (std::uint32_t draw = 0; draw < test::fewer(array.draws); ++draw) {
      for (const double most_radius_m : {0.0, 1e-3}) {
        Places places = random_case(random, array.flat, draw % 4 == 0, most_radius_m);
        if (draw % 3 == 0) places.foci.back().gain = 0.4F;
        const Heard uniform = hear_with_nulls(layout, places, Constraint::uniform);
        const Heard clamp = hear_with_nulls(layout, places, Constraint::clamp);
        EXPECT_GE(clamp.weakest, 0.9999 * uniform.weakest) << array.name << ' ' << draw;
        EXPECT_LE(clamp.depth_db(), -80);
      }
    }
  }
}

TEST(Nulls, ClampIsAsLoudBesideFociThatAreNearEachOther) {
  const Layout layout = load_layout("autd3");
  const Places places{{{{0.026405, -0.027947, 0.15}}, {{-0.011717, 0.006416, 0.15}}, {{0.026792, -0.024733, 0.15}}},
                      {{{-0.012394, 0.020994, 0.15}, 1e-3}, {{0.002836, 0.002191, 0.15}}}};
  const Heard clamp = hear_with_nulls(layout, places, Constraint::clamp);
  EXPECT_GE(clamp.weakest, 0.9999 * hear_with_nulls(layout, places, Constraint::uniform).weakest);
  EXPECT_LE(clamp.depth_db(), -80);
}

// Sound from all around has more details in a ball than that of a board: these two have 168 rows.
TEST(Nulls, ABallMayBeAsWideAsAWavelength) {
  const Layout layout = load_layout("paper");
  const double radius_m = 0.5 / Medium{}.turns_per_metre();
  const Places places{{{{0.025, 0, 0.005}}, {{-0.02, 0.004, -0.015}}},
                      {{{0, 0.025, 0}, radius_m}, {{0.004, -0.022, 0.01}, radius_m}}};
  std::mt19937 random(9);
  for (const Constraint constraint : test::the_first<Constraint>(1, {Constraint::normalise, Constraint::uniform})) {
    const double depth_db = ball_depth_db(layout, places, options_for(layout, places.nulls, constraint), random);
    EXPECT_LE(depth_db, constraint == Constraint::uniform ? -45 : -80);
  }
}

// More rows make a ball more silent; the first rows are those that matter most.
TEST(Nulls, RowsAreOrthonormalAndInTheOrderOfTheirRests) {
  const Layout layout = load_layout("openmpd");
  const std::vector<Null> places{{{0, 0, 0.15}, 1e-3}, {{0.02, 0, 0.15}}, {{0.02, 0, 0.15}}};
  const Nulls nulls(layout, {}, Directivity::t4010a1, places);
  const SplitRows& rows = nulls.rows();
  for (std::size_t i = 0; i < rows.rows; ++i) {
    for (std::size_t k = 0; k <= i; ++k) {
      const Complex product = inner_product(rows, i, rows, k);
      EXPECT_NEAR(std::abs(product - (i == k ? 1.0 : 0.0)), 0, 1e-9) << i << " " << k;
    }
  }
  EXPECT_EQ(nulls.rows_to(1), 2u) << "the centre of the ball and one of the two equal places";
  std::size_t before = 0;
  for (const double rest : {1.0, 0.1, 1e-2, 1e-3, null_deepest_rest}) {
    EXPECT_GE(nulls.rows_to(rest), before);
    before = nulls.rows_to(rest);
  }
  EXPECT_EQ(before, rows.rows);
  EXPECT_EQ(nulls.loudness().size(), rows.rows);
}

// Two nulls nearly at one place are one: the second would cost pressure and silence nothing more.
TEST(Nulls, NearlyTheSamePlaceCostsNothing) {
  const Layout layout = load_layout("openmpd");
  const Places one{{{{0, 0, 0.15}}}, {{{0.01, 0, 0.15}}}};
  const auto loud = [&](const std::vector<Null>& nulls) {
    return hear(layout, complex_of(drive_of(layout, one, nulls, Constraint::normalise)), one).weakest;
  };
  EXPECT_NEAR(loud({one.nulls[0], {{0.0100001, 0, 0.15}}}) / loud(one.nulls), 1, 1e-5);
}

TEST(Nulls, GainsStayAsAsked) {
  const Layout layout = load_layout("openmpd");
  std::mt19937 random(7);
  Places places = random_places(random, {0, 0, 0.15}, true);
  places.foci[0].gain = 0.3F;
  places.foci[2].gain = 0.7F;
  for (const Constraint constraint : constraints) {
    const Heard heard = hear_with_nulls(layout, places, constraint);
    EXPECT_LE(decibels(heard.strongest / heard.weakest), 0.1);
    EXPECT_LE(heard.depth_db(), -60);
  }
  for (SlotFocus& focus : places.foci)
    focus.gain = 0;
  for (const TransducerDrive& one : drive_of(layout, places, places.nulls, Constraint::normalise))
    ASSERT_EQ(one.amplitude, 0);
}

// A null where a focus is heard little anyway changes its drive little.
TEST(Nulls, OneFocusIsNearlyThePapersDrive) {
  const Layout layout = load_layout("paper");
  const std::vector<SlotFocus> focus{{{0, 0, 0}}};
  const std::vector<Null> ear{{{0.05, 0.02, 0.3}}};
  const Drive with = drive_for(layout, focus, options_for(layout, ear, Constraint::normalise));
  const Drive without = drive_for(layout, focus, options_for(layout, {}, Constraint::normalise));
  double apart = 0;
  for (std::size_t n = 0; n < with.size(); ++n) {
    apart = std::max(apart, std::abs(std::polar(double{with[n].amplitude}, double{with[n].phase}) -
                                     std::polar(double{without[n].amplitude}, double{without[n].phase})));
  }
  EXPECT_LT(apart, 0.1);
  EXPECT_LT(std::abs(sound_at(layout, complex_of(with), ear[0].position)),
            1e-4 * std::abs(sound_at(layout, complex_of(with), focus[0].position)));
}

TEST(Nulls, OddPlacesGiveValidDrives) {
  const Layout layout = load_layout("openmpd");
  const Vec3 place(0.01, 0, 0.12);
  const std::vector<std::vector<Null>> odd{
      {{place}},        {{place, most_null_radius_m}},      {{{0, 0, -0.2}}},
      {{{50, 0, 0.1}}}, {{layout.transducers[3].position}}, std::vector<Null>(most_nulls, Null{{0, 0.02, 0.12}, 1e-3})};
  std::vector<SlotFocus> foci{{place}, {{-0.01, 0, 0.12}, 0.5F}, {{0, 0, 500}}};
  for (const std::vector<Null>& nulls : odd) {
    for (const Constraint constraint : constraints) {
      EXPECT_EQ(faults(drive_for(layout, foci, options_for(layout, nulls, constraint))), 0u);
      for (const SlotFocus& focus : foci)
        EXPECT_EQ(faults(drive_for(layout, {{focus}}, options_for(layout, nulls, constraint))), 0u);
    }
  }
  foci.clear();
  for (int i = 0; i < 70; ++i)  // more than any solver takes
    foci.push_back({{-0.05 + 1.5e-3 * i, 0.01, 0.14}});
  const Drive many = drive_for(layout, foci, options_for(layout, {{{0, 0.03, 0.14}}}, Constraint::uniform));
  EXPECT_EQ(faults(many), 0u);
}

/// The sound of each transducer at a place, at full amplitude. Independent of the solvers.
std::vector<Complex> sounds_at(const Layout& layout, const Vec3& place, Directivity kind) {
  std::vector<Complex> sounds;
  const double k = turn * Medium{}.turns_per_metre();
  for (const Transducer& one : layout.transducers) {
    const Vec3 way = place - one.position;
    const double distance = glm::length(way);
    const double loud = directivity(kind, glm::dot(way, one.axis) / distance, k * layout.transducer_radius_m);
    sounds.push_back(std::polar(loud / distance, k * distance));
  }
  return sounds;
}

/// No drive with amplitudes up to 1 that is silent at h is louder at g: the smallest sum of |g + c h| over all c, by
/// weighted least squares.
double loudest_beside(const std::vector<Complex>& g, const std::vector<Complex>& h) {
  double sum = 0;
  Complex c = 0;
  for (int step = 0; step < 100; ++step) {
    Complex across = 0;
    double own = 0;
    sum = 0;
    for (std::size_t n = 0; n < g.size(); ++n) {
      const double size = std::max(std::abs(g[n] + c * h[n]), 1e-9 * std::abs(g[n]));
      sum += size;
      across += std::conj(h[n]) * g[n] / size;
      own += std::norm(h[n]) / size;
    }
    c = -across / own;
  }
  return sum;
}

// Beside a null, one focus is nearly as loud as physics allows. Along the axis of a board, that is much quieter.
TEST(Nulls, OneFocusBesideANullIsLoud) {
  const double r = std::sqrt(0.5);
  const std::vector<Vec3> ways{{1, 0, 0}, {0, -1, 0}, {r, r, 0}, {r, 0, r}, {0, r, -r}, {0.38, 0.92, 0}, {0, 0, 1}};
  for (const char* name : {"openmpd", "autd3", "paper"}) {
    const Layout layout = load_layout(name);
    const bool board = std::string(name) != "paper";
    for (const Vec3& focus : {Vec3(0, 0, board ? 0.15 : 0), Vec3(0.02, 0.01, board ? 0.16 : 0.01)}) {
      for (const Directivity kind : {Directivity::t4010a1, Directivity::omni, Directivity::piston}) {
        const std::vector<Complex> g = sounds_at(layout, focus, kind);
        double full = 0;
        for (const Complex& one : g)
          full += std::abs(one);
        for (const double apart_m : {10e-3, 11.5e-3, 13e-3, 15e-3, 40e-3}) {
          for (const Vec3& way : ways) {
            const Vec3 null = focus + apart_m * way;
            if (board && way.z == 1 && apart_m < 13e-3) continue;  // refused: one place for such an array
            const std::vector<Complex> h = sounds_at(layout, null, kind);
            const double allowed_db = decibels(full / loudest_beside(g, h));
            for (const Constraint constraint : {Constraint::uniform, Constraint::clamp}) {
              DriveOptions options;
              options.solver = Solver::gs_pat;
              options.constraint = constraint;
              options.directivity = kind;
              const std::vector<Null> nulls{{null}};
              options.nulls = std::make_shared<const Nulls>(layout, options.medium, kind, nulls);
              const std::vector<SlotFocus> foci{{focus}};
              const std::vector<Complex> drive = complex_of(drive_for(layout, foci, options));
              Complex loud = 0, rest = 0;
              for (std::size_t n = 0; n < g.size(); ++n) {
                loud += g[n] * drive[n];
                rest += h[n] * drive[n];
              }
              const double loss_db = decibels(full / std::abs(loud));
              EXPECT_LE(loss_db, allowed_db + 0.12) << name << ' ' << apart_m << ' ' << way.x << ' ' << way.y;
              if (!board || std::hypot(way.x, way.y) > 0.9) {
                EXPECT_LE(loss_db, 1) << name << ' ' << apart_m;
              }
              EXPECT_LE(decibels(std::abs(rest) / std::abs(loud)), kind == Directivity::omni ? -100 : -80);
            }
          }
        }
      }
    }
  }
}

// The ball becomes less silent before the focus loses a quarter of its pressure, and only as far as it must.
TEST(Nulls, ABallGivesWayToOneFocus) {
  for (const Array& array : arrays) {
    const Layout layout = load_layout(array.name);
    for (const Constraint constraint : {Constraint::normalise, Constraint::uniform}) {
      std::mt19937 random(22);
      std::vector<double> losses_db, depths_db;
      for (std::uint32_t draw = 0; draw < test::fewer(2 * array.draws); ++draw) {
        Places places = random_case(random, array.flat, true, 2e-3);
        if (draw == 0) places.nulls = {{places.foci[0].position + Vec3(15e-3, 0, 0), 1e-3}};
        losses_db.push_back(loss_db(layout, places, constraint));
        depths_db.push_back(ball_depth_db(layout, places, options_for(layout, places.nulls, constraint), random));
        EXPECT_LE(losses_db.back(), 2.55) << array.name << ' ' << draw;
      }
      if (test::instrumented()) continue;  // too few for statistics
      std::ranges::sort(losses_db);
      std::ranges::sort(depths_db);
      EXPECT_LE(losses_db[losses_db.size() / 2], 1) << array.name;
      EXPECT_LE(depths_db[depths_db.size() / 2], constraint == Constraint::normalise ? -85 : -60) << array.name;
      EXPECT_LE(depths_db[depths_db.size() * 9 / 10], -45) << array.name;
    }
  }
}

class NullsOn : public testing::TestWithParam<Backend> {};
INSTANTIATE_TEST_SUITE_P(Both, NullsOn, testing::ValuesIn(backends), backend_name);

// Slots with nulls are the host's on every device: the same bytes, beside slots without foci.
TEST_P(NullsOn, BatchesAreTheHosts) {
  const Layout layout = load_layout("openmpd");
  std::mt19937 random(8);
  const Places one = random_places(random, {0, 0, 0.15}, true), other = random_places(random, {0, 0, 0.15}, true);
  for (const Constraint constraint : {Constraint::normalise, Constraint::uniform}) {
    const DriveOptions options = options_for(layout, one.nulls, constraint);
    const std::vector<std::vector<SlotFocus>> slots{one.foci, {}, {other.foci[0]}, other.foci};
    const std::vector<Drive> drives = GetParam().drives(layout, slots, options);
    ASSERT_EQ(drives.size(), slots.size());
    for (std::size_t s = 0; s < slots.size(); ++s)
      EXPECT_TRUE(same(drives[s], drive_for(layout, slots[s], options))) << s;
  }
}

}  // namespace
}  // namespace palpa::array
