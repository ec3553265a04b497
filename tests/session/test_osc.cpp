// OSC messages on their way to a session. tests/python/test_live_control.py has them from another program.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "session/control/osc.hpp"
#include "session/control/osc_message.hpp"
#include "support/begins.hpp"
#include "support/captured.hpp"
#include "support/thrown.hpp"
#include "support/udp_sender.hpp"
#include "touched_scene.hpp"

namespace palpa::session {
namespace {

std::string padded(std::string text) {
  text.resize((text.size() / 4 + 1) * 4);
  return text;
}

std::string message(const std::string& address, const std::vector<float>& numbers) {
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
  auto solids = test::asset_solids("cube");
  solids[0].name = name;
  return solids;
}

/// One that may be pressed.
SessionSetting setting_of_button() {
  SessionSetting setting{.solids = cube_called("cube"), .feel_may_change = true};
  setting.solids[0].haptics.press_depth_m = 0.003;
  setting.hold_s = 0.5;  // longer than between two frames of these tests
  return setting;
}

/// Skin 1 mm below the cube's top, and at this depth.
std::vector<glm::vec3> fingertip(float depth_m) {
  std::vector<glm::vec3> skin;
  for (int n = 0; n < 49; ++n) {
    const glm::vec2 at(1e-3F * static_cast<float>(n % 7 - 3), 1e-3F * static_cast<float>(n / 7 - 3));
    skin.emplace_back(at.x, -1e-3F, at.y);
    if (depth_m > 1e-3F) skin.emplace_back(at.x, -depth_m, at.y);
  }
  return skin;
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
  std::string address = "127.0.0.1:" + std::to_string(test::free_udp_port());
  Session session{setting_of_button()};
  Moves moves;
  double time_s = 0;
  int sent = 0;

  void SetUp() override {
    try {
      check_osc();
    } catch (const Error& error) {
      GTEST_SKIP() << "skipped: " << error.what();
    }
  }
  /// Sends it, and a gain that says that it was looked at.
  void settle(const Osc& osc, const std::string& bytes) {
    UdpSender sender(address, "test", "");
    sender.send(bytes);
    const float mark = ++sent % 2 == 0 ? 0.5F : 0.25F;
    sender.send(message("/palpa/gain", {mark}));
    EXPECT_TRUE(test::begins([&] { return osc.gain() == double{mark}; }));
  }
  /// The voice of the next frame's finger.
  const array::Voice& felt(Osc& osc, float depth_m) {
    osc.before_frame(session);
    EXPECT_EQ(session.touch(fingertip(depth_m), time_s += 0.2).finger_count, 1U);
    return session.schedule().voices.at(0);
  }
};

TEST_F(OscTest, TheNewestValuesAreThereAtTheNextFrame) {
  Osc osc(address);
  UdpSender sender(address, "test", "");
  sender.send(message("/palpa/gain", {0.5F}));  // it waits until somebody listens
  EXPECT_EQ(osc.gain(), 1.0);
  osc.listen(session, moves);
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

TEST_F(OscTest, AGainMayBeZeroAndOneAndNothingBeyond) {
  Osc osc(address);
  osc.listen(session, moves);
  for (const float gain : {0.0F, 1.0F, std::nextafter(1.0F, 2.0F), -std::numeric_limits<float>::denorm_min()})
    settle(osc, message("/palpa/gain", {gain}));
  UdpSender sender(address, "test", "");
  sender.send(message("/palpa/gain", {0}));
  sender.send(message("/palpa/pose/cube", {0, 0, 0}));
  EXPECT_TRUE(test::begins([&] { return osc.before_frame(session), moves.count == 1; }));
  EXPECT_EQ(osc.gain(), 0.0);
  EXPECT_EQ(osc.end().refused, 2U);
}

TEST_F(OscTest, ASolidFeelsAsMessagesSay) {
  Osc osc(address);
  osc.listen(session, moves);
  EXPECT_EQ(felt(osc, 1e-3F).gain, 1);
  settle(osc, message("/palpa/stiffness/cube", {0, 0.25F}));
  EXPECT_NEAR(felt(osc, 1e-3F).gain, 0.5, 1e-6);
  settle(osc, message("/palpa/stiffness/cube", {0, 0, 0.002F, 1}));
  EXPECT_NEAR(felt(osc, 1e-3F).gain, std::sqrt(0.5), 1e-3);
  std::vector<float> longest;  // as many pairs as a table may have
  for (std::size_t row = 0; row < geometry::most_stiffness_rows; ++row)
    longest.insert(longest.end(), {1e-4F * static_cast<float>(row), 0.25F});
  settle(osc, message("/palpa/stiffness/cube", longest));
  EXPECT_NEAR(felt(osc, 1e-3F).gain, 0.5, 1e-6);
  settle(osc, message("/palpa/stiffness/cube", {0, 1}));
  settle(osc, message("/palpa/texture/cube", {0.25F, 0.75F, 0}));
  EXPECT_NEAR(felt(osc, 1e-3F).gain, 0.5, 1e-6) << "the steady part of a finger at rest";
  settle(osc, message("/palpa/texture/cube", {1, 0, 0}));
  EXPECT_EQ(felt(osc, 4e-3F).gain, 1);
  EXPECT_GT(felt(osc, 1e-3F).foci.size(), 1U);
  settle(osc, message("/palpa/click/cube", {1}));
  EXPECT_EQ(felt(osc, 4e-3F).modulation_hz, 200);
  settle(osc, message("/palpa/click/cube", {0.05F, 150}));
  EXPECT_EQ(felt(osc, 1e-3F).modulation_hz, 150);
  settle(osc, message("/palpa/click/cube", {0}));
  EXPECT_GT(felt(osc, 4e-3F).foci.size(), 1U);
  EXPECT_EQ(moves.count, 0);
  EXPECT_EQ(osc.end().refused, 0U);
}

TEST_F(OscTest, AFeelThatCannotBeIsRefusedAndChangesNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::pair<const char*, std::vector<float>> table[]{
      {"click", {}},
      {"click", {2}},
      {"click", {0.045F}},
      {"click", {0.02F, 200}},
      {"click", {0.045F, 250}},
      {"click", {nan, 200}},
      {"click", {0.045F, 200, 1}},
      {"stiffness", {}},
      {"stiffness", {0}},
      {"stiffness", {0, 1, 0.001F}},
      {"stiffness", {0, 2}},
      {"stiffness", {0, -0.1F}},
      {"stiffness", {0, nan}},
      {"stiffness", {2, 1}},
      {"stiffness", {0.002F, 1, 0.001F, 1}},
      {"stiffness", {0.002F, 1, 0.002F, 1}},
      {"stiffness", std::vector<float>(66, 0.1F)},
      {"texture", {}},
      {"texture", {1, 0}},
      {"texture", {0, 0, 0}},
      {"texture", {2, 0, 0}},
      {"texture", {1, -1, 0}},
      {"texture", {1, nan, 0}},
      {"texture", {1, 0, 0, 0}},
  };
  Osc osc(address);
  osc.listen(session, moves);
  for (const auto& [what, numbers] : table)
    settle(osc, message("/palpa/" + std::string(what) + "/cube", numbers));
  settle(osc, message("/palpa/texture/sphere", {0, 1, 1}));
  EXPECT_EQ(felt(osc, 1e-3F).gain, 1);
  EXPECT_GT(felt(osc, 4e-3F).foci.size(), 1U);
  // Without a press depth, nothing can click. That it does not is no fault.
  Session other{SessionSetting{.solids = cube_called("cube"), .feel_may_change = true}};
  session.exchange_scene(other);
  osc.set_scene(session);
  settle(osc, message("/palpa/click/cube", {1}));
  settle(osc, message("/palpa/click/cube", {0}));
  EXPECT_GT(felt(osc, 4e-3F).foci.size(), 1U);
  const MessageStats stats = osc.end();
  EXPECT_EQ(stats.refused, std::size(table) + 2);
  EXPECT_EQ(stats.taken, std::size(table) + 3 + 1);
}

TEST_F(OscTest, OfUnlikeSolidsEachTakesWhatItCanHave) {
  for (const std::string can : {"first", "second"}) {
    SessionSetting setting{.solids = cube_called("first"), .feel_may_change = true};
    setting.solids.push_back(cube_called("second").front());
    setting.solids[can == "first" ? 0 : 1].haptics.press_depth_m = 0.003;
    const Session unlike(setting);
    LiveValues values;
    values.set_scene(unlike);
    SolidValues clicks;
    clicks.feel.click.emplace();
    for (const std::string solid : {"first", "second"})
      EXPECT_EQ(values.change(solid, clicks).empty(), solid == can) << solid << " of " << can;
  }
}

TEST_F(OscTest, ClicksAndTexturesAreRefusedIfTheLinkCannotPlayThem) {
  SessionSetting slow = setting_of_button();
  slow.schedule.steady = true;
  const Session other(slow);
  Osc osc(address);
  osc.listen(other, moves);
  for (const auto& numbers : {std::vector<float>{1}, std::vector<float>{0}})
    settle(osc, message("/palpa/click/cube", numbers));
  for (const auto& weights : {std::vector<float>{1, 0, 1}, std::vector<float>{1, 0, 0}})
    settle(osc, message("/palpa/texture/cube", weights));
  settle(osc, message("/palpa/stiffness/cube", {0, 0.25F}));
  const MessageStats stats = osc.end();
  EXPECT_EQ(stats.refused, 2U);
  EXPECT_EQ(stats.taken, 3U + 5U) << "with the gains that settle it";
}

TEST_F(OscTest, EachReasonIsToldOnce) {
  const std::string said = test::stderr_of([&] {
    Osc osc(address);
    osc.listen(session, moves);
    for (int n = 0; n < 3; ++n) {
      settle(osc, message("/palpa/mute", {2}));
      settle(osc, message("/palpa/pose/sphere", {0, 0, 0}));
    }
    EXPECT_EQ(osc.end().refused, 6U);
  });
  const auto times = [&](const std::string& what) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = said.find(what, at)) != std::string::npos; ++at)
      ++count;
    return count;
  };
  EXPECT_EQ(times("a message is refused: /palpa/mute: give 1 or 0; "), 1U) << said;
  EXPECT_EQ(times("a message is refused: /palpa/pose/sphere: "), 1U) << said;
}

