// Prints the device time of every pass of touching for clouds of several sizes. It is not a test; run it by hand.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>

#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

void print(const char* what, const std::vector<glm::vec3>& points, const geometry::Solid& solid,
           const Parameters& parameters) {
  const auto count = static_cast<std::uint32_t>(points.size());
  std::vector<gpu::PassTime> times;
  const Touch touch = touch_on_device(indexed(points), {solid}, {.parameters = parameters}, 15, &times);
  double sum = 0;
  std::printf("%-34s %7u points %7zu contacts %3u fingers |", what, count, touch.contacts.size(), touch.finger_count);
  for (const gpu::PassTime& time : times) {
    std::printf(" %s %.3f", time.name, time.ms);
    sum += time.ms;
  }
  // On a busy machine, only the last value is meaningful: the processor time of a software device's threads.
  std::printf(" | sum without the last %.3f ms\n", sum - times.back().ms);
}

/// The skin of five fingers that hang side by side, 22 mm apart.
std::vector<glm::vec3> five_fingers(std::uint32_t count) {
  std::vector<glm::vec3> points;
  for (int f = 0; f < 5; ++f) {
    const auto one = fingertip(count / 5, 3e-3, 0.022 * (f - 2), 0, static_cast<unsigned>(f + 1));
    points.insert(points.end(), one.begin(), one.end());
  }
  return points;
}

void run() {
  print("cube", fingertip(10'000, 3e-3), cube(), {});
  print("half ball", fingertip(10'000, 3e-3), half_ball({0, -0.02, 0}, 0.02, 1000), {});
  auto frame = fingertip(20'000, 10e-3, 0);
  const auto more = fingertip(10'000, 10e-3, 0.03, 0, 2);
  frame.insert(frame.end(), more.begin(), more.end());
  print("frame: two fingers, wide box", frame, box({-0.1, -0.04, -0.1}, {0.1, 0, 0.1}), {.delta_m = 3.2e-3});
  for (const double gap : {2e-3, 5e-3, 10e-3, 50e-3}) {
    std::printf("gap %g mm\n", gap * 1e3);
    for (const std::uint32_t count : {20'000U, 100'000U}) {
      print(" five fingers", five_fingers(count), everything(), everything_is_contact(gap, 5));
      print(" random in a 100 mm cube", random_points(count, Vec3(-0.05), Vec3(0.05)), everything(),
            everything_is_contact(gap, 5));
    }
  }
}

}  // namespace
}  // namespace palpa::touch::test

int main() {
  palpa::touch::test::run();
}
