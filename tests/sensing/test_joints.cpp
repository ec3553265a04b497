// Frames of trackers: how they are read, and which hands are in doubt.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sensing/joints/hand_check.hpp"
#include "sensing/joints/left_out.hpp"
#include "sensing/joints/read_frame.hpp"
#include "sensing/joints/tracker.hpp"
#include "sensing/recording.hpp"
#include "support/captured.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "support/tracked_hands.hpp"

namespace palpa::sensing {
namespace {

using nlohmann::json;

json own_frame() {
  TrackedHand left = test::pointing_hand({-0.1, 0, 0});
  left.left = true;
  return json::parse(test::line_of({1.25, {test::pointing_hand({0, 0.1, 0}), left}}));
}

/// The joints of one finger in Leap's millimetres, straight down.
json leap_pointable(int hand, int type) {
  const double x = 20 * type;
  return {{"handId", hand},
          {"type", type},
          {"width", 16},
          {"mcpPosition", {x, 200, 0}},
          {"pipPosition", {x, 160, 0}},
          {"dipPosition", {x, 135, 0}},
          {"tipPosition", {x, 110, 0}},
          {"tool", false}};
}
json leap_frame() {
  json frame{{"timestamp", 2'500'000},
             {"hands", {{{"id", 7}, {"type", "left"}, {"palmPosition", {50, 230, 0}}}}},
             {"pointables", json::array()}};
  for (int type = 0; type < 5; ++type)
    frame["pointables"].push_back(leap_pointable(7, type));
  return frame;
}

TEST(Joints, AreReadWithTimesPlacesAndRadii) {
  json given = own_frame();
  // A joint may have its orientation, too; what else a sender adds is not looked at.
  for (const double number : {0.0, 0.0, 0.0, 1.0})
    given["hands"][1]["joints"][10].push_back(number);
  given["confidence"] = 0.5;
  const TrackedFrame frame = read_frame(given.dump(), "it").value();
  EXPECT_EQ(frame.time_s, 1.25);
  ASSERT_EQ(frame.hands.size(), 2U);
  EXPECT_EQ(frame.hands[0], test::pointing_hand({0, 0.1, 0}));
  EXPECT_TRUE(frame.hands[1].left);
  EXPECT_EQ(frame.hands[1].joints[index_tip_joint], Vec3(-0.1, 0, 0));
  EXPECT_TRUE(read_frame(R"({"t_s": -3, "hands": []})", "it").value().hands.empty());
}

TEST(Joints, OfALeapAreReadInItsUnits) {
  const TrackedFrame frame = read_frame(leap_frame().dump(), "it").value();
  EXPECT_EQ(frame.time_s, 2.5);
  ASSERT_EQ(frame.hands.size(), 1U);
  const TrackedHand& hand = frame.hands.front();
  EXPECT_TRUE(hand.left);
  const auto near = [&](std::size_t joint, const Vec3& place) {
    EXPECT_LT(glm::distance(hand.joints[joint], place), 1e-12) << joint;
  };
  near(2, {0, 0.2, 0});        // the thumb's first joint is what Leap calls its mcp
  near(7, {0.02, 0.2, 0});     // an index finger's is its knuckle,
  near(10, {0.02, 0.118, 0});  // and the ball of a tip ends at the tip
  // The mean of the four knuckles is at x = 50, so the palm's centre is straight above it. Bones are twice as long.
  near(6, {0.02, 0.26, 0});
  for (const double radius_m : hand.radii_m)
    EXPECT_DOUBLE_EQ(radius_m, 8e-3);

  json newer = leap_frame();
  for (json& pointable : newer["pointables"]) {
    pointable["carpPosition"] = {pointable["type"].get<double>(), 250, 0};
    pointable["btipPosition"] = {20 * pointable["type"].get<double>(), 112, 0};
  }
  newer["hands"][0]["wrist"] = {50, 270, 0};
  newer["pointables"].push_back({{"handId", 7}, {"tool", true}});
  newer["pointables"].push_back(leap_pointable(8, 1));
  const TrackedHand more = read_frame(newer.dump(), "it").value().hands.at(0);
  EXPECT_LT(glm::distance(more.joints[6], Vec3(1e-3, 0.25, 0)), 1e-12);
  EXPECT_LT(glm::distance(more.joints[10], Vec3(0.02, 0.12, 0)), 1e-12);
  EXPECT_LT(glm::distance(more.joints[wrist_joint], Vec3(0.05, 0.27, 0)), 1e-12);

  // What the service says besides its frames.
  EXPECT_FALSE(read_frame(R"({"serviceVersion": "2.3.1", "version": 6})", "it"));
  EXPECT_FALSE(read_frame(R"({"event": {"type": "deviceEvent", "state": {}}})", "it"));
}

TEST(Joints, RefuseWhatIsNoFrame) {
  using Change = std::function<void(json&)>;
  const auto own = [](const Change& change) {
    json frame = own_frame();
    change(frame);
    return frame.dump();
  };
  const auto leap = [](const Change& change) {
    json frame = leap_frame();
    change(frame);
    return frame.dump();
  };
  const std::pair<std::string, const char*> table[]{
      {"", "syntax error"},
      {"right 0 0 0", "syntax error"},
      {std::string("\x00\xff\x01", 3), "syntax error"},
      {"[1, 2]", "not a JSON object"},
      {std::string(60000, '['), "nested"},
      {R"({"t_s": NaN, "hands": []})", "syntax error"},
      {R"({"t_s": 1e999, "hands": []})", "out of range"},
      {R"({"t_s": 1e300, "hands": []})", "no time in seconds"},
      {R"({"t_s": "1", "hands": []})", "\"t_s\" is not a finite number"},
      {"{}", "neither \"t_s\""},
      {R"({"t_s": 1})", "\"hands\" is missing"},
      {R"({"t_s": 1, "hands": {}})", "\"hands\" is not an array"},
      {R"({"t_s": 1, "hands": [1]})", "hand 0: is not a JSON object"},
      {own([](json& f) { f["hands"][0].erase("hand"); }), "\"left\" or \"right\""},
      {own([](json& f) { f["hands"][0]["hand"] = "both"; }), "\"left\" or \"right\""},
      {own([](json& f) { f["hands"][1]["joints"].erase(0); }), "hand 1: has 25 joints"},
      {own([](json& f) {
         f["hands"][0]["joints"][3] = {1, 2};
       }),
       "joint 3 must be"},
      {own([](json& f) { f["hands"][0]["joints"][3][1] = nullptr; }), "joint 3 must be"},
      {own([](json& f) { f["hands"][0].erase("radii"); }), "\"radii\" is missing"},
      {own([](json& f) { f["hands"][0]["radii"].push_back(1); }), "\"radii\" has 27 values"},
      {own([](json& f) { f["hands"][0]["radii"][2] = "8mm"; }), "not a number"},
      {R"({"version": 7})", "version 7"},
      {leap([](json& f) { f["timestamp"] = 1e300; }), "no time"},
      {leap([](json& f) { f.erase("pointables"); }), "\"pointables\" is missing"},
      {leap([](json& f) { f["pointables"].erase(2); }), "not all five fingers"},
      {leap([](json& f) { f["pointables"][0]["type"] = 5; }), "\"type\" is 5"},
      {leap([](json& f) { f["pointables"][0].erase("tipPosition"); }), "\"tipPosition\" is missing"},
      {leap([](json& f) { f["hands"][0].erase("palmPosition"); }), "\"palmPosition\" is missing"},
  };
  for (const auto& each : table)
    EXPECT_REFUSED(read_frame(each.first, "it"), each.second) << each.first.substr(0, 100);
}

/// The doubt about one frame after others of the same hand, 10 ms apart.
struct Frames {
  HandCheck check;
  double time_s = 10, arrived_s = 50;
  std::optional<HandDoubt> see(std::vector<TrackedHand> hands, double later_s = 0.01) {
    return see(std::move(hands), later_s, later_s);
  }
  /// `later_s` on the tracker's clock, `passed_s` on palpa's.
  std::optional<HandDoubt> see(std::vector<TrackedHand> hands, double later_s, double passed_s) {
    TrackedFrame frame{time_s += later_s, std::move(hands)};
    const std::optional<HandDoubt> doubt = check.check(frame, arrived_s += passed_s);
    left = frame.hands.size();
    return doubt;
  }
  std::size_t left = 0;  ///< hands of the last frame that are not in doubt
};

TEST(Joints, InDoubtGiveNoHand) {
  const TrackedHand hand = test::pointing_hand({0, 0.1, 0});
  TrackedHand other = test::pointing_hand({0.2, 0.1, 0});
  other.left = true;
  const auto changed = [&](const std::function<void(TrackedHand&)>& change) {
    TrackedHand odd = hand;
    change(odd);
    return odd;
  };
  Frames frames;
  EXPECT_EQ(frames.see({hand, other}), std::nullopt);
  EXPECT_EQ(frames.left, 2U);
  EXPECT_EQ(frames.see({hand, other, hand}), HandDoubt::crowd);
  EXPECT_EQ(frames.left, 0U);
  EXPECT_EQ(frames.see({hand, hand}), HandDoubt::crowd);
  EXPECT_EQ(frames.left, 0U);
  const std::pair<TrackedHand, HandDoubt> table[]{
      {changed([](TrackedHand& h) { h.joints[4].z = 10.1; }), HandDoubt::far},
      {changed([](TrackedHand& h) { h.joints[4] *= 1e3; }), HandDoubt::far},
      {changed([](TrackedHand& h) { h.radii_m[4] = 0; }), HandDoubt::radius},
      {changed([](TrackedHand& h) { h.joints.fill(Vec3(0)); }), HandDoubt::size},
      {changed([](TrackedHand& h) { h.joints[10].y -= 0.14; }), HandDoubt::shape},
  };
  for (const auto& [odd, doubt] : table) {
    EXPECT_EQ(frames.see({odd, other}), doubt) << to_text(doubt);
    EXPECT_EQ(frames.left, 1U) << "the other hand";
  }
}

TEST(Joints, ThatJumpGiveNoHandForAFrame) {
  Frames frames;
  const auto at = [](double x) { return std::vector{test::pointing_hand({x, 0.1, 0})}; };
  frames.see(at(0));
  EXPECT_EQ(frames.see(at(0.049)), std::nullopt);
  EXPECT_EQ(frames.see(at(0.1)), HandDoubt::jump);
  EXPECT_EQ(frames.left, 0U);
  EXPECT_EQ(frames.see(at(0.1001)), std::nullopt) << "there it stays";
  // A hand that was away may be anywhere.
  EXPECT_EQ(frames.see({}), std::nullopt);
  EXPECT_EQ(frames.see(at(0.5), 0.3), std::nullopt);
}

TEST(Joints, ThatDoNotMoveByABitGiveNoHand) {
  Frames frames;
  const TrackedHand hand = test::pointing_hand({0, 0.1, 0});
  for (int i = 0; i < 25; ++i)
    EXPECT_EQ(frames.see({hand}), std::nullopt) << i;
  frames.see({hand}, 0.005);
  EXPECT_EQ(frames.see({hand}), HandDoubt::frozen);
  TrackedHand moved = hand;
  moved.joints[0].x += 1e-9;
  EXPECT_EQ(frames.see({moved}), std::nullopt);
  EXPECT_EQ(frames.see({moved}, 0.33), HandDoubt::frozen) << "three frames a second";
  EXPECT_EQ(frames.see({}, 5), std::nullopt);
  EXPECT_EQ(frames.see({moved}), HandDoubt::frozen) << "it was away, and comes back to the bit";
  frames = Frames();
  frames.see({hand});
  EXPECT_EQ(frames.see({hand}, 0.01, 0.3), HandDoubt::frozen) << "palpa's clock counts";
  frames = Frames();
  frames.see({hand});
  TrackedHand thicker = hand;
  thicker.radii_m[0] += 1e-5;
  EXPECT_EQ(frames.see({thicker}, 0.3), HandDoubt::frozen) << "a radius is no movement";
}

TEST(Joints, ThatChangeTheirSideGiveNoHandForAWhile) {
  const auto at = [](double x, bool left) {
    TrackedHand hand = test::pointing_hand({x, 0.1, 0});
    hand.left = left;
    return hand;
  };
  // A tracker that takes a hand for a left and a right one in turn, 30 mm beside it; in the second case, it loses it
  // between.
  for (const int lost : {0, 3}) {
    Frames frames;
    std::size_t hands = 0;
    for (int i = 0; i < 200; ++i) {
      const bool left = i / (lost + 1) % 2 == 1;
      const bool seen = i % (lost + 1) == 0;
      frames.see(seen ? std::vector{at(left ? 0.03 : 1e-6 * i, left)} : std::vector<TrackedHand>());
      hands += frames.left;
    }
    EXPECT_EQ(hands, 1U) << "the first";
  }
  Frames frames;
  frames.see({at(0, false)});
  EXPECT_EQ(frames.see({at(0, true)}), HandDoubt::side);
  EXPECT_EQ(frames.see({at(0.001, true)}, 0.2), HandDoubt::side);
  EXPECT_EQ(frames.see({at(0.002, true)}, 0.1), std::nullopt) << "it stays";

  // One hand after the other, elsewhere; a second one that comes, and the first that goes.
  frames = Frames();
  frames.see({at(0, false)});
  frames.see({});
  EXPECT_EQ(frames.see({at(0.3, true)}), std::nullopt);
  EXPECT_EQ(frames.see({at(0.3001, true), at(0, false)}), std::nullopt);
  EXPECT_EQ(frames.see({at(0.0001, false)}), std::nullopt);
}

/// How many of 300 frames, 10 ms apart, have a hand, of a tracker whose clock runs on by `later_s` from each to the
/// next.
int with_a_hand(const std::function<double(int)>& later_s) {
  Frames frames;
  int hands = 0;
  for (int i = 0; i < 300; ++i) {
    frames.see({test::pointing_hand({1e-3 * i, 0.1, 0})}, later_s(i), 0.01);
    hands += static_cast<int>(frames.left);
  }
  return hands;
}

TEST(Joints, OfAClockThatDoesNotRunInSecondsGiveNoHand) {
  const auto running = [](double times) { return [=](int) { return 0.01 * times; }; };
  EXPECT_EQ(with_a_hand(running(1)), 300);
  EXPECT_EQ(with_a_hand(running(1.0001)), 300);
  EXPECT_EQ(with_a_hand([](int i) { return i == 0 ? 0 : i == 1 ? 5.0 : 0.01; }), 300) << "a frame that waited";
  EXPECT_EQ(with_a_hand([](int i) { return i % 50 == 0 ? 0.451 : 0.001; }), 300) << "delays that grow and end";
  EXPECT_LE(with_a_hand(running(1000)), 2) << "milliseconds";
  EXPECT_LE(with_a_hand(running(1e6)), 2) << "microseconds";
  EXPECT_LE(with_a_hand(running(30)), 5) << "the frame's number at 30 Hz";
  EXPECT_LE(with_a_hand([](int) { return -2.0; }), 2) << "it starts again with each frame";
  EXPECT_LE(with_a_hand([](int i) { return i % 2 == 0 ? 100.01 : -99.99; }), 2) << "two trackers";
  // It was started again: after a second, it is trusted.
  EXPECT_NEAR(with_a_hand([](int i) { return i == 50 ? -50 : 0.01; }), 200, 1);
}

class JointsFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) const {
    test::write_text(file_, text);
    return file_;
  }
  std::filesystem::path file_ = test::scratch_folder("joints") / "hand.jsonl";
};

