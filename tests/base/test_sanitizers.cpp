// Sanitizers that are built in must find errors: a flag that switched them off would leave their tests green.
#include <gtest/gtest.h>

#include <climits>
#include <vector>

namespace palpa::test {
namespace {

#if defined(PALPA_ADDRESS_SANITIZER)
constexpr bool is_sanitized = true;
#else
constexpr bool is_sanitized = false;
#endif

/// The compiler must not know the values.
volatile int one = 1, most = INT_MAX, many_bits = 40, nothing = 0, fourth = 3;

class SanitizersDeathTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!is_sanitized) GTEST_SKIP() << "skipped: this build has no AddressSanitizer";
    GTEST_FLAG_SET(death_test_style, "threadsafe");
  }
};

TEST_F(SanitizersDeathTest, StopAtUndefinedBehaviour) {
  const char* const stops = "AddressSanitizer: ILL";
  const int values[] = {1, 2, 3};
  EXPECT_DEATH(one = most + one, stops);
  EXPECT_DEATH(one = one << many_bits, stops);
  EXPECT_DEATH(one = one / nothing, stops);
  EXPECT_DEATH(one = values[fourth], stops);
}

TEST_F(SanitizersDeathTest, ReportAccessesOutsideTheHeapsBlocks) {
  std::vector<int> three(3);
  EXPECT_DEATH(three.assign(1, three.data()[fourth]), "heap-buffer-overflow");
}

}  // namespace
}  // namespace palpa::test
