// How loud the weakest of several foci is, compared with the loudest that an independent optimiser found. Each test
// runs on both backends.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "acoustics/field/pressure.hpp"
#include "backends.hpp"
#include "focus_sets.hpp"
#include "loud_optima.hpp"
#include "loud_sets.hpp"

namespace palpa::array {
namespace {

using acoustics::FociPressure;
using acoustics::pressure_at_foci;

class LoudestOn : public testing::TestWithParam<Backend> {};
INSTANTIATE_TEST_SUITE_P(Backends, LoudestOn, testing::ValuesIn(backends), backend_name);

DriveOptions with(Solver solver, Constraint constraint = Constraint::uniform) {
  DriveOptions options;
  options.solver = solver;
  options.constraint = constraint;
  return options;
}

/// The weakest focus of the first sets of `optima`, of their optimum; the least first.
std::vector<double> loudness(const Backend& backend, const LoudOptima& optima, std::uint32_t count,
                             const DriveOptions& options) {
  const Layout layout = load_layout(optima.layout);
  std::vector<std::vector<SlotFocus>> sets;
  for (std::uint32_t s = 0; s < count; ++s)
    sets.push_back(loud_set(s, optima.fewest, optima.most, middle_of(layout)));
  const auto drives = backend.drives(layout, sets, options);
  std::vector<double> parts;
  for (std::uint32_t s = 0; s < count; ++s) {
    EXPECT_EQ(faults(drives[s]), 0u);
    const FociPressure heard = pressure_at_foci(layout, drives[s], sets[s]);
    parts.push_back(*std::ranges::min_element(heard.pascals) / optima.pascals[s]);
  }
  std::ranges::sort(parts);
  std::printf("  %s, %s, %zu to %zu foci: the least %.3f, then %.3f, median %.3f\n", backend.name, optima.layout,
              optima.fewest, optima.most, parts[0], parts[1], parts[parts.size() / 2]);
  return parts;
}

/// The host solves these slots for the device, too: a few suffice there.
std::uint32_t sets_for(const Backend& backend, std::uint32_t sets) {
  return std::string(backend.name) == "twin" ? sets : 3;
}

// One set in a hundred is below the second limit; here, one may be.
TEST_P(LoudestOn, UpToTenFociAreNearTheirOptimum) {
  for (const LoudOptima& optima : loud_optima) {
    if (optima.most > 10) continue;
    const std::vector<double> loudest = loudness(GetParam(), optima, sets_for(GetParam(), 12), with(Solver::loudest));
    EXPECT_GE(loudest[0], 0.95) << optima.layout;
    EXPECT_GE(loudest[1], 0.98) << optima.layout;
  }
}

TEST_P(LoudestOn, ManyFociAreNearTheirOptimum) {
  for (const LoudOptima& optima : loud_optima) {
    if (optima.most <= 10 || std::string(optima.layout) == "paper") continue;
    const std::vector<double> loudest = loudness(GetParam(), optima, sets_for(GetParam(), 6), with(Solver::loudest));
    EXPECT_GE(loudest[0], 0.9) << optima.layout;
    EXPECT_GE(loudest[1], 0.95) << optima.layout;
  }
}

// gs-pat has less effort, and gives up to 4.5 % of the weakest focus for evenness.
TEST_P(LoudestOn, GsPatIsNearTheOptimumToo) {
  for (const LoudOptima& optima : loud_optima) {
    if (optima.most > 10) continue;
    for (const Constraint constraint : {Constraint::uniform, Constraint::clamp}) {
      const auto sets = std::string(GetParam().name) == "twin" ? 30U : 10U;
      const std::vector<double> parts = loudness(GetParam(), optima, sets, with(Solver::gs_pat, constraint));
      EXPECT_GE(parts[0], 0.85) << optima.layout;
      EXPECT_GE(parts[1], constraint == Constraint::uniform ? 0.93 : 0.9) << optima.layout;
    }
  }
}

// Slots of foci near each other are those of the twin, also on a device.
TEST(Loudest, FociNearEachOtherHaveTheSameBytesOnBothBackends) {
  const Layout layout = load_layout("autd3");
  std::vector<std::vector<SlotFocus>> sets;
  for (std::uint32_t s = 0; s < 12; ++s)
    sets.push_back(loud_set(s, 2, 10, middle_of(layout)));
  for (const Solver solver : {Solver::gs_pat, Solver::loudest}) {
    const auto first = backends[0].drives(layout, sets, with(solver)),
               second = backends[1].drives(layout, sets, with(solver));
    std::size_t same = 0;
    for (std::size_t s = 0; s < sets.size(); ++s)
      same += std::memcmp(first[s].data(), second[s].data(), first[s].size() * sizeof(first[s][0])) == 0;
    EXPECT_GE(same, 10U) << static_cast<int>(solver);  // two of the sets may have only foci far from each other
  }
}

// Five foci within 5 mm, which the array does not resolve: even foci have at most 4640 Pa, the loudest weakest 5810 Pa.
TEST_P(LoudestOn, LoudnessComesBeforeEvenness) {
  const Layout layout = load_layout("openmpd");
  const std::vector<SlotFocus> foci{{{0.00783, -0.00074, 0.15}},
                                    {{0.00877, -0.00224, 0.14759}},
                                    {{0.01002, -0.00478, 0.14851}},
                                    {{0.00986, -0.00487, 0.15149}},
                                    {{0.00851, -0.00237, 0.15241}}};
  const FociPressure heard = pressure_at_foci(layout, GetParam().drive(layout, foci, with(Solver::loudest)), foci);
  EXPECT_GE(*std::ranges::min_element(heard.pascals), 5716);
  const FociPressure usual = pressure_at_foci(layout, GetParam().drive(layout, foci, with(Solver::gs_pat)), foci);
  EXPECT_GE(*std::ranges::min_element(usual.pascals), 0.94 * 5716);
}

TEST_P(LoudestOn, ResolvedFociAreEven) {
  const Layout layout = load_layout("paper");
  std::vector<std::vector<SlotFocus>> sets;
  for (unsigned seed = 0; seed < 4; ++seed)
    sets.push_back(focus_set(seed, seed % 2 == 0 ? 10 : 14));
  for (const Constraint constraint : {Constraint::uniform, Constraint::clamp}) {
    const auto drives = GetParam().drives(layout, sets, with(Solver::loudest, constraint));
    for (std::size_t s = 0; s < sets.size(); ++s)
      EXPECT_GE(pressure_at_foci(layout, drives[s], sets[s]).evenness, 0.98)
          << s << " " << static_cast<int>(constraint);
  }
}

TEST_P(LoudestOn, GainsAreRelativeAmplitudes) {
  const Layout layout = load_layout("paper");
  auto foci = focus_set(3, 5);
  const float gains[]{1, 0.5F, 0.25F, 0.8F, 0.6F};
  for (std::size_t j = 0; j < foci.size(); ++j)
    foci[j].gain = gains[j];
  for (const Constraint constraint : {Constraint::uniform, Constraint::clamp}) {
    const Drive drive = GetParam().drive(layout, foci, with(Solver::loudest, constraint));
    EXPECT_GE(pressure_at_foci(layout, drive, foci).evenness, 0.97) << static_cast<int>(constraint);
  }
}

// More foci than it seeks phases for are solved as by gs-pat, and a single one is the paper's.
TEST_P(LoudestOn, OtherSlotsAreThoseOfGsPat) {
  const Layout layout = load_layout("openmpd");
  const std::vector<std::vector<SlotFocus>> slots{focus_set(1, 33, {0, 0, 0.15}), focus_set(2, 1, {0, 0, 0.15})};
  const auto usual = GetParam().drives(layout, slots, with(Solver::gs_pat));
  const auto loudest = GetParam().drives(layout, slots, with(Solver::loudest));
  for (std::size_t s = 0; s < slots.size(); ++s) {
    for (std::size_t t = 0; t < usual[s].size(); ++t) {
      ASSERT_EQ(usual[s][t].amplitude, loudest[s][t].amplitude);
      ASSERT_EQ(usual[s][t].phase, loudest[s][t].phase);
    }
  }
}

TEST_P(LoudestOn, FociAtOnePlaceAndFociOutOfReachBreakNothing) {
  const Layout layout = load_layout("openmpd");
  const SlotFocus a{{0, 0, 0.15}}, b{{0.02, 0, 0.15}}, behind{{0, 0, -0.2}}, far{{0, 0, 90}};
  SlotFocus mute = b;
  mute.gain = 0;
  for (const std::vector<SlotFocus>& foci : {std::vector{a, a, b}, std::vector{a, mute}, std::vector{a, b, behind},
                                             std::vector{a, far, b}, std::vector{mute, mute}}) {
    for (const Constraint constraint : {Constraint::normalise, Constraint::uniform, Constraint::clamp}) {
      const Drive drive = GetParam().drive(layout, foci, with(Solver::loudest, constraint));
      EXPECT_EQ(faults(drive), 0u);
      const FociPressure heard = pressure_at_foci(layout, drive, foci);
      if (foci[0].gain > 0) {
        EXPECT_GT(heard.pascals[0], 1000) << static_cast<int>(constraint);
      }
    }
  }
}

}  // namespace
}  // namespace palpa::array
