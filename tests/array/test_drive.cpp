// Drives: formulas in double precision, properties, degenerate input. Each test runs on both backends.
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <numbers>
#include <random>

#include "array/drive.hpp"
#include "array/free_drives.hpp"
#include "array/nulls/nulls.hpp"
#include "array/slot_drives.hpp"
#include "backends.hpp"
#include "base/error.hpp"
#include "focus_sets.hpp"
#include "levitate.hpp"
#include "support/thrown.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

class DriveOn : public testing::TestWithParam<Backend> {};
INSTANTIATE_TEST_SUITE_P(Backends, DriveOn, testing::ValuesIn(backends), backend_name);

/// Places in a cube up to a metre from its middle, without any regularity.
Layout scattered(std::size_t count, unsigned seed, double half = 0.5) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-half, half);
  Layout layout;
  for (std::size_t i = 0; i < count; ++i) {
    layout.transducers.push_back({{place(random), place(random), place(random)}, {0, 0, 1}});
  }
  return layout;
}

/// The paper's q_k under e^{-iwt}, implemented independently: for every transducer, for one focus.
std::vector<Complex> asked(const Layout& layout, const Vec3& focus, const DriveOptions& options = {}) {
  const double farthest = farthest_of(layout, focus);
  const double k = 2 * pi * options.medium.frequency / options.medium.sound_speed;
  std::vector<Complex> q;
  for (const Transducer& t : layout.transducers) {
    const double d = glm::distance(t.position, focus);
    q.push_back((options.weighting == Weighting::uniform ? 1 : d / farthest) * std::exp(Complex(0, -k * d)));
  }
  return q;
}

TEST_P(DriveOn, OneFocusIsThePapersFormula) {
  const Layout layout = load_layout("paper");
  const auto slots = random_slots(20, 1, 3);
  const auto drives = GetParam().drives(layout, slots, {});
  for (std::size_t s = 0; s < slots.size(); ++s) {
    EXPECT_EQ(faults(drives[s]), 0u);
    const auto expected = asked(layout, slots[s].empty() ? Vec3{} : slots[s][0].position);
    for (std::size_t t = 0; t < layout.transducers.size(); ++t) {
      if (slots[s].empty()) {
        ASSERT_EQ(drives[s][t].amplitude, 0);
        ASSERT_EQ(drives[s][t].phase, 0);
        continue;
      }
      const Complex q = expected[t];
      ASSERT_NEAR(drives[s][t].amplitude, std::abs(q) * slots[s][0].gain, 3e-7) << s << " " << t;
      ASSERT_LE(angle_between(drives[s][t].phase, std::arg(q)), GetParam().phase_tolerance) << s << " " << t;
    }
  }
}

TEST_P(DriveOn, PhasesAreExactUpToTwoMetresAndStillRightFarAway) {
  const Layout near = scattered(4000, 5, 0.57), far = scattered(2000, 6, 5);  // near: within 1 m of the origin
  for (const Vec3& focus : {Vec3(0), Vec3(0.3, 0, 0), Vec3(1, 0, 0), Vec3(4)}) {
    const Layout& layout = focus.x > 2 ? far : near;
    DriveOptions options;
    if (focus.x == 0.3) options.medium.sound_speed = 380;
    const Drive drive = GetParam().drive(layout, {{focus}}, options);
    const auto expected = asked(layout, focus, options);
    double worst = 0;
    for (std::size_t t = 0; t < layout.transducers.size(); ++t)
      worst = std::max(worst, angle_between(drive[t].phase, std::arg(expected[t])));
    EXPECT_LE(worst, focus.x > 2 ? 1e-3 : GetParam().phase_tolerance) << focus.x;
  }
}