TEST_F(JointsFile, GivesItsFramesOneAfterTheOther) {
  std::vector<TrackedFrame> given;
  for (int i = 0; i < 5; ++i)
    given.push_back({0.01 * i, {test::pointing_hand({0.001 * i, 0.1, 0})}});
  given[2].hands.clear();
  const auto tracker = open_tracker(write("\xEF\xBB\xBF" + test::lines_of(given) + "\n\r\n"), false);
  TrackedFrame frame;
  bool came = false;
  std::uint64_t number = 99;
  for (std::size_t i = 0; i < given.size(); ++i) {
    ASSERT_TRUE(tracker->next(frame, came, number, 0));
    EXPECT_TRUE(came);
    EXPECT_EQ(number, i);
    EXPECT_EQ(frame.time_s, given[i].time_s);
    EXPECT_EQ(frame.hands, given[i].hands);
  }
  EXPECT_FALSE(tracker->next(frame, came, number, 0));
}

TEST_F(JointsFile, AtItsTimesGivesTheNewestFrame) {
  std::vector<TrackedFrame> given;
  for (int i = 0; i < 4; ++i)
    given.push_back({i < 3 ? 1e-6 * i : 60.0, {}});
  const auto tracker = open_tracker(write(test::lines_of(given)), true);
  TrackedFrame frame;
  bool came = false;
  std::uint64_t number = 0;
  ASSERT_TRUE(tracker->next(frame, came, number, 0));
  EXPECT_TRUE(came);
  while (number < 2) {
    ASSERT_TRUE(tracker->next(frame, came, number, 0));
  }
  ASSERT_TRUE(tracker->next(frame, came, number, 0.001));
  EXPECT_FALSE(came) << "it is a minute away";
}

