// A database of ROS 2 as RealSense Viewer writes it, but small, and broken in the ways that a test asks for.
#pragma once

#include <fmt/core.h>
#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "driver/cameras/made_up_bag.hpp"
#include "sensing/grey_png.hpp"
#include "support/files.hpp"

namespace palpa::driver::rosbag::test {

/// Values in little-endian CDR.
class Cdr {
 public:
  Bytes bytes{0, 1, 0, 0};

  template <typename Number>
  Cdr& number(Number value) {
    while ((bytes.size() - 4) % sizeof(Number) != 0)
      bytes.push_back(0);
    put(bytes, value);
    return *this;
  }
  Cdr& text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    bytes.insert(bytes.end(), value.begin(), value.end());
    bytes.push_back(0);
    return *this;
  }
  Cdr& header() { return number(std::uint32_t{1}).number(std::uint32_t{2}).text("Depth"); }
};

struct MadeUpDatabase {
  std::uint32_t width = 16, height = 8;
  std::string sensor = "/device_0/sensor_0", stream = "/Depth_0";
  std::string unit = "0.000100", info = "encoding=Z16;fps=30";
  std::optional<std::string> lens = lens_text("Brown Conrady", "0,0,0,0,0");  ///< as a text
  bool camera_info = true;                                                    ///< also after each image
  std::vector<double> coefficients{0, 0, 0, 0, 0};                            ///< of camera_info
  std::string format = "16UC1; compressedDepth png";
  bool plain = false;          ///< images are not compressed
  std::optional<Bytes> png{};  ///< of the last image, instead of what it shows
  Bytes last{};                ///< the whole message of the last image, instead
  std::vector<double> times_s{0.1, 0.1333, 0.1667, 0.2};
  std::vector<std::string> more{};  ///< SQL that is done at the end

  static std::string lens_text(const std::string& model, const std::string& coefficients) {
    return "width=16;height=8;fx=40;ppx=8;fy=41;ppy=4;model=" + model + ";coeffs=" + coefficients;
  }

  /// Writes it, over what is there.
  void write(const std::filesystem::path& file) const {
    std::filesystem::remove(file);
    sqlite3* database = nullptr;
    sqlite3_open(file.c_str(), &database);
    const auto run = [&](const std::string& sql) { sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr); };
    run("PRAGMA synchronous = OFF; PRAGMA journal_mode = MEMORY;"
        "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,serialization_format TEXT "
        "NOT "
        "NULL,offered_qos_profiles TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, data BLOB "
        "NOT NULL);"
        "CREATE INDEX timestamp_idx ON messages (timestamp ASC); BEGIN;");
    std::vector<std::string> topics;
    const auto write = [&](const std::string& topic, const std::string& type, double time_s, const Bytes& data) {
      auto at = std::ranges::find(topics, topic);
      if (at == topics.end()) {
        at = topics.insert(topics.end(), topic);
        run(fmt::format("INSERT INTO topics VALUES({}, '{}', '{}', 'cdr', '')", topics.size(), topic, type));
      }
      sqlite3_stmt* insert = nullptr;
      sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", -1, &insert,
                         nullptr);
      sqlite3_bind_int64(insert, 1, at - topics.begin() + 1);
      sqlite3_bind_int64(insert, 2, static_cast<sqlite3_int64>(time_s * 1e9 + 0.5));
      sqlite3_bind_blob64(insert, 3, data.data(), data.size(), SQLITE_TRANSIENT);
      sqlite3_step(insert);
      sqlite3_finalize(insert);
    };
    const std::string text_type = "std_msgs/msg/String", depth = sensor + stream;
    write("/file_version", "std_msgs/msg/UInt32", 0, Cdr().number(std::uint32_t{4}).bytes);
    write(depth + "/info", text_type, 0, Cdr().text(info).bytes);
    if (lens) write(depth + "/camera_info", text_type, 0, Cdr().text(*lens).bytes);
    write("/device_0/sensor_0/info", text_type, 0, Cdr().text("Name=Stereo Module").bytes);
    if (!unit.empty()) write(sensor + "/option/Depth_Units/value", text_type, 0, Cdr().text(unit).bytes);
    write("/device_0/sensor_1/Color_0/image/data/compressed", "sensor_msgs/msg/CompressedImage", 0.05, {1, 2, 3});
    for (std::size_t i = 0; i < times_s.size(); ++i) {
      const bool at_end = i + 1 == times_s.size();
      const Bytes image = at_end && !last.empty() ? last : plain ? plain_image(i) : png_image(i, at_end, file);
      write(depth + (plain ? "/image/data" : "/image/data/compressedDepth"),
            plain ? "sensor_msgs/msg/Image" : "sensor_msgs/msg/CompressedImage", times_s[i], image);
      write(depth + "/image/metadata", text_type, times_s[i], Cdr().text("depth_units=0.000100;").bytes);
      if (camera_info) write(depth + "/image/camera_info", "sensor_msgs/msg/CameraInfo", times_s[i], lens_message());
    }
    run("COMMIT");
    for (const std::string& sql : more)
      run(sql);
    sqlite3_close(database);
  }

 private:
  std::vector<std::uint16_t> depth_of(std::size_t frame) const {
    std::vector<std::uint16_t> depth;
    for (std::uint32_t p = 0; p < width * height; ++p)
      depth.push_back(MadeUpBag::depth_of(frame, p));
    return depth;
  }
  Bytes png_image(std::size_t frame, bool at_end, const std::filesystem::path& file) const {
    const std::string name = file.string() + ".png";
    sensing::write_png16(name, width, height, depth_of(frame));
    const std::string text = palpa::test::read_text(name);
    std::filesystem::remove(name);
    const Bytes whole(text.begin(), text.end());
    Bytes data(12, 7);
    put_bytes(data, at_end && png ? *png : whole);
    Cdr message;
    message.header().text(format).number(static_cast<std::uint32_t>(data.size()));
    put_bytes(message.bytes, data);
    return message.bytes;
  }
  Bytes plain_image(std::size_t frame) const {
    Cdr message;
    message.header().number(height).number(width).text("mono16").number(std::uint8_t{0}).number(2 * width + 6);
    message.number((2 * width + 6) * height);
    const std::vector<std::uint16_t> depth = depth_of(frame);
    for (std::uint32_t v = 0; v < height; ++v) {
      for (std::uint32_t u = 0; u < width; ++u)
        put(message.bytes, depth[v * width + u]);
      message.bytes.resize(message.bytes.size() + 6, 0xee);
    }
    return message.bytes;
  }
  Bytes lens_message() const {
    Cdr message;
    message.header().number(height).number(width).text("plumb_bob");
    message.number(static_cast<std::uint32_t>(coefficients.size()));
    for (const double k : coefficients)
      message.number(k);
    for (const double k : {40.0, 0.0, 8.0, 0.0, 41.0, 4.0, 0.0, 0.0, 1.0})
      message.number(k);
    return message.bytes;
  }
};

}  // namespace palpa::driver::rosbag::test