TEST_P(DriveOn, SeveralFociAreTheNormalisedSum) {
  const Layout layout = load_layout("paper");
  auto slots = random_slots(12, 5, 4);
  // A focus without gain keeps the others down: modulating one finger must not make another louder.
  for (auto& foci : slots) {
    if (foci.size() > 2) foci.back().gain = 0;
  }
  for (const Weighting weighting : {Weighting::distance, Weighting::uniform}) {
    for (const Constraint constraint : constraints) {
      DriveOptions options;
      options.weighting = weighting;
      options.constraint = constraint;
      const auto drives = GetParam().drives(layout, slots, options);
      for (std::size_t s = 0; s < slots.size(); ++s) {
        if (slots[s].size() < 2) continue;
        EXPECT_EQ(faults(drives[s]), 0u);
        double shared = 0;
        for (const SlotFocus& focus : slots[s])
          shared = std::max<double>(shared, focus.gain);
        std::vector<Complex> plain(layout.transducers.size()), heard(layout.transducers.size());
        for (const SlotFocus& focus : slots[s]) {
          const auto q = asked(layout, focus.position, options);
          for (std::size_t t = 0; t < q.size(); ++t) {
            plain[t] += q[t];
            heard[t] += q[t] * static_cast<double>(focus.gain);
          }
        }
        double largest = 0;
        for (const Complex& sum : plain)
          largest = std::max(largest, std::abs(sum));
        for (std::size_t t = 0; t < heard.size(); ++t) {
          const double size = std::abs(heard[t]);
          const double expected = constraint == Constraint::normalise ? std::min(size / largest, shared)
                                  : constraint == Constraint::uniform ? shared
                                                                      : std::min(size, shared);
          ASSERT_NEAR(drives[s][t].amplitude, expected, GetParam().sum_tolerance) << s << " " << t;
          ASSERT_LE(angle_between(drives[s][t].phase, std::arg(heard[t])) * std::min(1.0, size),
                    GetParam().sum_tolerance * 3)
              << s << " " << t;
        }
      }
    }
  }
}

TEST_P(DriveOn, OpenmpdAgreesWithLevitate) {
  PALPA_SHARED_OR_SKIP(folder, "acoustics-levitate");
  const Layout layout = load_layout("openmpd");
  DriveOptions options;
  options.medium.sound_speed = 343;
  const Drive drive = GetParam().drive(layout, {{{0, 0, 0.15}}}, options);
  const std::vector<double> phases = levitate_phases(folder, layout);
  Complex common = 0;
  for (std::size_t t = 0; t < phases.size(); ++t) {
    EXPECT_LE(angle_between(drive[t].phase, phases[t]), 5.1e-5) << t;
    common += std::polar(1.0, drive[t].phase - phases[t]);
  }
  EXPECT_LE(std::abs(std::arg(common)), 1e-6) << "both count from the source";
}

TEST_P(DriveOn, HalfAWaveIsPlusPi) {
  DriveOptions options;
  options.medium.sound_speed = options.medium.frequency / 128;  // 1/128 m, so that halves are exact
  Layout layout;
  for (const double waves : {0.5, 1.5, 7.5, 50.5})
    layout.transducers.push_back({{waves / 128, 0, 0}, {0, 0, 1}});
  const Drive drive = GetParam().drive(layout, {{{0, 0, 0}}}, options);
  EXPECT_EQ(faults(drive), 0u);
  for (const TransducerDrive& t : drive)
    EXPECT_NEAR(t.phase, pi, 3e-7);
}

TEST_P(DriveOn, AFocusOnATransducer) {
  Layout layout = load_layout("openmpd");
  const Vec3 place = layout.transducers[17].position;
  for (const double off : {0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-4}) {
    const Vec3 focus = place + Vec3(0, 0, off);
    const auto drives = GetParam().drives(layout, {{{focus}}, {{focus}, {{0, 0, 0.1}}}}, {});
    EXPECT_EQ(faults(drives[0]) + faults(drives[1]), 0u) << off;
    EXPECT_LE(angle_between(drives[0][17].phase, -2 * pi * off * DriveOptions{}.medium.turns_per_metre()), 1e-6) << off;
    EXPECT_NEAR(drives[0][17].amplitude, 0, off * 20 + 1e-12);
  }
}

