// The pressure on a finger, computed in the background of the drawing: operators are kept, and each answer belongs to
// its question.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <optional>
#include <string>

#include "base/activity.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "session/previews/skin_preview.hpp"
#include "support/begins.hpp"
#include "support/thrown.hpp"
#include "support/time_limits.hpp"

namespace palpa::session {
namespace {

/// A ball for a fingertip above a board, one focus at its lowest point.
SkinQuestion question(const Vec3& focus = {0, 0, 0.095}) {
  SkinQuestion q;
  q.finger = geometry::icosphere(5e-3, 4);
  q.T_world_finger = glm::translate(Transform(1.0), Vec3(0, 0, 0.1));
  q.layout = array::load_layout("openmpd");
  q.air = acoustics::air_of({});
  array::Voice& voice = q.plan.schedule.add_voice();
  voice.foci = {focus};
  voice.order = {0};
  voice.modulation_hz = 0;
  SlotWork work;
  array::SlotDrives slots;
  drive_on_host(q.plan, q.layout, q.drive, work, nullptr, slots);
  return q;
}

std::size_t loudest(const SkinAnswer& answer) {
  return static_cast<std::size_t>(std::ranges::max_element(answer.vertices) - answer.vertices.begin());
}

TEST(SkinPreview, AFingersEquationsAreFactoredOnce) {
  acoustics::BodyCache bodies;
  SkinQuestion q = question();
  const SkinAnswer below = answer(q, bodies);
  ASSERT_EQ(below.faces.langevin.size(), q.finger.triangles.size());
  ASSERT_EQ(below.vertices.size(), q.finger.positions.size());
  EXPECT_LT(q.finger.positions[loudest(below)].z, -4e-3);
  // Another focus, another array, a finger elsewhere.
  SkinQuestion beside = question({4e-3, 0, 0.097});
  const SkinAnswer moved = answer(beside, bodies);
  EXPECT_GT(q.finger.positions[loudest(moved)].x, 1e-3);
  // Finger, array and focus turned about the world's x: nothing changes.
  SkinQuestion turned = question();
  const Transform turn = glm::rotate(Transform(1.0), 1.0, Vec3(1, 0, 0));
  turned.T_world_finger = turn * turned.T_world_finger;
  turned.layout = array::transformed(turned.layout, turn);
  const SkinAnswer same = answer(turned, bodies);
  for (std::size_t v = 0; v < same.vertices.size(); ++v)
    EXPECT_NEAR(same.vertices[v], below.vertices[v], 1e-3 * below.vertices[loudest(below)]);
  EXPECT_EQ(bodies.made(), 1u);
  // Another tone, or another finger.
  q.air.medium.frequency = 41e3;
  answer(q, bodies);
  EXPECT_EQ(bodies.made(), 2u);
  beside.finger.positions[0].x += 1e-5;
  answer(beside, bodies);
  EXPECT_EQ(bodies.made(), 3u);
  // Nothing sounds, so nothing is solved.
  beside.finger.positions[0].x += 1e-5;
  beside.plan.schedule.clear();
  EXPECT_EQ(answer(beside, bodies).vertices, std::vector<double>(beside.finger.positions.size(), 0.0));
  EXPECT_EQ(bodies.made(), 3u);
}

TEST(SkinPreview, SaysWhatAnAnswerIsOf) {
  acoustics::BodyCache bodies;
  const SkinAnswer wanted = answer(question({4e-3, 0, 0.097}), bodies);
  SkinPreview preview;
  EXPECT_FALSE(preview.stale());
  EXPECT_EQ(preview.newest()->number, 0u);
  const auto wait = [&] {
    EXPECT_TRUE(test::begins([&] { return !preview.stale(); }));
    return preview.newest();
  };
  EXPECT_EQ(preview.ask(question()), 1u);
  EXPECT_EQ(preview.ask(question()), 2u);
  EXPECT_EQ(preview.ask(question({4e-3, 0, 0.097})), 3u);
  const auto got = wait();
  EXPECT_EQ(got->number, 3u);
  EXPECT_EQ(got->fault, "");
  EXPECT_EQ(got->vertices, wanted.vertices);
  // Sound that is not a number has no answer; the next question has one again.
  SkinQuestion bad = question();
  bad.layout.source_level_pa_m = std::numeric_limits<double>::infinity();
  preview.ask(std::move(bad));
  EXPECT_NE(wait()->fault, "");
  // A plan of another array has no answer, either.
  bad = question();
  bad.layout.transducers.push_back(bad.layout.transducers.front());
  preview.ask(std::move(bad));
  EXPECT_CONTAINS(wait()->fault, "belongs to another array");
  preview.ask(question());
  EXPECT_EQ(wait()->fault, "");
}

TEST(SkinPreview, EndsInTheMiddleOfAnAnswer) {
  // Computed to the end, it would take one or two seconds of processor time.
  SkinQuestion long_work = question();
  long_work.finger = geometry::icosphere(10e-3, 16);
  for (const std::string stage : {"sampling neighbouring faces", "filling the matrix"}) {
    double begun = 0;
    {
      SkinPreview preview;
      bool stale = false;
      ASSERT_TRUE(test::begins([&] {
        stale = preview.stale();
        if (!stale) {  // at first, and where this thread stood still for the whole answer; another finger each time
          long_work.finger.positions[0].x += 1e-9;
          preview.ask(long_work);
          stale = preview.stale();
        }
        const std::optional<Doing> now = doing();
        return now && now->what.starts_with(stage);
      })) << stage;
      EXPECT_TRUE(stale) << "its question has no answer yet";
      begun = test::processor_s();
    }
    EXPECT_LT(test::processor_s() - begun, 0.25) << stage;
  }
}

}  // namespace
}  // namespace palpa::session