TEST_F(JointsFile, TellsOnceOfHandsInDoubtAndCountsThem) {
  std::vector<TrackedFrame> given;
  for (int i = 0; i < 3; ++i) {
    given.push_back({0.01 * i, {test::pointing_hand({0.001 * i, 0.1, 0})}});
    given.back().hands[0].radii_m[3] = 0.5;
  }
  const std::filesystem::path file = write(test::lines_of(given));
  const std::string said = test::stderr_of([&] {
    const auto tracker = open_tracker(file, false);
    TrackedFrame frame;
    bool came = false;
    std::uint64_t number = 0;
    while (tracker->next(frame, came, number, 0))
      EXPECT_TRUE(frame.hands.empty());
  });
  const std::string kind =
      "a hand with a radius outside of 3 to 40 mm (3 to 25 mm at fingers), or far from those of its other fingers\n";
  EXPECT_EQ(said, "palpa: warning: joints:" + file.string() + ": palpa leaves out " + kind +
                      "palpa: warning: joints:" + file.string() + ": 3 times, palpa left out " + kind);
}

TEST(LeftOut, TellsEachReasonOnce) {
  const std::string said = test::stderr_of([] {
    LeftOut left_out("it");
    for (const char* why : {"one", "two", "one", "two"})
      left_out.add("a datagram that is no frame", why);
  });
  const std::string warning = "palpa: warning: it: ", kind = "a datagram that is no frame";
  EXPECT_EQ(said, warning + "palpa leaves out " + kind + ": one\n" + warning + "palpa leaves out " + kind + ": two\n" +
                      warning + "4 times, palpa left out " + kind + "\n");
}