TEST_P(DriveOn, DegenerateSlots) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr float bad = std::numeric_limits<float>::quiet_NaN();
  constexpr double inf = std::numeric_limits<double>::infinity();
  const Layout layout = load_layout("openmpd");
  const SlotFocus good{{0, 0, 0.1}};
  const auto drives = GetParam().drives(layout,
                                        {{},
                                         {{{nan, 0, 0}}},
                                         {{{0, inf, 0}}, {{0, 0, -inf}}},
                                         {{{1e6, 0, 0}}},
                                         {good},
                                         {{{0, nan, 0}}, good},
                                         {{good.position, bad}},
                                         {{good.position, -3.0F}},
                                         {{good.position, 7.0F}},
                                         {good, good, good},
                                         {{{99, 99, 99}}}},
                                        {});
  for (const Drive& drive : drives)
    EXPECT_EQ(faults(drive), 0u);
  const auto loudest = [&](int slot) {
    return std::ranges::max_element(drives[slot], {}, &TransducerDrive::amplitude)->amplitude;
  };
  for (const int silent : {0, 1, 2, 3, 6, 7})
    EXPECT_EQ(loudest(silent), 0) << silent;
  for (const int sounding : {4, 5, 8, 9, 10})
    EXPECT_NEAR(loudest(sounding), 1, 1e-6) << sounding;
  for (std::size_t t = 0; t < drives[4].size(); ++t) {
    // An invalid focus changes nothing; three at one place act as one.
    ASSERT_EQ(drives[5][t].phase, drives[4][t].phase);
    ASSERT_EQ(drives[8][t].amplitude, drives[4][t].amplitude);
    ASSERT_NEAR(drives[9][t].amplitude, drives[4][t].amplitude, 1e-5);
    ASSERT_LE(angle_between(drives[9][t].phase, drives[4][t].phase), 1e-5);
  }
}

TEST_P(DriveOn, DegenerateLayouts) {
  Layout layout;
  EXPECT_TRUE(GetParam().drive(layout, {{{0, 0, 0.1}}}).empty());
  EXPECT_TRUE(GetParam().drive(layout, {{{0, 0, 0.1}}, {{0, 0, 0.2}}}).empty());
  // One transducer with the focus exactly on it, and with two foci that cancel there.
  layout.transducers.push_back({{0, 0, 0}, {0, 0, 1}});
  const double half_wave = 0.5 / DriveOptions{}.medium.turns_per_metre();
  for (const Weighting weighting : {Weighting::distance, Weighting::uniform}) {
    DriveOptions options;
    options.weighting = weighting;
    const auto drives = GetParam().drives(
        layout, {{{{0, 0, 0}}}, {{{0, 0, half_wave}}, {{0, 0, 2 * half_wave}}}, {{{0, 0, 0}}, {{0, 0, 0}}}}, options);
    for (const Drive& drive : drives)
      EXPECT_EQ(faults(drive), 0u);
    EXPECT_EQ(drives[0][0].amplitude, 1);
    EXPECT_EQ(drives[0][0].phase, 0);
    EXPECT_EQ(drives[2][0].amplitude, 1);
  }
}

TEST(DriveSums, HaveTheAngleAndTheShareOfTheirSums) {
  std::vector<Complex> sums{0, {0, 1}, {0, -1}, {-1, 0}, {1, 0}, {1e-200, -1e-200}, 3};
  for (int turns = 0; turns < 720; ++turns)
    sums.push_back(std::polar(0.5, (turns - 359.5) * pi / 360));
  Drive drive(sums.size());
  drive_sums(sums, 2, 0.5, drive);
  for (std::size_t n = 0; n < sums.size(); ++n) {
    EXPECT_NEAR(drive[n].phase, std::arg(sums[n]), 2.4e-7) << sums[n];
    EXPECT_FLOAT_EQ(drive[n].amplitude, 0.5F * std::min(1.0F, static_cast<float>(std::abs(sums[n]) / 2))) << sums[n];
  }
}

