#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <string>

#include "base/error.hpp"
#include "session/links/board_sound.hpp"
#include "session/links/foci_link.hpp"
#include "session/links/link.hpp"
#include "session/links/record_link.hpp"
#include "support/captured.hpp"
#include "support/drive_recording.hpp"
#include "support/file_size_limit.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "support/udp_receiver.hpp"

namespace palpa::session {
namespace {

struct Setting {
  array::Layout layout;
  std::vector<std::string> names{"cube", "odd \"name\"\n"};
  LinkSetting setting{layout, names, 1.5e-3};
  Setting() { layout.transducers.assign(3, {Vec3(0), Vec3(0, 0, 1)}); }
};

array::Schedule one_finger() {
  array::Schedule schedule;
  schedule.time_s = 12.5;
  array::Voice& voice = schedule.add_voice();
  voice.id = 4;
  voice.solid = 1;
  voice.foci = {Vec3(0.001, -0.002, 0.003), Vec3(0, 0, 1e-9)};
  voice.order = {1, 0};
  return schedule;
}

TEST(Slots, AreCountedFromTheFirstToTheLastThatMaySound) {
  EXPECT_EQ((Slots{.from = 4, .until = 64}).count(), 60u);
  EXPECT_EQ((Slots{.from = 64, .until = 64}).count(), 0u);
  EXPECT_EQ((Slots{.from = 65, .until = 64}).count(), 0u) << "its time was over before it was played";
  EXPECT_EQ(Slots{}.cycle.slots_to_look_at(), most_cycle);
  EXPECT_EQ((Cycle{Plays::pattern, 10}).slots_to_look_at(), 10u);
  EXPECT_TRUE((Cycle{Plays::pattern, 10}).is_listed());
  EXPECT_FALSE((Cycle{Plays::slot_by_slot}).is_listed());
}

/// What the end of a program says of its boards.
TEST(BoardSound, IsSaidOncePerBoardWithWhatToDo) {
  EXPECT_EQ(to_text("board:1", BoardSound::silent), "the array (board:1) is silent");
  for (const BoardSound sound : {BoardSound::unknown, BoardSound::told, BoardSound::gone})
    EXPECT_CONTAINS(to_text("board:1", sound), ": it may still sound, switch it off");
  EXPECT_EQ(with_board_sounds("a camera is gone"), "a camera is gone") << "no board was opened";
  board_sound("board:1") = BoardSound::silent;
  EXPECT_EQ(with_board_sounds("a camera is gone"), "a camera is gone; the array (board:1) is silent");
  EXPECT_EQ(boards_that_may_sound(), "");
  board_sound("board:2") = BoardSound::told;
  const std::string told =
      "the array (board:2) was told to be silent, but has not answered: it may still sound, switch it off";
  EXPECT_EQ(boards_that_may_sound(), told);
  EXPECT_EQ(with_board_sounds("board: " + told), "board: " + told + "; the array (board:1) is silent");
  board_sound("board:2") = BoardSound::gone;
  EXPECT_CONTAINS(with_board_sounds("the end"), "the array (board:2) is out of reach: it may still sound");
  board_sound("board:2") = BoardSound::silent;  // opened again
  EXPECT_EQ(boards_that_may_sound(), "");
}

TEST(Links, UnknownOnesAreRefusedWithTheKnownNames) {
  Setting s;
  EXPECT_ERROR(open_link("piano:88", builtin_links(), s.setting), Exit::usage, "record:FILE");
  EXPECT_EQ(test::thrown_by([&] { open_link("null:x", builtin_links(), s.setting); }).code(), Exit::usage);
  EXPECT_NO_THROW(open_link("null", builtin_links(), s.setting));
}

TEST(RecordLink, WritesWhatItIsSentAndReadsItBack) {
  Setting s;
  const auto file = test::scratch_folder("record") / "drives.bin";
  const auto link = open_link("record:" + file.string(), builtin_links(), s.setting);
  const array::Drive loud{{1.0f, 0.5f}, {0.25f, -3.0f}, {0.0f, 3.14159f}}, silent(3, {0.0f, 0.0f});
  link->send(0, loud);
  link->send(7, silent);
  link->finish();
  const test::DriveRecording recording = test::read_drive_recording(file);
  EXPECT_EQ(recording.slot_s, 1.5e-3);
  EXPECT_EQ(recording.transducers, 3u);
  ASSERT_EQ(recording.drives.size(), 2u);
  EXPECT_EQ(recording.drives[1].slot, 7u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(recording.drives[0].drive[i].amplitude, loud[i].amplitude);
    EXPECT_EQ(recording.drives[0].drive[i].phase, loud[i].phase);
  }
}

TEST(RecordLink, EndsSilentlyWhereverTheDiskIsFull) {
  Setting s;
  const auto file = test::scratch_folder("limited") / "drives.bin";
  const array::Drive loud(3, {1.0f, 0.5f});
  constexpr std::size_t header = 24, record = 8 + 3 * 8, many = 20'000;
  // At the first drives, at the end of a block, and anywhere else; within a record at every byte.
  for (const std::size_t records : {0u, 1u, 2u, 8190u, 8191u, 8192u, 8193u, 12'345u}) {
    for (std::size_t rest = 0; rest < record; rest += records < 3 ? 1 : 7) {
      const test::FileSizeLimit limit(header + records * record + rest);
      const auto link = open_link("record:" + file.string(), builtin_links(), s.setting);
      Error first(Exit::ok, "");
      const auto keep_first = [&](const auto& work) {
        const Error error = test::thrown_by(work);
        if (first.code() == Exit::ok) first = error;
      };
      std::uint64_t slot = 0;
      for (; slot < many && first.code() == Exit::ok; ++slot)
        keep_first([&] { link->send(slot, loud); });
      // Like the loop, whatever happened.
      keep_first([&] { link->send(slot, array::Drive(3, {0.0f, 0.0f})); });
      keep_first([&] { link->finish(); });
      EXPECT_EQ(first.code(), Exit::failed);
      EXPECT_EQ(first.what(), file.string() + ": cannot be written: File too large");
      const test::DriveRecording recording = test::read_drive_recording(file);
      ASSERT_EQ(recording.drives.size(), records) << rest << " bytes of another fitted";
      for (std::size_t i = 0; i < records; ++i) {
        const float amplitude = i + 1 < records ? 1.0f : 0.0f;
        ASSERT_EQ(recording.drives[i].drive[2].amplitude, amplitude) << i << " of " << records;
        ASSERT_TRUE(i == 0 || recording.drives[i].slot > recording.drives[i - 1].slot) << i;
      }
    }
  }
}

/// While this lives, stdout is appended to that file.
class AppendedTo {
 public:
  explicit AppendedTo(const std::filesystem::path& file) : before_(dup(STDOUT_FILENO)) {
    const int end = open(file.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
    dup2(end, STDOUT_FILENO);
    close(end);
  }
  ~AppendedTo() {
    dup2(before_, STDOUT_FILENO);
    close(before_);
  }
  AppendedTo(const AppendedTo&) = delete;
  AppendedTo& operator=(const AppendedTo&) = delete;

 private:
  int before_;
};

TEST(RecordLink, EndsSilentlyWhereItIsAppendedToAFile) {
  Setting s;
  const auto file = test::scratch_folder("appended") / "drives.bin";
  const array::Drive loud(3, {1.0f, 0.5f});
  constexpr std::size_t header = 24, record = 8 + 3 * 8, before = 100;
  std::ofstream(file) << std::string(before, 'x');
  {
    const test::FileSizeLimit limit(before + header + 5 * record + 7);
    const AppendedTo out(file);
    const auto link = open_link("record:-", builtin_links(), s.setting);
    const Error error = test::thrown_by([&] {
      for (std::uint64_t slot = 0; slot < 20'000; ++slot)
        link->send(slot, loud);
      link->finish();
    });
    EXPECT_EQ(error.code(), Exit::failed);
    EXPECT_EQ(fcntl(STDOUT_FILENO, F_GETFL) & O_APPEND, O_APPEND) << "as it was";
  }
  const std::string text = test::read_text(file);
  ASSERT_EQ(text.size(), before + header + 5 * record);
  EXPECT_EQ(text.substr(0, before), std::string(before, 'x'));
  EXPECT_EQ(text.substr(text.size() - record + 8), std::string(record - 8, '\0')) << "the last drive is silent";
  EXPECT_NE(text.substr(text.size() - 2 * record + 8, record - 8), std::string(record - 8, '\0'));
}

TEST(RecordLink, AFileThatCannotBeCreatedIsNamed) {
  Setting s;
  EXPECT_ERROR(open_link("record:/no/such/folder/x", builtin_links(), s.setting), Exit::failed, "/no/such/folder/x");
}

TEST(FociLink, WritesTheSameBytesIntoTheSamePlace) {
  const std::vector<std::string> names{"cube", "a \"b\"\n"};
  JsonWriter json;
  write_foci_line({}, {}, names, json);
  EXPECT_EQ(json.finish(), "{\"time_s\":0,\"fingers\":[]}\n");
  const void* storage = nullptr;
  for (int frame = 0; frame < 3; ++frame) {
    write_foci_line(one_finger(), {}, names, json);
    const std::string_view line = json.finish();
    EXPECT_EQ(line, R"({"time_s":12.5,"fingers":[{"id":4,"solid":"a \"b\"\u000a",)"
                    R"("foci_m":[[0.001,-0.002,0.003],[0,0,1e-09]],"order":[1,0],"dwell_s":0.0015,)"
                    R"("modulation_hz":0,"gain":1}]})"
                    "\n");
    EXPECT_TRUE(frame == 0 || storage == line.data());
    storage = line.data();
  }
}

TEST(FociLink, GivesGainsThatChangeFromTheFirstSlotOn) {
  array::Schedule schedule = one_finger();
  schedule.voices[0].course = {.first_slot = 20, .gains = {1, 0.5F, 0.25F}};
  JsonWriter json;
  write_foci_line(schedule, {.from = 21, .until = 25}, {}, json);
  EXPECT_CONTAINS(std::string(json.finish()), R"("gain":1,"slot_s":0.0015,"gains":[0.5,0.25,0.25,0.25]})");
}

TEST(FociLink, GivesTheGainsOfAllSlotsToTheLastBit) {
  array::Schedule schedule = one_finger();
  schedule.slot_s = 1e-4;
  array::Course& course = schedule.voices[0].course;
  course = {.slots = 500, .texture = {1, 2, 3}};
  course.to.motion = 1;
  JsonWriter json;
  EXPECT_TRUE(write_foci_line(schedule, {.from = 10, .until = 1010}, {}, json)) << "100 ms of 0.1 ms";
  const auto gains = nlohmann::json::parse(json.finish())["fingers"][0]["gains"].get<std::vector<double>>();
  ASSERT_EQ(gains.size(), 1000U);
  for (std::uint64_t n = 0; n < gains.size(); ++n)
    EXPECT_EQ(gains[n], array::modulate(course, 10 + n, schedule.slot_s));

  // If there are more, it says so.
  const array::Voice voice = schedule.voices[0];
  schedule.add_voice() = voice;
  EXPECT_FALSE(write_foci_line(schedule, {.from = 0, .until = 1'000'000}, {}, json));
  const auto cut = nlohmann::json::parse(json.finish())["fingers"];
  EXPECT_EQ(cut[0]["gains"].size() + cut[1]["gains"].size(), most_gains);
  Setting s;
  const test::UdpReceiver receiver;
  const std::string said = test::stderr_of([&] {
    const auto link = open_link("foci:" + receiver.address(), builtin_links(), s.setting);
    for (int frame = 0; frame < 3; ++frame)
      link->plan({.schedule = schedule, .slots = {.from = 0, .until = 5000}});
    link->plan({.schedule = one_finger(), .slots = {.from = 0, .until = 5000}});
  });
  EXPECT_EQ(std::ranges::count(said, '\n'), 1) << said;
  EXPECT_CONTAINS(said, "link foci: a line has at most 2048 gains that change");
}

TEST(FociLink, TheSilenceAfterLinesOfSlotsIsNotBeforeThem) {
  Setting s;
  const test::UdpReceiver receiver;
  const auto link = open_link("foci:" + receiver.address(), builtin_links(), s.setting);
  array::Schedule slots = one_finger();
  slots.once = true;
  slots.time_s = 0;
  link->plan({.schedule = slots, .slots = {.from = 0, .until = 100}});
  link->send(99, array::Drive(s.layout.transducers.size(), {1, 0}));
  const double sounded_s = nlohmann::json::parse(receiver.next())["time_s"].get<double>();
  EXPECT_GT(sounded_s, 0.01);
  link->plan({.schedule = {}});
  const nlohmann::json silence = nlohmann::json::parse(receiver.next());
  EXPECT_TRUE(silence["fingers"].empty());
  EXPECT_GE(silence["time_s"].get<double>(), sounded_s);
}

/// The largest number of fingers and foci: about 160 kB of JSON.
array::Schedule too_long_for_a_datagram() {
  array::Schedule schedule;
  schedule.time_s = 13.5;
  for (std::uint32_t v = 0; v < 64; ++v) {
    array::Voice& voice = schedule.add_voice();
    voice.id = v;
    for (std::uint32_t i = 0; i < 64; ++i) {
      voice.foci.emplace_back(0.012345678 * v, -0.0123456789, 0.0123456789 * i);
      voice.order.push_back(i);
    }
  }
  return schedule;
}

TEST(FociLink, SilencesWhatItCannotSend) {
  Setting s;
  const test::UdpReceiver receiver;
  const auto link = open_link("foci:" + receiver.address(), builtin_links(), s.setting);
  link->plan({.schedule = one_finger()});
  EXPECT_FALSE(nlohmann::json::parse(receiver.next())["fingers"].empty());
  const std::string said = test::stderr_of([&] {
    for (int frame = 0; frame < 3; ++frame) {
      link->plan({.schedule = too_long_for_a_datagram()});
      EXPECT_EQ(receiver.next(), "{\"time_s\":13.5,\"fingers\":[]}\n");
    }
    link->plan({.schedule = one_finger()});
    EXPECT_FALSE(nlohmann::json::parse(receiver.next())["fingers"].empty());
    link->finish();
  });
  for (int line = 0; line < 3; ++line)
    EXPECT_EQ(receiver.next(), "{\"time_s\":12.5,\"fingers\":[]}\n") << "silence is the end, if one is lost, too";
  EXPECT_EQ(std::ranges::count(said, '\n'), 2) << said;
  EXPECT_CONTAINS(said, "a datagram could not be sent");
  EXPECT_CONTAINS(said, "3 of 5 lines could not be sent");
}

/// localhost is ::1 and 127.0.0.1, and the receiver listens on one of them.
TEST(FociLink, FindsTheAddressOfANameThatListens) {
  Setting s;
  const test::UdpReceiver receiver;
  const auto link = open_link("foci:udp:localhost:" + std::to_string(receiver.port()), builtin_links(), s.setting);
  const std::string said = test::stderr_of([&] {
    for (int frame = 0; frame < 3; ++frame) {
      link->plan({.schedule = one_finger()});
      EXPECT_FALSE(nlohmann::json::parse(receiver.next())["fingers"].empty());
    }
    link->finish();
  });
  EXPECT_EQ(said, "");
  EXPECT_EQ(link->carried()->completed.plans, 3u);
}

/// Drives that nobody took were not played.
TEST(FociLink, CountsAndSaysWhatNobodyTook) {
  Setting s;
  auto receiver = std::make_unique<test::UdpReceiver>();
  const int port = receiver->port();
  const auto link = open_link("foci:udp:localhost:" + std::to_string(port), builtin_links(), s.setting);
  const array::Drive sounding(3, {1.0F, 0.0F});
  const auto play = [&](int frames) {
    for (int frame = 0; frame < frames; ++frame) {
      link->plan({.schedule = one_finger()});
      link->send(0, sounding);
    }
  };
  play(2);
  receiver.reset();
  const std::string said = test::stderr_of([&] {
    play(5);
    link->finish();
  });
  EXPECT_EQ(link->carried()->completed.drives, 2u);
  EXPECT_EQ(link->carried()->completed.plans, 2u);
  EXPECT_EQ(std::ranges::count(said, '\n'), 2) << said;
  EXPECT_CONTAINS(said, "link foci: nobody listens at localhost:" + std::to_string(port));
  EXPECT_CONTAINS(said, "link foci: 5 of 7 lines had no receiver");
}

TEST(FociLink, RefusesOtherForms) {
  Setting s;
  EXPECT_ERROR(open_link("foci:udp:localhost:99999", builtin_links(), s.setting), Exit::usage,
               "a port is from 1 to 65535, not 99999");
  for (const char* spec : {"foci", "foci:", "foci:tcp:a:1", "foci:udp:", "foci:udp:host", "foci:udp:host:",
                           "foci:udp::9000", "foci:udp:host:0", "foci:udp:host:65536", "foci:udp:host:12x"}) {
    EXPECT_EQ(test::thrown_by([&] { open_link(spec, builtin_links(), s.setting); }).code(), Exit::usage) << spec;
  }
}

}  // namespace
}  // namespace palpa::session
