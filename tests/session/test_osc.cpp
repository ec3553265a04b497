// OSC messages on their way to a session. tests/python/test_live_control.py has them from another program.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "geometry/gltf/gltf.hpp"
#include "session/control/osc.hpp"
#include "session/control/osc_message.hpp"
#include "support/begins.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "support/udp_receiver.hpp"

namespace palpa::session {
namespace {

std::string padded(std::string text) {
  text.resize((text.size() / 4 + 1) * 4);
  return text;
}

std::string message(const std::string& address, std::initializer_list<float> numbers) {
  std::string bytes = padded(address) + padded("," + std::string(numbers.size(), 'f'));
  for (const float number : numbers) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &number, 4);
    for (int shift = 24; shift >= 0; shift -= 8)
      bytes.push_back(static_cast<char>(bits >> shift));
  }
  return bytes;
}

std::vector<geometry::Solid> cube_called(const std::string& name) {
  auto solids = geometry::make_solids(geometry::load_gltf(test::source_file("assets/cube.glb")));
  solids[0].name = name;
  return solids;
}

/// Poses as the session gets them.
struct Moves final : RunObserver {
  std::map<std::uint32_t, Transform> poses;
  int count = 0;
  void moved(std::uint32_t solid, const Transform& T_world_rest) override {
    poses[solid] = T_world_rest;
    ++count;
  }
};

struct OscTest : testing::Test {
  std::string address = test::UdpReceiver().address().substr(4);  // a free port
  Session session{SessionSetting{.solids = cube_called("cube")}};
  Moves moves;

  void SetUp() override {
    try {
      check_osc();
    } catch (const Error& error) {
      GTEST_SKIP() << "skipped: " << error.what();
    }
  }
};

TEST_F(OscTest, TheNewestValuesAreThereAtTheNextFrame) {
  Osc osc(address);
  UdpSender sender(address, "test", "");
  sender.send(message("/palpa/gain", {0.5F}));  // it waits until somebody listens
  EXPECT_EQ(osc.gain(), 1.0);
  osc.listen(session.solid_names(), moves);
  EXPECT_TRUE(test::begins([&] { return osc.gain() == 0.5; }));
  for (int n = 0; n < 10; ++n)
    sender.send(message("/palpa/pose/cube", {0, 0, 0.001F * static_cast<float>(n)}));
  sender.send(message("/palpa/mute", {1}));
  EXPECT_TRUE(test::begins([&] { return osc.gain() == 0.0; })) << "what came before it is there, too";
  osc.before_frame(session);
  EXPECT_EQ(moves.count, 1) << "only the newest";
  EXPECT_NEAR(moves.poses[0][3].z, 0.009, 1e-9);
  osc.before_frame(session);
  EXPECT_EQ(moves.count, 1) << "nothing is new";
  const MessageStats stats = osc.end();
  EXPECT_EQ(stats.taken, 12U);
  EXPECT_EQ(stats.refused, 0U);
}

TEST_F(OscTest, ValuesStayWhenTheSceneIsReadAgain) {
  Osc osc(address);
  osc.listen(session.solid_names(), moves);
  UdpSender sender(address, "test", "");
  sender.send(message("/palpa/pose/cube", {0, 0.01F, 0}));
  EXPECT_TRUE(test::begins([&] { return osc.before_frame(session), moves.count == 1; }));
  Session other{SessionSetting{.solids = cube_called("other")}}, again{SessionSetting{.solids = cube_called("cube")}};
  for (Session* next : {&other, &again}) {
    session.exchange_scene(*next);
    osc.set_solids(session.solid_names());
    osc.before_frame(session);
    EXPECT_EQ(moves.count, next == &other ? 1 : 2);
  }
  EXPECT_NEAR(moves.poses[0][3].y, 0.01, 1e-9);
}

TEST_F(OscTest, AFloodBlocksNobody) {
  Osc osc(address);
  osc.listen(session.solid_names(), moves);
  std::atomic<bool> over{false};
  std::thread flood([&] {
    UdpSender sender(address, "test", "");
    while (!over) {
      sender.send(message("/palpa/pose/cube", {0, 0.01F, 0}));
      sender.send("garbage");
    }
  });
  EXPECT_TRUE(test::begins([&] { return osc.before_frame(session), moves.count > 20; }));
  over = true;
  flood.join();
  EXPECT_GT(osc.end().refused, 20U);
}

TEST(OscAddress, IsThisMachinesUnlessItIsAskedFor) {
  EXPECT_EQ(parse_osc_address("9000").host, "127.0.0.1");
  EXPECT_EQ(parse_osc_address("0.0.0.0:9000").host, "0.0.0.0");
  EXPECT_EQ(parse_osc_address("[::]:9000").host, "::");
  for (const char* form : {"", "0", "65536", "9000x", ":9000", "host:", "-1"})
    EXPECT_ERROR(parse_osc_address(form), Exit::usage, "--osc takes PORT or ADDRESS:PORT") << form;
}

}  // namespace
}  // namespace palpa::session