TEST(Medium, SoundSpeedAtATemperature) {
  EXPECT_NEAR(sound_speed_at(0), 331.3, 1e-12);
  EXPECT_NEAR(sound_speed_at(15), 340.28, 0.005);
  EXPECT_NEAR(sound_speed_at(20), 343.21, 0.005);
  EXPECT_NEAR(sound_speed_at(30), 349.02, 0.005);
  EXPECT_NEAR(Medium{}.sound_speed, sound_speed_at(20), 0.005);
  EXPECT_GT(sound_speed_at(-60), 280);
  EXPECT_LT(sound_speed_at(100), 390);
  EXPECT_ERROR(sound_speed_at(-60.1), Exit::usage, "temperature -60.1");
  EXPECT_ERROR(sound_speed_at(100.1), Exit::usage, "temperature 100.1");
  EXPECT_ERROR(sound_speed_at(std::nan("")), Exit::usage, "temperature nan");
  EXPECT_ERROR(sound_speed_at(INFINITY), Exit::usage, "temperature inf");
}

TEST(Drives, AreQuickForFewFociOfASlowSolver) {
  constexpr double slot_s = 1.5e-3;
  const auto quick = [](Solver solver, Constraint constraint, std::size_t transducers) {
    return quick_foci(transducers, {.constraint = constraint, .solver = solver}, slot_s);
  };
  EXPECT_GT(quick(Solver::naive, Constraint::uniform, 3984), 1000U);
  EXPECT_EQ(quick(Solver::gs_pat, Constraint::uniform, 3984), 3U);
  EXPECT_EQ(quick(Solver::gs_pat, Constraint::uniform, 256), 58U);
  EXPECT_EQ(quick(Solver::loudest, Constraint::uniform, 256), 1U);
  EXPECT_EQ(quick(Solver::loudest, Constraint::normalise, 256), 1U);
  const DriveOptions limited{.solver = Solver::gs_pat, .most_work = 8192};
  EXPECT_GT(quick_foci(3984, limited, slot_s), 1000U) << "what is not quick is naive";
  EXPECT_EQ(quick_foci(3984, limited, 0.5e-3), 1U);
  EXPECT_EQ(quick(Solver::back_propagation, Constraint::clamp, 256), 1U);
  const std::vector<Null> nulls(1);
  const auto silent = std::make_shared<Nulls>(scattered(8, 1), Medium(), Directivity::omni, nulls);
  EXPECT_EQ(quick_foci(256, {.solver = Solver::gs_pat, .nulls = silent}, slot_s), 0U);
}

/// What takes longer than 2 ms is solved by several threads.
TEST(SlotDrives, AreTheSameOnAnyNumberOfThreads) {
  const Layout layout = scattered(300, 5);
  const DriveOptions options{.constraint = Constraint::uniform, .solver = Solver::gs_pat};
  std::vector<std::vector<SlotFocus>> foci(40);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> place(-0.2, 0.2);
  for (std::size_t slot = 0; slot < foci.size(); ++slot) {
    for (std::size_t j = 0; j < slot % 9; ++j)
      foci[slot].push_back({.position = {place(random), place(random), place(random)}});
  }
  const std::vector<Complex> factors{{0.5, 0.1}, {-0.2, 0.3}};
  SlotDrives slots;
  for (int batch = 0; batch < 3; ++batch) {
    const std::size_t transducers = layout.transducers.size();
    Drive drives((foci.size() + 1) * transducers);
    slots.clear();
    for (const std::vector<SlotFocus>& slot : foci)
      slots.add(slot, {});
    slots.add(foci[2], factors);
    slots.solve(layout, options, drives);
    const auto drive_of = [&](std::size_t slot) { return std::span(drives).subspan(slot * transducers, transducers); };
    for (std::size_t slot = 0; slot < foci.size(); ++slot)
      EXPECT_TRUE(same(drive_of(slot), drive_for(layout, foci[slot], options))) << batch << ": " << slot;
    Drive given(transducers);
    DriveScratch scratch;
    drive_by_factors(layout, foci[2], factors, options, given, scratch);
    EXPECT_TRUE(same(drive_of(foci.size()), given)) << batch;
  }
}

}  // namespace
}  // namespace palpa::array
