#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "session/foci_link.hpp"
#include "session/link.hpp"
#include "session/record_link.hpp"
#include "support/shared_data.hpp"

namespace palpa::session {
namespace {

struct Setting {
  array::Layout layout;
  std::vector<std::string> names{"cube", "odd \"name\"\n"};
  LinkSetting setting{layout, names, 1.5e-3};
  Setting() { layout.transducers.assign(3, {Vec3(0), Vec3(0, 0, 1)}); }
};

template <typename Work>
Error error_of(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return error;
  }
  return Error(Exit::ok, "");
}

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

TEST(Links, UnknownOnesAreRefusedWithTheKnownNames) {
  Setting s;
  const Error error = error_of([&] { open_link("piano:88", builtin_links(), s.setting); });
  EXPECT_EQ(error.code(), Exit::usage);
  EXPECT_NE(std::string(error.what()).find("record:FILE"), std::string::npos) << error.what();
  EXPECT_EQ(error_of([&] { open_link("null:x", builtin_links(), s.setting); }).code(), Exit::usage);
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
  const DriveRecording recording = read_drive_recording(file);
  EXPECT_EQ(recording.slot_s, 1.5e-3);
  EXPECT_EQ(recording.transducers, 3u);
  ASSERT_EQ(recording.drives.size(), 2u);
  EXPECT_EQ(recording.drives[1].slot, 7u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(recording.drives[0].drive[i].amplitude, loud[i].amplitude);
    EXPECT_EQ(recording.drives[0].drive[i].phase, loud[i].phase);
  }
}

TEST(RecordLink, AFullDiskIsAnError) {
  Setting s;
  const Error error = error_of([&] {
    const auto link = open_link("record:/dev/full", builtin_links(), s.setting);
    const array::Drive drive(3, {1.0f, 0.0f});
    for (int i = 0; i < 100'000; ++i)
      link->send(static_cast<std::uint64_t>(i), drive);
    link->finish();
  });
  EXPECT_EQ(error.code(), Exit::failed);
  EXPECT_NE(std::string(error.what()).find("/dev/full: cannot be written"), std::string::npos) << error.what();
  EXPECT_EQ(error_of([&] { open_link("record:/no/such/folder/x", builtin_links(), s.setting); }).code(), Exit::failed);
}

TEST(RecordLink, BrokenFilesAreNamed) {
  const auto folder = test::scratch_folder("broken");
  std::ofstream(folder / "not") << "something else entirely, long enough";
  EXPECT_EQ(error_of([&] { read_drive_recording(folder / "not"); }).code(), Exit::bad_input);
  EXPECT_EQ(error_of([&] { read_drive_recording(folder / "missing"); }).code(), Exit::bad_input);
  EXPECT_EQ(error_of([&] { read_drive_recording(folder); }).code(), Exit::bad_input);
  Setting s;
  const auto link = open_link("record:" + (folder / "cut").string(), builtin_links(), s.setting);
  link->send(0, array::Drive(3, {1.0f, 0.0f}));
  link->finish();
  std::filesystem::resize_file(folder / "cut", std::filesystem::file_size(folder / "cut") - 5);
  const Error error = error_of([&] { read_drive_recording(folder / "cut"); });
  EXPECT_NE(std::string(error.what()).find("cut off"), std::string::npos) << error.what();
}

/// A UDP socket on the loopback, on a port of the system's choice.
struct Receiver {
  int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  int port = 0;
  Receiver() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(bind(socket, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    socklen_t size = sizeof(address);
    getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
    port = ntohs(address.sin_port);
    const timeval timeout{5, 0};
    setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof(timeout));
  }
  ~Receiver() { ::close(socket); }
  std::string line() {
    char text[65536];
    const ssize_t size = recv(socket, text, sizeof(text), 0);
    return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : std::string();
  }
};

TEST(FociLink, WritesTheSameBytesIntoTheSamePlace) {
  const std::vector<std::string> names{"cube", "a \"b\"\n"};
  JsonWriter json;
  write_foci_line({}, names, json);
  EXPECT_EQ(json.finish(), "{\"time_s\":0,\"fingers\":[]}\n");
  const void* storage = nullptr;
  for (int frame = 0; frame < 3; ++frame) {
    write_foci_line(one_finger(), names, json);
    const std::string_view line = json.finish();
    EXPECT_EQ(line, R"({"time_s":12.5,"fingers":[{"id":4,"solid":"a \"b\"\u000a",)"
                    R"("foci_m":[[0.001,-0.002,0.003],[0,0,1e-09]],"order":[1,0],"dwell_s":0.0015,)"
                    R"("modulation_hz":0,"gain":1}]})"
                    "\n");
    EXPECT_TRUE(frame == 0 || storage == line.data());
    storage = line.data();
  }
}

TEST(FociLink, SendsOneJsonLinePerFrame) {
  Setting s;
  Receiver receiver;
  const auto link = open_link("foci:udp:127.0.0.1:" + std::to_string(receiver.port), builtin_links(), s.setting);
  link->foci(one_finger());
  const std::string line = receiver.line();
  ASSERT_FALSE(line.empty());
  EXPECT_EQ(line.back(), '\n');
  const auto json = nlohmann::json::parse(line);
  EXPECT_EQ(json["time_s"], 12.5);
  ASSERT_EQ(json["fingers"].size(), 1u);
  const auto& finger = json["fingers"][0];
  EXPECT_EQ(finger["id"], 4);
  EXPECT_EQ(finger["solid"], s.names[1]);
  EXPECT_EQ(finger["foci_m"][0][1].get<float>(), -0.002f);
  EXPECT_EQ(finger["order"], (std::vector<int>{1, 0}));
  EXPECT_EQ(finger["dwell_s"], 0.0015);

  link->foci(array::Schedule());
  EXPECT_TRUE(nlohmann::json::parse(receiver.line())["fingers"].empty());
}

/// As many fingers and foci as there may be: about 160 kB of JSON.
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
  Receiver receiver;
  const auto link = open_link("foci:udp:127.0.0.1:" + std::to_string(receiver.port), builtin_links(), s.setting);
  link->foci(one_finger());
  EXPECT_FALSE(nlohmann::json::parse(receiver.line())["fingers"].empty());
  testing::internal::CaptureStderr();
  for (int frame = 0; frame < 3; ++frame) {
    link->foci(too_long_for_a_datagram());
    EXPECT_EQ(receiver.line(), "{\"time_s\":13.5,\"fingers\":[]}\n");
  }
  link->foci(one_finger());
  EXPECT_FALSE(nlohmann::json::parse(receiver.line())["fingers"].empty());
  link->finish();
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 2) << said;
  EXPECT_NE(said.find("a datagram could not be sent"), std::string::npos) << said;
  EXPECT_NE(said.find("3 of 5 lines could not be sent"), std::string::npos) << said;
}

