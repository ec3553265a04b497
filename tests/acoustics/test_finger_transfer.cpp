// The sound of transducers at places of one finger: against the sound of one transducer after the other, against the
// sphere's exact series, and with the solvers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "acoustics/bodies/body_places.hpp"
#include "acoustics/bodies/finger_transfer.hpp"
#include "acoustics/bodies/moving_body.hpp"
#include "acoustics/bodies/sphere_series.hpp"
#include "acoustics/field/pressure.hpp"
#include "acoustics/rigs.hpp"
#include "array/drive.hpp"
#include "array/loudness.hpp"
#include "geometry/mesh/icosphere.hpp"

namespace palpa::acoustics {
namespace {

using Complex = std::complex<double>;
constexpr double radius = ball_radius;

/// The sound on the ball of an array that plays `strengths`.
std::vector<std::complex<float>> played(const array::Layout& layout, const Air& air, array::Directivity kind,
                                        std::span<const Complex> strengths) {
  Waves waves;
  Incident(layout, air, kind).at(ball().points(), ball().normals(), strengths, waves);
  return ball().solve(waves);
}

/// The pressure on the skin at the place of a focus inside the ball.
double heard(std::span<const std::complex<float>> unknowns, const Vec3& focus) {
  const BodyPlace skin = BodyPlaces(ball().patches()).of(focus);
  return std::abs(ball().at_skin(unknowns, skin.face, skin.u, skin.v).pressure);
}

std::vector<Complex> transfer_of(const FingerTransfer& finger, const array::Layout& layout, const Vec3& focus) {
  const array::FocusSource source{focus, 0, 1};
  array::Columns columns;
  finger.fill(std::span(&source, 1), array::Weighting::uniform, columns);
  std::vector<Complex> sound;
  for (std::size_t t = 0; t < layout.transducers.size(); ++t)
    sound.push_back(layout.source_level_pa_m * columns.transfer(t));
  return sound;
}

TEST(FingerTransfer, IsThePressureOfEachTransducerAlone) {
  const array::Layout layout = shell(12);
  for (const auto& [air, kind] :
       {std::pair(still_air(), array::Directivity::omni), std::pair(air_of({}), array::Directivity::piston)}) {
    const RigidBody& body = ball();
    FingerTransfer finger(body, layout, air, kind);
    // Inside the ball; at a face's centre; in the air, near and far.
    const std::vector<Vec3> foci{
        {1e-3, 2e-3, -3e-3}, body.patches().patches[77].at(1.0 / 3, 1.0 / 3), {0, 9e-3, 0}, {0.02, -0.01, 0.03}};
    const std::vector<Vec3> places = finger.aim(foci);
    EXPECT_NEAR(glm::length(places[0]), radius, 0.2e-3);
    EXPECT_LE(glm::length(glm::cross(glm::normalize(places[0]), glm::normalize(foci[0]))), 0.1);
    EXPECT_LE(glm::distance(places[1], foci[1]), 1e-4);
    EXPECT_EQ(places[2], foci[2]);
    EXPECT_EQ(places[3], foci[3]);
    const BodyPlace skin = BodyPlaces(body.patches()).of(foci[0]);
    std::vector<std::vector<Complex>> sounds;
    double loudest = 0;
    for (const Vec3& focus : foci) {
      sounds.push_back(transfer_of(finger, layout, focus));
      for (const Complex& g : sounds.back())
        loudest = std::max(loudest, std::abs(g));
    }
    for (std::size_t t = 0; t < layout.transducers.size(); ++t) {
      std::vector<Complex> alone(layout.transducers.size());
      alone[t] = 1;
      const auto unknowns = played(layout, air, kind, alone);
      EXPECT_LE(std::abs(body.at_skin(unknowns, skin.face, skin.u, skin.v).pressure - sounds[0][t]), 1e-4 * loudest)
          << t;
      EXPECT_LE(std::abs(body.at_faces(unknowns)[77].pressure - sounds[1][t]), 1e-4 * loudest) << t;
      Waves direct;
      const std::span air_places = std::span(foci).subspan(2);
      Incident(layout, air, kind).at(air_places, {}, alone, direct);
      const std::vector<Complex> scattered = body.scattered(unknowns, air_places);
      for (std::size_t i = 0; i < 2; ++i)
        EXPECT_LE(std::abs(direct.pressures[i] + scattered[i] - sounds[2 + i][t]), 1e-3 * loudest) << t;
    }
  }
}

// From few vertices instead of three samples a face: nearly the same sound, and the same phases.
TEST(MovingBody, HearsNearlyTheSame) {
  const array::Layout layout = shell(60);
  const Air& air = still_air();
  const MovingBody tracked(shared_ball(), air_of({}), array::Directivity::t4010a1);
  FingerTransfer exact(ball(), layout, air, array::Directivity::t4010a1);
  const std::vector<Vec3> foci{{1e-3, 2e-3, -7e-3}, {0, 8.5e-3, 0}, {-6e-3, 1e-3, 4e-3}};
  const std::vector<Vec3> places = exact.aim(std::span(foci).first(1));
  const auto heard = tracked.hear(foci, layout);
  ASSERT_EQ(heard.size(), foci.size());
  EXPECT_LE(glm::distance(heard[0].place, places[0]), 1e-9);
  EXPECT_NEAR(heard[1].moved_m, 0.5e-3, 0.1e-3);
  // On the skin, so that neither moves a focus.
  std::vector<Vec3> skin;
  for (const auto& one : heard)
    skin.push_back(one.place);
  exact.aim(skin);
  for (std::size_t j = 0; j < skin.size(); ++j) {
    const std::vector<Complex> right = transfer_of(exact, layout, skin[j]);
    Complex in_phase = 0;
    double best = 0;
    for (std::size_t t = 0; t < right.size(); ++t) {
      in_phase += right[t] * std::conj(heard[j].sound[t]) / std::abs(heard[j].sound[t]);
      best += std::abs(right[t]);
    }
    EXPECT_LE(relative_error(heard[j].sound, right), 0.003) << j;
    EXPECT_GE(std::abs(in_phase), 0.99999 * best) << j;
  }
}

TEST(FingerTransfer, DrivesForTheFingerAreTheLoudest) {
  const array::Layout layout = shell(200);
  const Air& air = still_air();
  FingerTransfer finger(ball(), layout, air, array::Directivity::t4010a1);
  const std::vector<Vec3> foci{{0, -7.5e-3, 0}, {2e-3, -7e-3, 1e-3}, {-6e-3, -2e-3, 3e-3}};
  finger.aim(foci);
  array::DriveOptions free_air{.weighting = array::Weighting::uniform}, on_finger = free_air;
  on_finger.transfer = &finger;
  double most = 0;
  for (const Vec3& focus : foci) {
    const std::vector<array::SlotFocus> one{{focus}};
    const auto pressure = [&](const array::Drive& drive) {
      return pressure_at_foci(layout, drive, one, finger).pascals[0];
    };
    const array::Drive drive = array::drive_for(layout, one, on_finger);
    for (const array::TransducerDrive& t : drive)
      EXPECT_EQ(t.amplitude, 1);
    const double now = pressure(drive), before = pressure(array::drive_for(layout, one, free_air));
    EXPECT_GE(now, before);
    most = std::max(most, now / before);
    double sum = 0;
    for (const Complex& g : transfer_of(finger, layout, focus))
      sum += std::abs(g);
    EXPECT_NEAR(now / sum, 1, 1e-6);
    array::Drive conjugate = drive;
    for (array::TransducerDrive& t : conjugate)
      t.phase = -t.phase;
    EXPECT_LT(pressure(conjugate), 0.5 * now);
    // This is true of the actual sound, not only of the factors that it was made of.
    const auto unknowns = played(layout, air, array::Directivity::t4010a1, strengths_of(drive));
    EXPECT_NEAR(heard(unknowns, focus) / now, 1, 1e-4);
  }
  EXPECT_GT(most, 1.02);
}

TEST(FingerTransfer, ServesEverySolverAndPressure) {
  const array::Layout layout = shell(200);
  const Air& air = still_air();
  FingerTransfer finger(ball(), layout, air, array::Directivity::t4010a1);
  const std::vector<Vec3> foci{{5e-3, -5e-3, 0}, {-5e-3, -5e-3, 1e-3}, {0, -2e-3, 7e-3}};
  finger.aim(foci);
  array::Schedule schedule;
  std::vector<array::SlotFocus> slot;
  for (const Vec3& focus : foci) {
    array::Voice& voice = schedule.add_voice();
    voice.foci = {focus};
    voice.order = {0};
    voice.pressure_pa = 700;
    slot.push_back({focus});
  }
  for (const array::Solver solver : {array::Solver::naive, array::Solver::gs_pat, array::Solver::greedy}) {
    for (const array::Constraint constraint :
         {array::Constraint::normalise, array::Constraint::uniform, array::Constraint::clamp}) {
      const array::DriveOptions options{.constraint = constraint, .solver = solver, .transfer = &finger};
      const array::Drive drive = array::drive_for(layout, slot, options);
      EXPECT_GE(pressure_at_foci(layout, drive, slot, finger).evenness, solver == array::Solver::gs_pat ? 0.98 : 0.6);
    }
    if (solver == array::Solver::greedy) continue;
    const array::DriveOptions options{.solver = solver, .transfer = &finger};
    array::Loudness loudness(layout, options);
    loudness.solve(schedule, 1);
    std::vector<array::SlotFocus> asked;
    array::foci_of_slot(schedule, 0, asked);
    array::Drive drive(layout.transducers.size());
    array::DriveScratch scratch;
    array::drive_by_factors(layout, asked, loudness.factors(0), options, drive, scratch);
    const auto unknowns = played(layout, air, array::Directivity::t4010a1, strengths_of(drive));
    for (const Vec3& focus : foci) {
      EXPECT_NEAR(heard(unknowns, focus), 700, 2);
    }
  }
}

TEST(FingerTransfer, KeepsWhatItKnows) {
  const array::Layout layout = shell(30);
  const Air& air = still_air();
  const Vec3 stays(0, -6e-3, 0), goes(4e-3, -4e-3, 0), comes(0, -4e-3, 4e-3);
  FingerTransfer finger(ball(), layout, air, array::Directivity::omni);
  finger.aim(std::vector{stays, goes});
  const std::vector<Complex> before = transfer_of(finger, layout, stays);
  const std::vector<Vec3> places = finger.aim(std::vector{comes, stays, comes});
  EXPECT_EQ(places[0], places[2]);
  EXPECT_EQ(transfer_of(finger, layout, stays), before);
  for (const Complex& g : transfer_of(finger, layout, goes))
    EXPECT_EQ(g, 0.0);
  FingerTransfer other(ball(), layout, air, array::Directivity::omni);
  other.aim(std::vector{comes});
  const std::vector<Complex> alone = transfer_of(other, layout, comes), among = transfer_of(finger, layout, comes);
  for (std::size_t t = 0; t < alone.size(); ++t)
    EXPECT_LE(std::abs(alone[t] - among[t]), 1e-5 * std::abs(alone[t]));
}

}  // namespace
}  // namespace palpa::acoustics
