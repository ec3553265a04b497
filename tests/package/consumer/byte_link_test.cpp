// Sends two drives through the example link and reads back what the board would get.
//   byte_link_test FILE
#include <algorithm>
#include <array>
#include <cstdio>
#include <numbers>

#include "byte_link.hpp"

int main(int, char** argv) {
  using namespace palpa;
  array::Layout layout;
  layout.transducers.resize(3);
  const session::LinkSetting setting{layout, {}};
  std::vector<session::LinkKind> kinds = session::builtin_links();
  kinds.push_back(byte_link());

  const auto pi = std::numbers::pi_v<float>;
  const auto link = session::open_link(std::string("bytes:") + argv[1], kinds, setting);
  link->send(0, array::Drive{{1.0f, 0.0f}, {0.5f, pi}, {0.25f, -pi / 2}});
  link->send(1, array::Drive(3, {0.0f, 0.0f}));
  link->finish();

  // Half a turn is step 128; minus a quarter turn is three quarters, step 192.
  const std::array<std::uint8_t, 12> wanted{255, 0, 128, 128, 64, 192, 0, 0, 0, 0, 0, 0};
  std::array<std::uint8_t, 13> sent{};
  std::FILE* file = std::fopen(argv[1], "rb");
  const std::size_t count = std::fread(sent.data(), 1, sent.size(), file);
  std::fclose(file);
  // The largest phase below a whole turn rounds up to the step that is zero.
  return count == wanted.size() && std::equal(wanted.begin(), wanted.end(), sent.begin()) &&
                 ByteLink::phase_step(-1e-6f) == 0
             ? 0
             : 1;
}