TEST(FociLink, EndsInSilenceEvenWhereADatagramIsLost) {
  Setting s;
  Receiver receiver;
  const auto link = open_link("foci:udp:127.0.0.1:" + std::to_string(receiver.port), builtin_links(), s.setting);
  link->foci(one_finger());
  receiver.line();
  link->finish();
  for (int line = 0; line < 3; ++line)
    EXPECT_EQ(receiver.line(), "{\"time_s\":12.5,\"fingers\":[]}\n");
}

TEST(FociLink, SurvivesThatNobodyListens) {
  Setting s;
  int port = 0;
  {
    const Receiver gone;
    port = gone.port;
  }
  const auto link = open_link("foci:udp:127.0.0.1:" + std::to_string(port), builtin_links(), s.setting);
  for (int i = 0; i < 10; ++i)
    EXPECT_NO_THROW(link->foci(one_finger()));
}

TEST(FociLink, RefusesOtherForms) {
  Setting s;
  for (const char* spec : {"foci", "foci:", "foci:tcp:a:1", "foci:udp:", "foci:udp:host", "foci:udp:host:",
                           "foci:udp::9000", "foci:udp:host:0", "foci:udp:host:65536", "foci:udp:host:12x"}) {
    EXPECT_EQ(error_of([&] { open_link(spec, builtin_links(), s.setting); }).code(), Exit::usage) << spec;
  }
}

}  // namespace
}  // namespace palpa::session
