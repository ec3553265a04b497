// A session in the background of the viewer: it is observed without waiting, and ends in silence.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <glm/ext/matrix_transform.hpp>
#include <memory>
#include <thread>
#include <vector>

#include "array/drive.hpp"
#include "geometry/gltf/write.hpp"
#include "heard_link.hpp"
#include "session/forward_clock.hpp"
#include "session/links/sources.hpp"
#include "session/threads.hpp"
#include "support/begins.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "viewer/live/live_picture.hpp"
#include "viewer/live/live_session.hpp"
#include "viewer/live/next_outputs.hpp"
#include "viewer/live/starter.hpp"
#include "viewer/picture/world_marks.hpp"
#include "viewer/run/drawing_threads.hpp"

namespace palpa::viewer {
namespace {

using namespace std::chrono_literals;

struct Bench {
  std::shared_ptr<test::HeardSound> heard = std::make_shared<test::HeardSound>();
  std::atomic<bool> stop{false};
  std::atomic<int> woken{0};
  std::uint64_t frames = 0;  ///< number of frames after which it ends by itself
  double hurry = 1;          ///< how many times as often as usual its finger dips
  std::string recording;     ///< the frames, each of them, instead of a finger

  std::unique_ptr<LiveSession> start(Patience patience = {}) {
    LiveSession::Kinds kinds;
    kinds.links.push_back(test::heard_link(heard));
    setup::LiveOptions options = test::heard_options(frames);
    if (hurry != 1) {
      const auto dips = [times = hurry](double time_s) { return sensing::dipping_motion(times * time_s); };
      kinds.sources.push_back(session::synthetic_source("hasty", "", dips));
      options.source = "hasty";
    }
    if (!recording.empty()) {
      options.source = "recording:" + recording;
      options.every_frame = true;
    }
    return std::make_unique<LiveSession>(
        std::move(options), std::move(kinds), stop, [this] { ++woken; }, patience);
  }
  bool sounded() { return heard->sounded(); }
  /// Some frames more, with nobody looking.
  bool plans_more() {
    const std::uint64_t before = heard->plans;
    return test::begins([&] { return heard->plans > before + 3; });
  }
};

bool soon(LiveSession& live, const std::function<bool()>& condition) {
  return test::begins([&] {
    if (condition()) return true;
    live.look();
    return false;
  });
}
bool is_over(LiveSession& live) {
  return soon(live, [&] { return live.over(); });
}
bool runs(LiveSession& live) {
  return soon(live, [&] { return live.state() == LiveState::running; });
}

/// Whether it ends although nobody looks.
bool ends_unattended(LiveSession& live) {
  return test::begins([&] {
    live.take();  // it counts as starting until it has taken ten snapshots
    return live.over();
  });
}

TEST(Live, IsLookedAtAndFallsSilentWhenItIsSwitchedOff) {
  Bench bench;
  const auto live = bench.start();
  bool touched = false;
  ASSERT_TRUE(soon(*live, [&] {
    if (live->take()) touched = live->snapshot().touch.finger_count > 0;
    live->take_seen();
    return touched && bench.sounded() && !live->seen().skin.points.empty();
  })) << live->fault();
  EXPECT_EQ(live->state(), LiveState::running);
  EXPECT_GT(bench.woken, 0);
  EXPECT_GT(live->snapshot().numbers.frames, 0u);
  EXPECT_FALSE(live->snapshot().touch.contacts.empty()) << "contacts come even though nobody asked for events";

  Picture picture = live->scene()->picture;
  EXPECT_EQ(picture.solids.size(), 1u);
  EXPECT_EQ(picture.transducers.size(), 249u);
  show_live(picture, *live->scene(), live->snapshot(), live->seen(), true);
  EXPECT_EQ(picture.contacts.size(), live->snapshot().touch.contacts.size());
  EXPECT_FALSE(picture.images.empty());

  live->all_off();
  ASSERT_TRUE(is_over(*live));
  EXPECT_EQ(live->state(), LiveState::ended);
  EXPECT_EQ(live->fault(), "");
  EXPECT_TRUE(bench.heard->finished);
  EXPECT_FALSE(bench.heard->last_sounds);
  EXPECT_FALSE(live->link().sound.sounding());
  EXPECT_EQ(live->link().drives, bench.heard->drives);
  EXPECT_EQ(live->link().drives - live->link().silent, bench.heard->sounding);
  const auto stats = live->stats();
  ASSERT_TRUE(stats);
  ASSERT_TRUE(stats->output.hand_over.behind) << "what the link knows of its device reaches the run's statistics";
  EXPECT_EQ(stats->output.hand_over.behind->completed.drives, bench.heard->sounding);
  EXPECT_EQ(stats->output.hand_over.lost(), 0u);
}

TEST(Live, PointsThatAreNoSkinAreShownApart) {
  LiveScene scene;
  Snapshot snapshot;
  Seen seen;
  seen.skin.points = {{{0, 0, 0}, 1}, {{1e-3F, 0, 0}, 2}};
  seen.skin.leavings = {{{0, -0.15F, 0}, 3}, {{1e-3F, -0.15F, 0}, 4}, {{2e-3F, -0.15F, 0}, 5}};
  Picture picture;
  show_live(picture, scene, snapshot, seen, false);
  EXPECT_EQ(picture.skin_points.size(), 2U);
  EXPECT_EQ(picture.skin_count, 2U);
  ASSERT_EQ(picture.dropped_points.size(), 3U);
  EXPECT_EQ(picture.dropped_points[1], glm::vec3(1e-3F, -0.15F, 0));
  EXPECT_EQ(picture.dropped_count, 3U);
  seen.skin.leavings.clear();
  show_live(picture, scene, snapshot, seen, false);
  EXPECT_TRUE(picture.dropped_points.empty());
  EXPECT_EQ(picture.dropped_count, 0U);
}

TEST(Live, WhoDrawsIsKeptOutOfItsFramesWay) {
  Bench bench;
  const auto live = bench.start();
  double waited_s = 0;
  ASSERT_TRUE(soon(*live, [&] {
    waited_s += live->let_run(5e-3, 0.1);
    return waited_s > 0.02 && live->state() == LiveState::running;
  })) << live->fault();
  live->all_off();
  ASSERT_TRUE(is_over(*live));
  EXPECT_LT(live->let_run(1e-3, 60), 60) << "no more frames come";
}

TEST(Live, ASolidThatIsMovedIsFeltWhereItIs) {
  Bench bench;
  bench.hurry = 4;
  const auto live = bench.start();
  const auto touches = [&] { return live->take() && live->snapshot().touch.finger_count > 0; };
  ASSERT_TRUE(soon(*live, touches)) << live->fault();
  const std::vector<Transform> away{glm::translate(Transform(1.0), Vec3(0, -0.1, 0))};
  live->place(away);
  const auto silent_for_a_period = [&, since = std::chrono::steady_clock::time_point()]() mutable {
    const auto now = std::chrono::steady_clock::now();
    if (since == std::chrono::steady_clock::time_point() || touches()) since = now;
    return now - since > 750ms;  // the finger dips every half second
  };
  ASSERT_TRUE(soon(*live, silent_for_a_period));
  live->place({glm::translate(Transform(1.0), Vec3(0, 0.003, 0))});
  ASSERT_TRUE(soon(*live, touches));
  EXPECT_GT(live->snapshot().touch.fingers[0].depth_m, 0);

  const auto folder = test::scratch_folder("viewer-moved");
  geometry::write_glb(folder / "moved.glb", meshes_of(*live->scene(), away));
  const std::vector<geometry::Solid> solids = geometry::make_solids(geometry::load_gltf(folder / "moved.glb"));
  ASSERT_EQ(solids.size(), 1u);
  EXPECT_NEAR(solids[0].bounds.high.y, -0.1, 1e-7);
}

TEST(Live, PartsOfAMovedSolidAreWrittenWhereItIs) {
  const geometry::Mesh box = test::box(Vec3(0), Vec3(0.01));
  LiveScene scene;
  scene.solid_names = {"one of two parts", "whole", "one of three"};
  std::vector<std::uint32_t> solids{0, 0, 1, 2, 2, 2};
  for (const std::uint32_t solid : solids) {
    scene.meshes.push_back({scene.solid_names[solid], box, {}, {}, {}});
    scene.picture.solids.push_back({.name = scene.solid_names[solid], .mesh = box, .solid = solid});
  }
  std::vector<Transform> poses;
  for (const double y : {-0.1, 0.2, 0.3})
    poses.push_back(glm::translate(Transform(1.0), Vec3(0, y, 0)));
  const std::vector<geometry::SceneMesh> moved = meshes_of(scene, poses);
  ASSERT_EQ(moved.size(), solids.size());
  for (std::size_t i = 0; i < moved.size(); ++i)
    EXPECT_NEAR(geometry::bounds(moved[i].mesh).low.y, poses[solids[i]][3].y, 1e-12) << "mesh " << i;
  poses.pop_back();
  EXPECT_EQ(geometry::bounds(meshes_of(scene, poses).back().mesh).low.y, 0) << "a solid that nobody moved";
}

TEST(Live, RecordsWhileItRunsAndToItsEnd) {
  Bench bench;
  const auto folder = test::scratch_folder("viewer-recorded");
  auto live = bench.start();
  ASSERT_TRUE(runs(*live)) << live->fault();
  const std::string taken = (folder / "taken").string(), made = (folder / "made").string();
  std::filesystem::create_directories(std::filesystem::path(taken) / "something");
  live->record(taken);  // this is reported, and ends nothing
  std::uint64_t frames = 0;
  ASSERT_TRUE(soon(*live, [&] { return live->take() && (frames += 1) > 10; }));
  EXPECT_EQ(live->recorded(), 0u);
  EXPECT_EQ(live->state(), LiveState::running);
  live->record(made);
  ASSERT_TRUE(soon(*live, [&] { return live->recorded() >= 5; })) << live->fault();
  EXPECT_EQ(live->recording(), made);
  live->record({});
  ASSERT_TRUE(soon(*live, [&] { return live->recording().empty(); }));
  EXPECT_EQ(live->state(), LiveState::running);
  const sensing::Recording recording = sensing::load_recording(made);
  EXPECT_GE(recording.entries.size(), 5u);
  EXPECT_EQ(recording.cameras.size(), live->scene()->cameras.size());

  const std::string whole = (folder / "whole").string();
  live.reset();
  bench.stop = false;
  bench.frames = 60;
  live = bench.start();
  live->record(whole);
  ASSERT_TRUE(is_over(*live));
  EXPECT_EQ(live->fault(), "");
  EXPECT_EQ(live->recording(), "") << "nothing is written any more";
  EXPECT_GT(live->recorded(), 0u);
  EXPECT_EQ(sensing::load_recording(whole).entries.size(), live->recorded());
}

TEST(Live, CountsTheFramesThatItsSourceLeftOut) {
  const auto folder = test::scratch_folder("viewer-gaps") / "take";
  std::filesystem::copy(test::source_file("assets/depth/take"), folder);
  std::string times = test::read_text(folder / "times.csv");
  for (const char* gone : {"\n1,", "\n3,", "\n4,"}) {
    const std::size_t at = times.find(gone);
    times.erase(at, times.find('\n', at + 1) - at);
  }
  test::write_text(folder / "times.csv", times);
  Bench bench;
  bench.recording = folder;
  // It may be over before a busy machine looks at its last snapshot.
  std::uint64_t dropped = 0;
  for (int again = 0; again < 10 && dropped < 3; ++again) {
    bench.stop = false;
    const auto live = bench.start();
    ASSERT_TRUE(soon(*live, [&] {
      live->take();
      dropped = live->snapshot().numbers.dropped;
      return dropped >= 3 || live->over();
    })) << live->fault();
  }
  EXPECT_EQ(dropped, 3u);
}

TEST(Live, EndsWithTheViewer) {
  Bench bench;
  {
    const auto live = bench.start();
    ASSERT_TRUE(soon(*live, [&] { return bench.sounded(); })) << live->fault();
  }  // as if drawing had thrown
  EXPECT_TRUE(bench.heard->finished);
  EXPECT_FALSE(bench.heard->last_sounds);
}

TEST(Live, AViewerThatNoLongerLooksLeavesSilence) {
  Bench bench;
  test::ForwardClock clock;
  const auto live = bench.start({.usual = 500s, .clock = &clock});
  int taken = 0;
  ASSERT_TRUE(soon(*live, [&] {
    taken += live->take() ? 1 : 0;
    return taken >= 10 && bench.sounded();
  })) << live->fault();
  clock.forward(300);
  EXPECT_TRUE(bench.plans_more());
  EXPECT_FALSE(bench.stop);
  clock.forward(201);
  EXPECT_TRUE(ends_unattended(*live));
  EXPECT_FALSE(bench.heard->last_sounds);
}

TEST(Live, AViewerThatHasDrawnLittleMayTakeLonger) {
  Bench bench;
  test::ForwardClock clock;
  const auto live = bench.start({.usual = 1ms, .beginning = 500s, .clock = &clock});
  int taken = 0;
  ASSERT_TRUE(soon(*live, [&] {
    if (taken < 9) taken += live->take() ? 1 : 0;
    return taken == 9 && bench.sounded();
  })) << live->fault();
  clock.forward(300);  // a driver may still compile, so it is to wait
  EXPECT_TRUE(bench.plans_more());
  EXPECT_FALSE(bench.stop);
  EXPECT_TRUE(ends_unattended(*live));
  EXPECT_FALSE(bench.heard->last_sounds);
}

TEST(Live, AViewerThatNeverBeginsLeavesSilence) {
  Bench bench;
  const auto live = bench.start({.beginning = 1ms});
  EXPECT_TRUE(ends_unattended(*live));
  EXPECT_TRUE(bench.stop);
  EXPECT_FALSE(bench.heard->last_sounds);
}

/// The first of two fingers is expected to have left when its foci would sound.
TEST(Live, FociAheadOfAFingerAreShownWithThePlaceWhereTheyWereSeen) {
  LiveScene scene;
  Snapshot snapshot;
  snapshot.touch.finger_count = 2;
  snapshot.touch.fingers.resize(2);
  for (std::uint32_t f = 0; f < 2; ++f) {
    touch::Finger& finger = snapshot.touch.fingers[f];
    finger.id = 7 + f;
    finger.placed = true;
    finger.foci.resize(3);
    for (int n = 0; n < 3; ++n)
      finger.foci[n] = {.position = glm::vec3(n, n * n, f), .points = 1};
  }
  array::Voice& voice = snapshot.plan.schedule.add_voice();
  voice.id = 8;
  voice.velocity = {0.2, 0, 0};
  voice.order = {0, 1, 2};
  for (int n = 0; n < 3; ++n)
    voice.foci.emplace_back(n + 0.5, n * n, 1);
  Picture picture;
  show_live(picture, scene, snapshot, {}, false);
  ASSERT_EQ(picture.fingers.size(), 2U);
  EXPECT_TRUE(picture.fingers[0].foci.empty()) << "it is silent";
  ASSERT_EQ(picture.fingers[1].foci.size(), 3U);
  ASSERT_EQ(picture.fingers[1].seen.size(), 3U);
  for (int n = 0; n < 3; ++n) {
    EXPECT_EQ(picture.fingers[1].foci[n].position, glm::vec3(n + 0.5F, n * n, 1));
    EXPECT_EQ(picture.fingers[1].seen[n], glm::vec3(n, n * n, 1));
  }
  ViewState state;
  WorldMarks with, without;
  build_marks(picture, state, {}, with);
  picture.fingers[1].seen.clear();
  build_marks(picture, state, {}, without);
  EXPECT_EQ(with.lines.size(), without.lines.size() + 4) << "an outline, and the way";
}

/// Two fingers whose dwells differ by a microsecond: the output computes each slot, and so does the display.
TEST(Live, AScheduleTooLongToBeListedIsShownAndHeard) {
  auto scene = std::make_shared<LiveScene>();
  scene->layout = array::load_layout("openmpd");
  Snapshot snapshot;
  array::Schedule& schedule = snapshot.plan.schedule;
  for (const double dwell : {1.5e-3, 1.501e-3}) {
    array::Voice& voice = schedule.add_voice();
    voice.foci = {{0, 0, 0.1}, {5e-3, dwell, 0.1}};
    voice.order = {0, 1};
    voice.dwell_s = dwell;
  }
  session::SlotWork work;
  array::SlotDrives drives;
  session::drive_on_host(snapshot.plan, scene->layout, scene->drive, work, nullptr, drives);
  ASSERT_EQ(snapshot.plan.cycle.plays, session::Plays::slot_by_slot);

  Picture picture;
  picture.transducers.resize(scene->layout.transducers.size());
  session::SlotScratch scratch;
  show_live_slot(picture, *scene, snapshot, 1, scratch);
  EXPECT_TRUE(picture.driven);
  const auto drive = drive_of(*scene, snapshot.plan, 1, scratch);
  std::vector<array::SlotFocus> foci;
  array::foci_of_slot(schedule, 1, foci);
  const array::Drive expected = array::drive_for(scene->layout, foci, scene->drive);
  ASSERT_EQ(drive.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    ASSERT_TRUE(drive[i].phase == expected[i].phase && drive[i].amplitude == expected[i].amplitude) << i;
  const Sounding sounding = sounding_of(scene, snapshot);
  EXPECT_EQ(sounding.schedule, &schedule);
  EXPECT_EQ(sounding.plan, &snapshot.plan);

  snapshot.plan.cycle = {session::Plays::pattern, 1};
  snapshot.plan.drives.resize(2);
  show_live_slot(picture, *scene, snapshot, 0, scratch);
  EXPECT_FALSE(picture.driven) << "a snapshot of another array drives nothing";
}

TEST(Starter, DoesNotGiveWayWithItsMaker) {
  const auto niceness = [] { return getpriority(PRIO_PROCESS, static_cast<id_t>(gettid())); };
  const int before = niceness();
  int maker = 0, started = 0;
  std::thread([&] {
    Starter starter;
    session::give_way();
    maker = niceness();
    starter.run([&] { std::thread([&] { started = niceness(); }).join(); });
    EXPECT_ERROR(starter.run([] { throw failure("the job's own"); }), Exit::failed, "the job's own");
  }).join();
  EXPECT_EQ(maker, std::min(before + 10, 19));
  EXPECT_EQ(started, before);
}

// A driver's threads exist before a touch goes live.
TEST(DrawingThreads, GiveWayThoughTheyHaveBegun) {
  const auto niceness = [](int thread) { return getpriority(PRIO_PROCESS, static_cast<id_t>(thread)); };
  std::atomic<bool> done{false};
  std::atomic<int> driver{0}, other{0};
  const auto stay = [&](std::atomic<int>& number) {
    number = gettid();
    number.notify_one();
    done.wait(false);
  };
  std::thread another([&] { stay(other); });
  other.wait(0);
  const int before = niceness(other);
  std::thread maker([&] {
    DrawingThreads drawing;
    drawing.expect();
    std::thread begun([&] { stay(driver); });
    driver.wait(0);
    drawing.have_begun();
    EXPECT_EQ(niceness(driver), before);
    drawing.give_way();
    EXPECT_EQ(niceness(driver), std::min(before + 10, 19));
    EXPECT_EQ(niceness(gettid()), std::min(before + 10, 19));
    EXPECT_NE(sched_getscheduler(driver), SCHED_OTHER);
    EXPECT_EQ(niceness(other), before) << "nobody else's";
    done = true;
    done.notify_all();
    begun.join();
  });
  maker.join();
  another.join();
}

TEST(NextOutputs, ARunThatRestartsOverwritesNothing) {
  const auto folder = test::scratch_folder("live-next-outputs");
  const std::string events = folder / "events", drives = folder / "drives", take = folder / "take.1";
  const std::vector<session::LinkKind> links = session::builtin_links();
  NextOutputs outputs;
  const auto begin = [&](bool writes) {
    setup::LiveOptions options;
    options.events = events + ".jsonl";
    options.record = take + "/";
    options.link = "record:" + drives;
    const auto lines = outputs.name(options, links);
    if (writes) {
      test::write_text(options.events, "e");
      test::write_text(options.link.substr(7), "d");
      std::filesystem::create_directory(options.record);
      test::write_text(options.record + "/recording.toml", "r");
    }
    return std::pair(options, lines);
  };
  EXPECT_TRUE(begin(false).second.empty());
  EXPECT_TRUE(begin(false).second.empty()) << "nothing was written there";
  EXPECT_EQ(begin(true).first.record, take);
  const auto [second, told] = begin(true);
  EXPECT_EQ(second.events, events + "-2.jsonl");
  EXPECT_EQ(second.link, "record:" + drives + "-2");
  EXPECT_EQ(second.record, take + "-2");
  ASSERT_EQ(told.size(), 3u);
  EXPECT_EQ(told[0], "--events: " + events + ".jsonl is kept, this run writes " + second.events);
  test::write_text(events + "-3.jsonl", "somebody else's");
  EXPECT_EQ(begin(true).first.events, events + "-4.jsonl");

  setup::LiveOptions streams;
  streams.link = "foci:udp:127.0.0.1:9000";
  for (const char* stream : {"-", "-", "/dev/null", "/dev/null"}) {
    streams.events = stream;
    EXPECT_TRUE(outputs.name(streams, links).empty()) << stream;
  }
}

TEST(TimeBins, CountTenthsOfTheBudget) {
  TimeBins bins;
  for (int i = 0; i < 99; ++i)
    bins.add(0.55 * TimeBins::budget_s);
  bins.add(100);
  EXPECT_EQ(bins.counts[5], 99u);
  EXPECT_EQ(bins.counts.back(), 1u);
  EXPECT_NEAR(bins.quantile(0.5), 0.6 * TimeBins::budget_s, 1e-12);
  EXPECT_EQ(bins.total(), 100u);
}

}  // namespace
}  // namespace palpa::viewer
