// Millions of contacts, on the device: a software device ends a shader's loops after 65,535 iterations together.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "support/exhaustive.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

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
  const StageSetting setting{
      .parameters = everything_is_contact(1e-3, 1), .most_points = count, .most_contacts = count};
  const Touch touch = touch_on_device(indexed(points), {everything()}, setting, palpa::test::exhaustive() ? 2 : 1);
  EXPECT_EQ(touch.cluster_count, count - 1U);
  ASSERT_EQ(touch.finger_count, max_fingers);
  for (std::uint32_t f = 0; f + 1 < max_fingers; ++f)
    EXPECT_EQ(touch.fingers[f].contacts, std::vector<std::uint32_t>{f});
  EXPECT_EQ(touch.fingers[max_fingers - 1].contacts, (std::vector<std::uint32_t>{large, count - 1}));
}

}  // namespace
}  // namespace palpa::touch::test