TEST_F(JointsFile, MayEndWithinALine) {
  const std::string whole = test::line_of({1, {test::pointing_hand({0, 0.1, 0})}}) + "\n";
  const std::string next = test::line_of({1.01, {test::pointing_hand({0, 0.1, 0})}});
  for (const std::size_t length : {std::size_t{1}, next.size() / 2, next.size() - 1, next.size()}) {
    const std::filesystem::path file = write(whole + next.substr(0, length));
    int frames = 0;
    const std::string said = test::stderr_of([&] {
      const auto tracker = open_tracker(file, false);
      TrackedFrame frame;
      bool came = false;
      std::uint64_t number = 0;
      while (tracker->next(frame, came, number, 0))
        ++frames;
    });
    EXPECT_EQ(frames, length == next.size() ? 2 : 1);
    EXPECT_EQ(said, length == next.size() ? ""
                                          : "palpa: warning: " + file.string() +
                                                ": line 2: it has no end, and is no whole frame; it is left out\n");
  }
  EXPECT_REFUSED(open_tracker(write(next.substr(0, 40)), true), "line 1");
  EXPECT_REFUSED(open_tracker(write(whole + next.substr(0, 40) + "\n"), true), "line 2");
}

TEST_F(JointsFile, WhoseTimesAreNoSecondsIsWarnedOf) {
  const auto said = [&](std::initializer_list<double> times_s) {
    std::vector<TrackedFrame> given;
    for (const double time_s : times_s)
      given.push_back({time_s, {}});
    const std::filesystem::path file = write(test::lines_of(given));
    return test::stderr_of([&] { open_tracker(file, false); });
  };
  EXPECT_CONTAINS(
      said({0, 16.67, 33.33, 50}),
      "its frames are 16.7 s apart; if the times are in another unit, convert them: they must be in seconds");
  EXPECT_CONTAINS(said({0, 1, 2, 3}), "its frames are 1 s apart; if the times are frame numbers, convert them");
  EXPECT_EQ(said({0, 0.01667, 0.03333, 60}), "");
}

TEST_F(JointsFile, IsNoRecordingOfCameras) {
  const std::filesystem::path file = write(test::line_of({1, {}}) + "\n");
  EXPECT_REFUSED(load_recording(file), "if they are hands, give joints:" + file.string());
  EXPECT_REFUSED(load_recording(write("#ROSBAG V2.0\nE")), "give it as bag:" + file.string());
}

TEST_F(JointsFile, IsRefusedWithTheLine) {
  const std::string good = test::line_of({1, {}});
  const std::pair<std::string, const char*> table[]{
      {good + "\n" + good, "line 2: its time, 1 s, is not after the one before, 1 s"},
      {good + "\nhand", "line 2: its JSON has a syntax error"},
      {"\n\n{\"version\": 6}\n", "has no frame"},
      {"{\"version\": 5}\n" + good, "line 1: the frame: is of version 5"},
  };
  for (const auto& each : table)
    EXPECT_REFUSED(open_tracker(write(each.first), true), each.second);
  EXPECT_REFUSED(open_tracker(file_.string() + ".none", true), "hand.jsonl.none");
  EXPECT_ERROR(open_tracker("", true), Exit::usage, "joints:udp:9000");
}

}  // namespace
}  // namespace palpa::sensing
