// RealSense Viewer's recordings since librealsense 2.58.1: databases as it writes them, and databases that are cut,
// broken or hostile.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "driver/cameras/made_up_database.hpp"
#include "driver/rosbag/source.hpp"
#include "sensing/recording.hpp"
#include "support/captured.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::rosbag {
namespace {

using palpa::test::error_of;
using palpa::test::read_text;
using palpa::test::stderr_of;
using palpa::test::write_text;
using test::Bytes;
using test::Cdr;
using test::MadeUpBag;
using test::MadeUpDatabase;

std::string take_file() {
  static const std::filesystem::path folder = palpa::test::scratch_folder("databases");
  return (folder / "take.db3").string();
}

std::string written(const MadeUpDatabase& database) {
  database.write(take_file());
  return take_file();
}

sensing::Camera above() {
  sensing::Camera camera;
  camera.name = "above";
  camera.width = 16;
  camera.height = 8;
  return camera;
}

/// All its frames, as fast as they are requested.
std::vector<sensing::FrameSet> play(const std::string& file) {
  const sensing::Camera camera = above();
  const auto source = open_bag(file, &camera, false);
  std::vector<sensing::FrameSet> sets;
  for (sensing::FrameSet set; source->next(set, 0.1);)
    sets.push_back(set);
  return sets;
}

TEST(Database, FramesComeWithTheirTimesAndTheCameraOfTheDatabase) {
  const sensing::Camera camera = above();
  MadeUpDatabase text, message, both, plain;
  text.camera_info = false;
  message.lens.reset();
  plain.plain = true;
  for (const MadeUpDatabase& database : {text, message, both, plain}) {
    const auto source = open_bag(written(database), &camera, false);
    ASSERT_EQ(source->cameras().size(), 1u);
    const sensing::Camera& found = source->cameras()[0];
    EXPECT_EQ(found.name, "above");
    EXPECT_EQ(found.width, 16u);
    EXPECT_EQ(found.height, 8u);
    EXPECT_EQ(found.fx, 40);
    EXPECT_EQ(found.fy, 41);
    EXPECT_EQ(found.cx, 8);
    EXPECT_EQ(found.cy, 4);
    EXPECT_EQ(found.depth_unit_m, 0.0001);
    EXPECT_EQ(found.rate_hz, 30);
    sensing::FrameSet set;
    for (std::size_t i = 0; i < database.times_s.size(); ++i) {
      ASSERT_TRUE(source->next(set, 0));
      ASSERT_EQ(set.frames.size(), 1u);
      EXPECT_EQ(set.sequence, i);
      EXPECT_NEAR(set.time_s, database.times_s[i], 1e-9);
      for (std::uint32_t p = 0; p < 16 * 8; ++p)
        ASSERT_EQ(set.frames[0].depth[p], MadeUpBag::depth_of(i, p));
    }
    EXPECT_FALSE(source->next(set, 0));
    EXPECT_FALSE(source->next(set, 0));
  }
}

TEST(Database, DistortionComesFromEitherLens) {
  const sensing::Camera camera = above();
  MadeUpDatabase text, message;
  text.lens = MadeUpDatabase::lens_text("Brown Conrady", "0.1,-0.2,0.001,0.002,0.03");
  message.lens.reset();
  message.coefficients = {0.1, -0.2, 0.001, 0.002, 0.03};
  for (const MadeUpDatabase& database : {text, message})
    EXPECT_EQ(open_bag(written(database), &camera, false)->cameras()[0].distortion,
              (std::array<double, 5>{0.1, -0.2, 0.001, 0.002, 0.03}));
}

TEST(Database, OfADatabaseThatLibrealsenseWroteEveryFrameIsRight) {
  PALPA_SHARED_OR_SKIP(file, "realsense-db3/software-device.db3");
  const auto source = open_bag(file.string(), nullptr, false);
  const sensing::Camera& found = source->cameras()[0];
  EXPECT_EQ(found.name, "/device_0/sensor_0");
  EXPECT_EQ(found.width, 640u);
  EXPECT_EQ(found.height, 480u);
  EXPECT_NEAR(found.fx, 390.43, 1e-5);
  EXPECT_NEAR(found.fy, 390.43, 1e-5);
  EXPECT_NEAR(found.cx, 331.4, 1e-5);
  EXPECT_NEAR(found.cy, 242.2, 1e-5);
  EXPECT_EQ(found.distortion, (std::array<double, 5>{}));
  EXPECT_EQ(found.depth_unit_m, 0.001);
  EXPECT_EQ(found.rate_hz, 30);
  sensing::FrameSet set;
  double last_s = -1;
  for (std::uint16_t k = 0; k < 20; ++k) {
    ASSERT_TRUE(source->next(set, 0));
    EXPECT_EQ(set.sequence, k);
    EXPECT_GT(set.time_s, last_s);
    last_s = set.time_s;
    std::vector<std::uint16_t> expected(std::size_t{640} * 480, static_cast<std::uint16_t>(600 + k));
    for (std::size_t v = 100; v < 200; ++v)
      std::fill_n(expected.begin() + static_cast<std::ptrdiff_t>(v * 640 + 100), 200, std::uint16_t{400});
    expected[0] = 0;
    ASSERT_EQ(set.frames[0].depth, expected) << k;
  }
  EXPECT_FALSE(source->next(set, 0));
  EXPECT_NEAR(last_s, 0.671068645, 1e-9);
}

TEST(Database, IsNoRecordingOfPalpa) {
  EXPECT_REFUSED(sensing::load_recording(written({})), "give it as bag:" + take_file());
}

TEST(Database, OneWithoutWhatIsNeededIsRefused) {
  const std::pair<std::function<void(MadeUpDatabase&)>, const char*> cases[] = {
      {[](auto& d) { d.times_s.clear(); },
       "has no depth of a RealSense: there is no image on a topic such as /device_0/sensor_0/Depth_0/image/data or "
       ".../image/data/compressedDepth; its topics are /file_version, /device_0/sensor_0/Depth_0/info, "
       "/device_0/sensor_0/Depth_0/camera_info and 3 more"},
      {[](auto& d) { d.sensor = "/camera", d.stream = "/depth"; },
       "its topics are /file_version, /camera/depth/info, /camera/depth/camera_info and 6 more"},
      {[](auto& d) { d.more = {"DELETE FROM topics"}; }, "it has no topic"},
      {[](auto& d) { d.more = {"DELETE FROM messages"}; }, "there is no image on a topic such as"},
      {[](auto& d) { d.more = {"DROP TABLE messages"}; }, "is no recording of ROS 2: no such table: messages"},
      {[](auto& d) { d.more = {"DROP TABLE topics"}; }, "is no recording of ROS 2: no such table: topics"},
      {[](auto& d) { d.more = {"ALTER TABLE messages RENAME COLUMN data TO content"}; }, "no such column: data"},
      {[](auto& d) { d.lens.reset(), d.camera_info = false; }, "an image comes before the camera_info"},
  };
  for (const auto& [change, part] : cases) {
    MadeUpDatabase database;
    change(database);
    EXPECT_REFUSED(play(written(database)), part);
  }
  MadeUpDatabase database;
  database.unit.clear();
  EXPECT_CONTAINS(stderr_of([&] { EXPECT_EQ(play(written(database)).size(), 4u); }), "palpa assumes 1 mm");
}

TEST(Database, WhatItCannotReadIsRefused) {
  const std::string image = "message 16: topic /device_0/sensor_0/Depth_0/image/data/compressedDepth: ";
  const std::pair<std::function<void(MadeUpDatabase&)>, std::string> cases[] = {
      {[](auto& d) { d.png = Bytes{1, 2, 3, 4, 5, 6, 7, 8, 9}; }, image + "its image is not a PNG file"},
      {[](auto& d) { d.png = Bytes{}; }, image + "its image is not a PNG file"},
      {[](auto& d) { d.format = "16UC1; compressedDepth rvl"; }, "depth has the format '16UC1; compressedDepth rvl'"},
      {[](auto& d) {
         d.last = {0, 1, 0, 0};
       },
       image + "a value extends past the end of its container"},
      {[](auto& d) { d.last = {0, 0, 0, 0, 0, 0, 0, 1}; }, image + "it is not in little-endian CDR"},
      {[](auto& d) { d.last = {0x28, 0xb5, 0x2f, 0xfd, 0, 0}; }, image + "it is compressed with zstd"},
      {[](auto& d) { d.last = {0}; }, image + "it is not in little-endian CDR"},
      // A text, and an image, whose lengths lie.
      {[](auto& d) { d.last = Cdr().number(1u).number(2u).number(0xffffffffu).bytes; }, image + "a value extends past"},
      {[](auto& d) { d.last = Cdr().header().text(d.format).number(0xfffffff0u).bytes; },
       image + "a value extends past"},
      {[](auto& d) { d.unit = "0.000000"; }, "the depth unit in metres is 0, not 1e-09 to 1"},
      {[](auto& d) { d.unit = "a millimetre"; }, "the value is 'a millimetre', which is no number"},
      {[](auto& d) { d.unit = std::string(100'000, '1'); }, "1111...', which is no number"},
      {[](auto& d) { d.info = "encoding=Z16"; }, "'encoding=Z16' has no fps"},
      {[](auto& d) { d.info = "fps=5000"; }, "5000 frames per second"},
      {[](auto& d) { d.lens = "width=16;height=8"; }, "has no coeffs"},
      {[](auto& d) { d.lens = "width=0;height=8"; }, "an image has 0x8 pixels"},
      {[](auto& d) { d.lens = "width=16.5;height=8"; }, "an image has 16.5x8 pixels"},
      {[](auto& d) { d.lens = MadeUpDatabase::lens_text("Kannala Brandt4", "0.1,0,0,0,0"); }, "model is 'Kannala"},
      {[](auto& d) { d.lens = MadeUpDatabase::lens_text("Brown Conrady", "-50,0,0,0,0"); }, "cannot be undone"},
      {[](auto& d) { d.coefficients.assign(200, 0); }, "a lens has 200 coefficients"},
      {[](auto& d) { d.width = 17; }, "is 17x8 pixels, but its camera is 16x8"},
      {[](auto& d) { d.width = 17, d.plain = true; }, "an image has 17x8 pixels, but its camera has 16x8"},
      {[](auto& d) { d.width = 5000, d.times_s = {0.1}; }, "an image has 5000x8 pixels"},
      {[](auto& d) { d.stream = "/Depth_" + std::string(300, '0'); }, "a topic has a name of 3"},
      {[](auto& d) { d.more = {"UPDATE messages SET timestamp = 'now' WHERE id = 16"}; },
       "message 16: its time is no whole number of nanoseconds"},
      {[](auto& d) { d.more = {"UPDATE messages SET data = 'text' WHERE id = 16"}; }, "message 16: it has no data"},
      {[](auto& d) { d.more = {"UPDATE messages SET data = zeroblob(67108865) WHERE id = 16"}; },
       "has more than 67108864 bytes"},
  };
  for (const auto& [change, part] : cases) {
    MadeUpDatabase database;
    change(database);
    const std::string line = error_of([&] { play(written(database)); });
    EXPECT_CONTAINS(line, "take.db3: ");
    EXPECT_CONTAINS(line, part);
    EXPECT_LT(line.size(), 500u);
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
}

TEST(Database, APngThatLiesIsRefused) {
  const std::filesystem::path file = take_file() + ".png";
  sensing::write_png16(file, 16, 8, std::vector<std::uint16_t>(16 * 8, 5));
  const std::string whole = read_text(file);
  const auto said = [&](std::size_t length, std::size_t at, char value) {
    Bytes bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
    bytes[at] = static_cast<std::uint8_t>(value);
    MadeUpDatabase database;
    database.png = bytes;
    return error_of([&] { play(written(database)); });
  };
  EXPECT_CONTAINS(said(whole.size(), 18, 1), "its image is a broken PNG file");  // its checksum is wrong
  EXPECT_CONTAINS(said(whole.size() - 30, 0, whole[0]), "its image is a broken PNG file");
  EXPECT_CONTAINS(said(whole.size(), 33, 0x7f), "its image is a broken PNG file: chunk IDAT promises");
  sensing::write_png8(file, 16, 8, std::vector<std::uint8_t>(16 * 8, 5));
  const std::string grey = read_text(file);
  MadeUpDatabase database;
  database.png = Bytes(grey.begin(), grey.end());
  EXPECT_REFUSED(play(written(database)), "its image is a 8-bit grey PNG, but a depth image must be 16-bit grey");
}

TEST(Database, TablesThatAreComputedAreRefused) {
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{"ALTER TABLE messages RENAME TO kept",
        "CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i AS rowid, 1 "
        "AS "
        "topic_id, i AS timestamp, zeroblob(1000000) AS data FROM n"},
       "messages is not a plain table"},
      {{"ALTER TABLE topics RENAME TO kept", "CREATE VIEW Topics AS SELECT * FROM kept"},
       "topics is not a plain table"},
      {{"DROP TABLE messages", "CREATE VIRTUAL TABLE messages USING fts4(topic_id, timestamp, data)"},
       "messages is not a plain table"},
      {{"DROP TABLE messages",
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data AS (zeroblob(60000000)))"},
       "messages has a computed column"},
      {{"DROP TABLE messages", "CREATE TABLE messages(id PRIMARY KEY, topic_id, timestamp, data) WITHOUT ROWID"},
       "no such column: rowid"},
  };
  for (const auto& [more, part] : cases) {
    MadeUpDatabase database;
    database.more = more;
    EXPECT_REFUSED(play(written(database)), part);
  }
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i)
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

void put_big_endian(std::string& bytes, std::size_t at, std::size_t count, std::uint32_t value) {
  for (std::size_t i = 0; i < count; ++i)
    bytes[at + i] = static_cast<char>(value >> 8 * (count - 1 - i));
}

/// A database whose table with that root has the same rows over and over: each of ten further pages refers 300 times to
/// the one below it.
std::string endless(const MadeUpDatabase& database, std::size_t root) {
  constexpr std::size_t page = 4096, cells = 300, levels = 10;
  std::string bytes = read_text(written(database));
  const std::size_t pages = bytes.size() / page;
  bytes += bytes.substr((root - 1) * page, page);
  for (std::size_t level = 0; level <= levels; ++level) {
    std::string node(page, '\0');
    const auto below = static_cast<std::uint32_t>(pages + 1 + level);
    std::size_t content = page;
    for (std::size_t cell = 0; cell < cells; ++cell) {
      content -= 5;
      put_big_endian(node, content, 4, below);
      node[content + 4] = 100;  // the largest row below it
      put_big_endian(node, 12 + 2 * cell, 2, static_cast<std::uint32_t>(content));
    }
    node[0] = 5;
    put_big_endian(node, 3, 2, cells);
    put_big_endian(node, 5, 2, static_cast<std::uint32_t>(content));
    put_big_endian(node, 8, 4, below);
    level == levels ? bytes.replace((root - 1) * page, page, node) : bytes += node;
  }
  put_big_endian(bytes, 28, 4, static_cast<std::uint32_t>(bytes.size() / page));
  return bytes;
}

TEST(Database, RowsThatNeverEndAreRefused) {
  constexpr std::size_t topics = 2, messages = 3;  // the tables' roots
  write_text(take_file(), endless({}, topics));
  EXPECT_REFUSED(play(take_file()), "there are more than 10000 topics");
  MadeUpDatabase database;
  database.times_s.clear();
  write_text(take_file(), endless(database, messages));
  EXPECT_REFUSED(play(take_file()), "is a broken database: its messages are not in order");
  database.more = {"DELETE FROM messages WHERE topic_id > 1"};  // none that palpa reads
  write_text(take_file(), endless(database, messages));
  EXPECT_REFUSED(play(take_file()), "is a broken database: its pages refer to the same ones over and over");
}

TEST(Database, CutAnywhereItSaysThatItWasCut) {
  const std::string whole = read_text(written({}));
  ASSERT_EQ(big_endian(whole, 28, 4) * big_endian(whole, 16, 2), whole.size());
  for (std::size_t length = 16; length < whole.size(); length += 997) {
    write_text(take_file(), whole.substr(0, length));
    EXPECT_REFUSED(play(take_file()), "take.db3: was cut short");
  }
}

TEST(Database, BrokenAnywhereItIsRefusedOrPlayed) {
  std::mt19937 random(11);
  std::size_t refused = 0, played = 0;
  const std::string whole = read_text(written({}));
  stderr_of([&] {
    for (int i = 0; i < 250; ++i) {
      std::string broken = whole;
      for (std::uint32_t n = 1 + random() % 20; n > 0; --n)
        broken[16 + random() % (broken.size() - 16)] = static_cast<char>(random());
      write_text(take_file(), broken);
      const Error error = palpa::test::thrown_by([&] {
        for (const sensing::FrameSet& set : play(take_file()))
          EXPECT_EQ(set.frames[0].depth.size() % 8, 0u);
      });
      EXPECT_TRUE(error.code() == Exit::ok || error.code() == Exit::bad_input) << error.what();
      ++(error.code() == Exit::ok ? played : refused);
    }
  });
  EXPECT_GT(refused, 50u);
  EXPECT_GT(played, 50u);
}

TEST(Database, NothingIsWrittenBesideItAndAJournalThatIsThereIsTold) {
  MadeUpDatabase database;
  database.more = {"PRAGMA journal_mode = WAL", "PRAGMA user_version = 1"};
  const std::string file = written(database), before = read_text(file);
  EXPECT_EQ(stderr_of([&] { EXPECT_EQ(play(file).size(), 4u); }), "");
  EXPECT_EQ(read_text(file), before);
  for (const char* kind : {"-wal", "-journal", "-shm"})
    EXPECT_FALSE(std::filesystem::exists(file + kind));
  write_text(file + "-wal", "frames that are not in the database yet");
  EXPECT_CONTAINS(stderr_of([&] { EXPECT_EQ(play(file).size(), 4u); }),
                  "its recorder ended too soon: palpa does not read what is in " + file + "-wal");
  std::filesystem::remove(file + "-wal");
}

}  // namespace
}  // namespace palpa::driver::rosbag