TEST_F(OscTest, OtherArgumentsAreNamedByTheirAddress) {
  for (const std::string types : {"[f]", "r", "c", "N", "I", "[]", "s", "b"}) {
    const std::string value = types == "N" || types == "I" || types == "[]" ? "" : std::string("\0\0\0\0", 4);
    const std::string said = test::stderr_of([&] {
      Osc osc(address);
      osc.listen(session, moves);
      settle(osc, padded("/palpa/mute") + padded("," + types) + value);
      EXPECT_EQ(osc.end().refused, 1U);
    });
    EXPECT_CONTAINS(said, "a message is refused: /palpa/mute: give 1 or 0; ") << types;
  }
  for (const std::string& broken : {std::string("/palpa/mute"), padded("/palpa/mute") + ",[f",
                                    padded("/palpa/mute") + padded(",[?]"), padded("/palpa/mute") + padded("[f]")}) {
    const std::string said = test::stderr_of([&] {
      Osc osc(address);
      osc.listen(session, moves);
      settle(osc, broken);
    });
    EXPECT_CONTAINS(said, "a datagram is no OSC message") << broken;
  }
}

TEST_F(OscTest, OnlyASessionThatExpectsItChangesItsFeel) {
  Session plain{SessionSetting{.solids = cube_called("cube")}};
  EXPECT_ERROR(plain.change_feel(0, {.click = geometry::Click()}), Exit::usage, "no feel_may_change");
}

TEST_F(OscTest, ValuesStayWhenTheSceneIsReadAgain) {
  Osc osc(address);
  osc.listen(session, moves);
  UdpSender sender(address, "test", "");
  sender.send(message("/palpa/pose/cube", {0, 0.01F, 0}));
  EXPECT_TRUE(test::begins([&] { return osc.before_frame(session), moves.count == 1; }));
  Session other{SessionSetting{.solids = cube_called("other")}}, again{SessionSetting{.solids = cube_called("cube")}};
  for (Session* next : {&other, &again}) {
    session.exchange_scene(*next);
    osc.set_scene(session);
    osc.before_frame(session);
    EXPECT_EQ(moves.count, next == &other ? 1 : 2);
  }
  EXPECT_NEAR(moves.poses[0][3].y, 0.01, 1e-9);
}

TEST_F(OscTest, AFloodBlocksNobody) {
  Osc osc(address);
  osc.listen(session, moves);
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
