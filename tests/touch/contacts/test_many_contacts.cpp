// Millions of contacts, on the device: a software device ends a shader's loops after 65,535 iterations together.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "support/exhaustive.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

/// Like touch_on(), but runs twice on the device only if exhaustive().
Touch touch_of(const std::vector<glm::vec3>& points, const Parameters& parameters) {
  const auto count = static_cast<std::uint32_t>(points.size());
  return touch_on_device(indexed(points), {everything()},
                         {.parameters = parameters, .most_points = count, .most_contacts = count},
                         palpa::test::exhaustive() ? 2 : 1);
}

// Nine consecutive loops go through all clusters. With one cluster per thread and iteration, 256 threads need too many
// iterations from 1.9 million clusters on.
TEST(ManyContacts, ThatAreEachAFingerTheFirstAndTheLargestAreTaken) {
  constexpr std::uint32_t wide = 145, large = 70;
  const std::uint32_t count = palpa::test::exhaustive() ? 3'000'000 : 2'000'000;
  std::vector<glm::vec3> points;
  points.reserve(count);
  for (std::uint32_t i = count; i-- > 0;)
    points.push_back(5e-3F * glm::vec3(i % wide, i / wide % wide, i / (wide * wide)) - glm::vec3(0.35F));
  points[count - 1] = points[large] + glm::vec3(1e-4F, 0, 0);
  const Touch touch = touch_of(points, everything_is_contact(1e-3, 1));
  EXPECT_EQ(touch.cluster_count, count - 1U);
  ASSERT_EQ(touch.finger_count, max_fingers);
  for (std::uint32_t f = 0; f + 1 < max_fingers; ++f)
    EXPECT_EQ(touch.fingers[f].contacts, std::vector<std::uint32_t>{f});
  EXPECT_EQ(touch.fingers[max_fingers - 1].contacts, (std::vector<std::uint32_t>{large, count - 1}));
}

TEST(ManyContacts, OfOneFingerAllCountForItsFoci) {
  const auto points = random_points(1'500'000, Vec3(-0.5, 0, -0.5), Vec3(0.5, 1e-3, 0.5));
  Parameters parameters = everything_is_contact();
  parameters.foci = max_foci;
  for (const Spacing spacing : {Spacing::angle, Spacing::arc}) {
    parameters.spacing = spacing;
    const Touch touch = touch_of(points, parameters);
    ASSERT_EQ(touch.finger_count, 1U);
    EXPECT_EQ(touch.fingers[0].contacts.size(), points.size());
    expect_identical(touch, touch_on(Backend::cpu, points, {everything()}, parameters));
  }
}

}  // namespace
}  // namespace palpa::touch::test
