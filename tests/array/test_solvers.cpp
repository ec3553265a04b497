// How well the solvers serve several foci, and what must never happen. Each test runs on both backends.
#include <algorithm>
#include <cmath>
#include <complex>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numbers>
#include <numeric>

#include "acoustics/field/pressure.hpp"
#include "array/solvers/greedy.hpp"
#include "backends.hpp"
#include "focus_sets.hpp"
#include "support/instrumented.hpp"

namespace palpa::array {
namespace {

using acoustics::FociPressure;
using acoustics::pressure_at_foci;
using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

class SolverOn : public testing::TestWithParam<Backend> {};
INSTANTIATE_TEST_SUITE_P(Backends, SolverOn, testing::ValuesIn(backends), backend_name);

Complex value(const TransducerDrive& drive) {
  return std::polar<double>(drive.amplitude, drive.phase);
}
double farthest(const Drive& a, const Drive& b) {
  double most = 0;
  for (std::size_t t = 0; t < a.size(); ++t)
    most = std::max(most, std::abs(value(a[t]) - value(b[t])));
  return most;
}

/// What a solver makes of sets of foci: how even each is, its weakest and its mean pressure.
struct Served {
  std::vector<double> evenness, weakest, means;
  double least_even() const { return *std::ranges::min_element(evenness); }
  double mean() const { return std::accumulate(means.begin(), means.end(), 0.0) / static_cast<double>(means.size()); }
};
Served serve(const Backend& backend, const Layout& layout, const std::vector<std::vector<SlotFocus>>& sets,
             const DriveOptions& options) {
  const auto drives = backend.drives(layout, sets, options);
  Served served;
  for (std::size_t s = 0; s < sets.size(); ++s) {
    EXPECT_EQ(faults(drives[s]), 0u);
    const FociPressure heard = pressure_at_foci(layout, drives[s], sets[s], options.medium, options.directivity);
    served.evenness.push_back(heard.evenness);
    served.weakest.push_back(*std::ranges::min_element(heard.pascals));
    served.means.push_back(heard.mean);
  }
  return served;
}

TEST_P(SolverOn, TenFociAreEvenAndLoud) {
  for (const char* name : {"paper", "openmpd"}) {
    const Layout layout = load_layout(name);
    const bool tunnel = layout.name == "paper";
    std::vector<std::vector<SlotFocus>> sets;
    for (unsigned seed = 0; seed < 8; ++seed)
      sets.push_back(focus_set(seed, 10, tunnel ? Vec3(0) : Vec3(0, 0, 0.15)));
    const auto with_all = [&](const DriveOptions& options) { return serve(GetParam(), layout, sets, options); };
    const Served naive = with_all(with(Solver::naive)), normalised = with_all(with(Solver::gs_pat)),
                 uniform = with_all(with(Solver::gs_pat, Constraint::uniform));
    // 256 transducers of a flat board cannot distinguish foci that are behind each other.
    EXPECT_GE(normalised.least_even(), tunnel ? 0.97 : 0.93);
    EXPECT_GE(normalised.mean(), (tunnel ? 0.95 : 0.9) * naive.mean());
    EXPECT_GE(uniform.least_even(), tunnel ? 0.95 : 0.8);
    if (!tunnel) continue;
    const Served greedy = with_all(with(Solver::greedy));
    EXPECT_LT(naive.least_even(), 0.8) << "there is nothing to improve";
    EXPECT_GE(uniform.mean(), 0.98 * greedy.mean());
    EXPECT_GE(with_all(with(Solver::gs_pat, Constraint::clamp)).least_even(), 0.95);
    EXPECT_GE(greedy.least_even(), 0.9);
  }
}

// Foci as close together as those around a fingertip, against greedy's with all amplitudes at 1.
TEST_P(SolverOn, FociOfAnyDistanceAreEvenAndLoudInTheTunnel) {
  const Layout layout = load_layout("paper");
  std::vector<std::vector<SlotFocus>> flat;
  for (const double radius : {2.5e-3, 4e-3, 5e-3})
    flat.push_back(ring(10, radius, {}, {1, 0, 0}, {0, 0, 1}));
  // Their best phases run once around the ring or change sides. No ascent reaches them from the phases of a single path
  // to the foci.
  const std::vector<std::vector<SlotFocus>> tilted{
      ring(10, 2e-3, {}, {-0.8267, 0, -0.5626}, {-0.2759, -0.8715, 0.4054}),
      ring(10, 3.4e-3, {}, {-0.9062, 0, -0.4229}, {-0.06726, -0.9873, 0.1441}),
      ring(10, 6.6e-3, {}, {0.6112, 0, 0.7915}, {0.02378, -0.9995, -0.01836})};
  struct Sets {
    std::vector<std::vector<SlotFocus>> sets;
    Directivity directivity;
    // Where amplitudes are bounded, loudness comes before the evenness of foci that the array does not resolve.
    double even, even_if_bounded, of_greedys;
  };
  for (const auto& [sets, directivity, even, even_if_bounded, of_greedys] :
       {Sets{test::the_first(8, crowds({})), Directivity::t4010a1, 0.95, 0.6, 0.99},
        Sets{flat, Directivity::omni, 0.95, 0.93, 0.95}, Sets{tilted, Directivity::t4010a1, 0, 0, 0.95}}) {
    const auto served_by = [&, kind = directivity, &all = sets](Solver solver, Constraint constraint) {
      DriveOptions options = with(solver, constraint);
      options.directivity = kind;
      return serve(GetParam(), layout, all, options);
    };
    const Served greedy = served_by(Solver::greedy, Constraint::uniform);
    for (const Constraint constraint : constraints) {
      const Served served = served_by(Solver::gs_pat, constraint), plain = served_by(Solver::naive, constraint);
      for (std::size_t s = 0; s < sets.size(); ++s) {
        const double of_plain = constraint == Constraint::normalise ? 1 - 1e-5 : 0.98;
        EXPECT_GE(served.weakest[s], of_plain * plain.weakest[s]) << s << " " << static_cast<int>(constraint);
        // The plain sums take the place of the even ones only where they are louder.
        if (constraint == Constraint::normalise && served.weakest[s] <= (1 + 1e-5) * plain.weakest[s]) continue;
        EXPECT_GE(served.evenness[s], constraint == Constraint::normalise ? even : even_if_bounded)
            << s << " " << static_cast<int>(constraint);
        if (constraint == Constraint::uniform) {
          EXPECT_GE(served.weakest[s], of_greedys * greedy.weakest[s]) << s;
        }
      }
    }
  }
}

TEST_P(SolverOn, FociOfAnyDistanceAreAsEvenAsGreedysOrLouderAboveABoard) {
  for (const char* name : {"openmpd", "autd3"}) {
    const Layout layout = load_layout(name);
    const auto sets = crowds({0, 0, 0.15});
    const Served greedy = serve(GetParam(), layout, sets, with(Solver::greedy));
    for (const Constraint constraint : constraints) {
      const Served served = serve(GetParam(), layout, sets, with(Solver::gs_pat, constraint));
      const Served plain = serve(GetParam(), layout, sets, with(Solver::naive, constraint));
      for (std::size_t s = 0; s < sets.size(); ++s) {
        const double of_plain = constraint == Constraint::normalise ? 1 - 1e-5 : 0.98;
        EXPECT_GE(served.weakest[s], of_plain * plain.weakest[s]) << name << " " << s;
        // Where amplitudes are bounded, loudness comes first; so it does where the plain sums are louder.
        if (constraint == Constraint::normalise) {
          if (served.weakest[s] <= (1 + 1e-5) * plain.weakest[s]) continue;
          EXPECT_GE(served.evenness[s], greedy.evenness[s]) << name << " " << s;
        } else {
          EXPECT_GE(served.weakest[s], 1.05 * greedy.weakest[s])
              << name << " " << s << " " << static_cast<int>(constraint);
        }
      }
    }
  }
}

TEST_P(SolverOn, TwoFociHelpEachOtherAsMuchAsTheyCan) {
  // By symmetry, it is q_1 + q_2 or q_1 - q_2, whichever is louder: the one in which the cross term has the same sign.
  const Layout layout = load_layout("openmpd");
  const std::vector<SlotFocus> foci{{{-0.0035, 0, 0.1}}, {{0.0035, 0, 0.1}}};
  DriveOptions options = with(Solver::gs_pat);
  options.weighting = Weighting::uniform;
  options.directivity = Directivity::omni;
  const double k = 2 * pi * options.medium.turns_per_metre();
  Complex cross = 0;
  std::vector<Complex> sum;
  double largest = 0;
  for (const Transducer& t : layout.transducers) {
    const double a = glm::distance(t.position, foci[0].position), b = glm::distance(t.position, foci[1].position);
    cross += std::exp(Complex(0, k * (a - b))) / a;
    sum.push_back(std::exp(Complex(0, -k * a)) - std::exp(Complex(0, -k * b)));
    largest = std::max(largest, std::abs(sum.back()));
  }
  ASSERT_LT(cross.real(), 0) << "these foci have opposite phases";
  const Drive drive = GetParam().drive(layout, foci, options);
  const Complex turn = std::polar(1.0, std::arg(value(drive[0]) / sum[0]));
  for (std::size_t t = 0; t < drive.size(); ++t)
    EXPECT_LE(std::abs(value(drive[t]) - turn * sum[t] / largest), 5e-3) << t;
}

TEST_P(SolverOn, GainsAreRelativeAmplitudes) {
  const Layout layout = load_layout("paper");
  auto foci = focus_set(3, 5);
  const auto equal = foci;
  const float gains[]{1, 0.5F, 0.25F, 0.8F, 0.6F};
  for (std::size_t j = 0; j < foci.size(); ++j)
    foci[j].gain = gains[j];
  auto mute = equal;
  mute[2].gain = 0;
  for (const Constraint constraint : constraints) {
    const auto drives = GetParam().drives(layout, {equal, foci, mute}, with(Solver::gs_pat, constraint));
    const FociPressure full = pressure_at_foci(layout, drives[0], equal);
    const FociPressure soft = pressure_at_foci(layout, drives[1], foci);
    EXPECT_GE(soft.evenness, 0.95) << static_cast<int>(constraint);
    const FociPressure without = pressure_at_foci(layout, drives[2], equal);
    EXPECT_LT(without.pascals[2], 0.3 * without.pascals[0]);
    if (constraint != Constraint::normalise) continue;
    // Turning down the others leaves the loud one as it was.
    EXPECT_NEAR(soft.pascals[0], full.pascals[0], 0.02 * full.pascals[0]);
    EXPECT_NEAR(without.pascals[0], full.pascals[0], 0.02 * full.pascals[0]);
  }
  for (const Constraint constraint : {Constraint::uniform, Constraint::clamp}) {
    const Drive drive = GetParam().drive(layout, foci, with(Solver::loudest, constraint));
    EXPECT_GE(pressure_at_foci(layout, drive, foci).evenness, 0.97) << static_cast<int>(constraint);
  }
}

TEST_P(SolverOn, GainsOfManyFociAreRelativeToo) {
  const Layout layout = load_layout("paper");
  auto foci = focus_set(5, 14);
  for (std::size_t j = 0; j < foci.size(); j += 2)
    foci[j].gain = 0.5F;
  for (const Constraint constraint : constraints) {
    const Drive drive = GetParam().drive(layout, foci, with(Solver::gs_pat, constraint));
    EXPECT_GE(pressure_at_foci(layout, drive, foci).evenness, constraint == Constraint::uniform ? 0.8 : 0.95)
        << static_cast<int>(constraint);
  }
}

TEST_P(SolverOn, VeryUnequalGainsAreNotClipped) {
  // Foci that sound nearly alone need more of some transducers than all of them together at full gain.
  const Layout layout = load_layout("openmpd");
  struct Ring {
    std::size_t foci;
    double radius;
    float low;
  };
  for (const auto& [count, radius, low] : {Ring{3, 4e-3, 0.03F}, Ring{3, 2e-3, 0.3F}, Ring{6, 4e-3, 0.3F}}) {
    std::vector<SlotFocus> foci = ring(count, radius, {0, 0, 0.15}, {1, 0, 0}, {0, 1, 0});
    for (std::size_t j = 1; j < count; j += 2)
      foci[j].gain = low;
    const Drive drive = GetParam().drive(layout, foci, with(Solver::gs_pat));
    EXPECT_GE(pressure_at_foci(layout, drive, foci).evenness, 0.98) << count << " foci, " << radius;
    EXPECT_LE(std::ranges::count_if(drive, [](const TransducerDrive& t) { return t.amplitude == 1; }), 4);
  }
}

TEST_P(SolverOn, AGainThatAllShareIsOneScalar) {
  const Layout layout = load_layout("autd3");
  const auto foci = focus_set(4, 3, {0, 0, 0.15});
  auto soft = foci, none = foci;
  for (std::size_t j = 0; j < foci.size(); ++j) {
    soft[j].gain = 0.25F;
    none[j].gain = 0;
  }
  for (const Solver solver : {Solver::naive, Solver::gs_pat, Solver::greedy}) {
    for (const Constraint constraint : constraints) {
      const auto drives = GetParam().drives(layout, {foci, soft, none}, with(solver, constraint));
      for (std::size_t t = 0; t < drives[0].size(); ++t) {
        ASSERT_EQ(drives[1][t].amplitude, 0.25F * drives[0][t].amplitude);
        ASSERT_EQ(drives[1][t].phase, drives[0][t].phase);
        ASSERT_EQ(drives[2][t].amplitude, 0);
        if (solver == Solver::naive) {
          ASSERT_EQ(drives[2][t].phase, drives[0][t].phase);
        }
      }
    }
  }
}

TEST_P(SolverOn, ConstraintsHold) {
  const Layout layout = load_layout("autd3");
  const auto foci = focus_set(5, 6, {0, 0, 0.15});
  const auto loudest = [](const Drive& drive) {
    return std::ranges::max_element(drive, {}, &TransducerDrive::amplitude)->amplitude;
  };
  EXPECT_NEAR(loudest(GetParam().drive(layout, foci, with(Solver::gs_pat))), 1, 2e-7);
  for (const TransducerDrive& t : GetParam().drive(layout, foci, with(Solver::gs_pat, Constraint::uniform)))
    ASSERT_EQ(t.amplitude, 1);
  const Drive clamped = GetParam().drive(layout, foci, with(Solver::gs_pat, Constraint::clamp));
  EXPECT_EQ(faults(clamped), 0u);
  EXPECT_GT(std::ranges::count(clamped, 1.0F, &TransducerDrive::amplitude), 100);
  EXPECT_LT(std::ranges::count(clamped, 1.0F, &TransducerDrive::amplitude), 249);
  for (const TransducerDrive& t : GetParam().drive(layout, foci, with(Solver::greedy))) {
    ASSERT_EQ(t.amplitude, 1);
    const double steps = t.phase / (2 * pi / greedy_phases);
    ASSERT_NEAR(steps, std::round(steps), 1e-5);
  }
}

TEST_P(SolverOn, OneFocusAndMoreThanItTakesAreNaiveWhateverTheSolver) {
  const Layout layout = load_layout("openmpd");
  std::vector<SlotFocus> one{{{0.01, 0.02, 0.11}, 0.7F}}, many = random_slots(1, 1000, 2)[0];
  ASSERT_GT(many.size(), 66u);
  many.resize(65);
  for (const std::vector<SlotFocus>& foci : {one, many}) {
    const Drive naive = GetParam().drive(layout, foci);
    for (const Solver solver : {Solver::gs_pat, Solver::greedy}) {
      for (const Directivity kind : {Directivity::omni, Directivity::t4010a1}) {
        DriveOptions options = with(solver);
        options.directivity = kind;
        EXPECT_TRUE(same(GetParam().drive(layout, foci, options), naive)) << foci.size();
      }
    }
  }
}

TEST_P(SolverOn, SixtyFourFociAtOnce) {
  // One focus for each of many fingers, wherever they are: nothing breaks, and the foci are heard.
  Layout layout = load_layout("paper");
  std::vector<SlotFocus> foci;
  for (int j = 0; j < 64; ++j)
    foci.push_back({{0.02 * (j % 4 - 1.5), 0.02 * (j / 4 % 4 - 1.5), 0.02 * (j / 16 - 1.5)}});
  for (const Solver solver : {Solver::gs_pat, Solver::greedy}) {
    const Drive drive = GetParam().drive(layout, foci, with(solver, Constraint::uniform));
    EXPECT_EQ(faults(drive), 0u);
    EXPECT_GT(pressure_at_foci(layout, drive, foci).evenness, 0.6) << static_cast<int>(solver);
  }
}

TEST_P(SolverOn, DegenerateSlotsAndLayouts) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const Layout board = load_layout("openmpd");
  const SlotFocus a{{0, 0, 0.1}}, b{{0.02, 0, 0.12}};
  const Vec3 place = board.transducers[17].position;
  const std::vector<std::vector<SlotFocus>> slots{{a, a},                                   // 0: one place
                                                  {a, {a.position + Vec3(1e-9, 0, 0)}, b},  // 1: nearly
                                                  {a, {a.position, 0.5F}, b},  // 2: different gains at one place
                                                  {{place}, a},                // 3: a transducer
                                                  {{{0, 0, -0.1}}, a},         // 4: behind the board
                                                  {{{0, 0, 99}}, a, b},        // 5: out of reach
                                                  {{{nan, 0, 0}}, a, b},       // 6: invalid
                                                  {{{0, 0, 0.1}, 0}, {{0.02, 0, 0.1}, 0}},  // 7: silent
                                                  {{{nan, 0, 0}}, a},                       // 8: only one valid focus
                                                  {{b.position, 0}, a},                     // 9: only one that sounds
                                                  std::vector<SlotFocus>(64, a)};
  for (const Solver solver :
       {Solver::gs_pat, Solver::greedy, Solver::loudest, Solver::eigenvalue, Solver::back_propagation}) {
    const bool usual = solver == Solver::gs_pat || solver == Solver::greedy;
    for (const Constraint constraint : constraints) {
      const auto drives = GetParam().drives(board, slots, with(solver, constraint));
      for (std::size_t s = 0; s < slots.size(); ++s)
        EXPECT_EQ(faults(drives[s]), 0u) << s;
      const auto heard = [&](std::size_t slot) { return pressure_at_foci(board, drives[slot], slots[slot]); };
      for (const TransducerDrive& t : drives[7])
        ASSERT_EQ(t.amplitude, 0);
      if (usual || solver == Solver::loudest) {
        EXPECT_GT(heard(0).mean, 1000);
      }
      if (solver == Solver::loudest) {
        for (const std::size_t slot : {4u, 5u, 9u})
          EXPECT_GT(heard(slot).pascals[1], 1000) << slot;
      }
      if (!usual) continue;
      const double even = solver == Solver::gs_pat ? 0.9 : 0.6;
      EXPECT_GT(heard(1).evenness, even);
      // If foci at one place have several gains, the largest counts.
      EXPECT_NEAR(heard(2).pascals[0] / heard(2).pascals[2], 1, 1.05 - even);
      EXPECT_GT(heard(6).evenness, even);
      // Unreachable foci do not take sound away from the others.
      EXPECT_GT(heard(5).pascals[1], 0.2 * heard(6).pascals[1]) << static_cast<int>(solver);
    }
    if (!usual) continue;
    Layout layout;
    EXPECT_TRUE(GetParam().drive(layout, {a, b}, with(solver)).empty());
    layout.transducers.push_back({{0, 0, 0}, {0, 0, 1}});
    for (const Constraint constraint : constraints)
      EXPECT_EQ(faults(GetParam().drive(layout, {a, b, {{0, 0, 0}}}, with(solver, constraint))), 0u);
  }
}

TEST_P(SolverOn, AMotionOfEverythingChangesNothing) {
  const Layout layout = load_layout("openmpd");
  const auto foci = focus_set(7, 6, {0, 0, 0.15});
  Transform motion = glm::rotate(glm::translate(Transform(1.0), Vec3(0.2, -0.1, 0.05)), 0.8, Vec3(1, 2, -0.5));
  auto moved = foci;
  for (SlotFocus& focus : moved)
    focus.position = transform_point(motion, focus.position);
  const double tolerance = std::string(GetParam().name) == "twin" ? 1e-5 : 5e-3;
  const Drive here = GetParam().drive(layout, foci, with(Solver::gs_pat));
  const Drive there = GetParam().drive(transformed(layout, motion), moved, with(Solver::gs_pat));
  EXPECT_LE(farthest(here, there), tolerance);
}

TEST_P(SolverOn, TheOrderOfTheFociDoesNotMatter) {
  const Layout layout = load_layout("openmpd");
  auto foci = focus_set(8, 9, {0, 0, 0.15});
  foci[2].gain = 0.5F;
  const double tolerance = std::string(GetParam().name) == "twin" ? 1e-5 : 5e-3;
  const Drive forward = GetParam().drive(layout, foci, with(Solver::gs_pat));
  std::ranges::reverse(foci);
  EXPECT_LE(farthest(forward, GetParam().drive(layout, foci, with(Solver::gs_pat))), tolerance);
}

TEST(Solvers, DeviceAndTwinAgree) {
  for (const char* name : {"paper", "openmpd"}) {
    const Layout layout = load_layout(name);
    std::vector<std::vector<SlotFocus>> slots;
    for (const std::size_t count : {2u, 5u, 6u, 10u, 10u, 17u})
      slots.push_back(
          focus_set(static_cast<unsigned>(slots.size()), count, {0, 0, layout.boards.size() > 1 ? 0 : 0.15}));
    slots[4][3].gain = 0.3F;
    // Under `uniform`, a transducer whose sum is almost 0 hardly has a phase: rounding decides the phase with which it
    // is bounded.
    for (const Constraint constraint : {Constraint::normalise, Constraint::clamp}) {
      const auto expected = backends[0].drives(layout, slots, with(Solver::gs_pat, constraint));
      const auto found = backends[1].drives(layout, slots, with(Solver::gs_pat, constraint));
      for (std::size_t s = 0; s < slots.size(); ++s)
        EXPECT_LE(farthest(expected[s], found[s]), 3e-3) << name << " " << s << " " << static_cast<int>(constraint);
    }
    const auto twin = backends[0].drives(layout, slots, with(Solver::greedy));
    const auto device = backends[1].drives(layout, slots, with(Solver::greedy));
    for (std::size_t s = 0; s < slots.size(); ++s) {
      std::size_t others = 0;
      for (std::size_t t = 0; t < twin[s].size(); ++t)
        others += angle_between(twin[s][t].phase, device[s][t].phase) > 1e-4;
      EXPECT_LE(others, twin[s].size() / 10) << name << " " << s;
    }
  }
}

}  // namespace
}  // namespace palpa::array
