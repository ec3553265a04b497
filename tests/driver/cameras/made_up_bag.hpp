// A ROS bag as RealSense Viewer writes it, but small, and broken in the ways that a test asks for.
#pragma once

#include <lz4frame.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace palpa::driver::rosbag::test {

using Bytes = std::vector<std::uint8_t>;

template <typename Number>
void put(Bytes& out, Number value) {
  std::uint8_t bytes[sizeof(Number)];
  std::memcpy(bytes, &value, sizeof(Number));
  out.insert(out.end(), bytes, bytes + sizeof(Number));
}
inline void put_bytes(Bytes& out, const Bytes& bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}
inline void put_text(Bytes& out, const std::string& text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  out.insert(out.end(), text.begin(), text.end());
}

/// One record: fields "name=value", then data, each preceded by its length.
class Record {
 public:
  template <typename Number>
  Record& field(const std::string& name, Number value) {
    Bytes bytes;
    put(bytes, value);
    return text(name, std::string(bytes.begin(), bytes.end()));
  }
  Record& time(double seconds) {
    const auto whole = static_cast<std::uint32_t>(seconds);
    Bytes bytes;
    put(bytes, whole);
    put(bytes, static_cast<std::uint32_t>((seconds - whole) * 1e9));
    return text("time", std::string(bytes.begin(), bytes.end()));
  }
  Record& text(const std::string& name, const std::string& value) {
    put_text(header_, name + "=" + value);
    return *this;
  }
  Bytes with(const Bytes& data) const {
    Bytes out;
    put(out, static_cast<std::uint32_t>(header_.size()));
    put_bytes(out, header_);
    put(out, static_cast<std::uint32_t>(data.size()));
    put_bytes(out, data);
    return out;
  }

 private:
  Bytes header_;
};

struct MadeUpBag {
  std::uint32_t width = 16, height = 8;
  float unit_m = 0.0001f;
  std::uint32_t rate_hz = 30;
  std::uint32_t padding = 0;  ///< bytes after each row
  std::uint32_t missing = 0;  ///< bytes of each image
  std::string compression = "lz4";
  std::string encoding = "mono16", lens_model = "Brown Conrady";
  std::vector<double> distortion{0, 0, 0, 0, 0};
  double fx = 40;
  std::string unit_topic = "/device_0/sensor_0/option/Depth_Units/value", more_topic = "/more";
  float last_unit_m = 0;          ///< given before the last image; 0: not given
  bool lens = true, unit = true;  ///< what the bag has
  /// A second depth camera, device_1, whose description and images are those of that bag; its images come first or
  /// last.
  const MadeUpBag* other = nullptr;
  bool other_first = false;
  std::vector<double> times_s{0.1, 0.1333, 0.1667, 0.2};

  static std::uint16_t depth_of(std::size_t frame, std::uint32_t pixel) {
    return static_cast<std::uint16_t>(1000 * (frame + 1) + pixel);
  }

  Bytes bytes() const {
    Bytes begin;
    put_bytes(begin, describe(0, "/device_0/sensor_0/Depth_0/info"));
    put_bytes(begin, describe(1, "/device_0/sensor_0/Depth_0/info/camera_info"));
    put_bytes(begin, describe(2, unit_topic));
    put_bytes(begin, describe(3, "/device_0/sensor_0/Depth_0/image/data"));
    put_bytes(begin, describe(4, "/device_0/sensor_1/Color_0/image/data"));
    put_bytes(begin, describe(5, "/device_0/sensor_0/Depth_0/image/metadata"));
    put_bytes(begin, describe(6, "/device_1/sensor_0/Depth_0/image/data"));
    put_bytes(begin, describe(7, "/device_1/sensor_0/Depth_0/info/camera_info"));
    put_bytes(begin, describe(8, more_topic));
    put_bytes(begin, describe(9, "/device_1/sensor_0/Depth_0/info"));
    put_bytes(begin, describe(10, "/device_1/sensor_0/option/Depth_Units/value"));
    Bytes number;
    put_bytes(begin, description(0, 1, 2));
    if (other) put_bytes(begin, other->description(9, 7, 10));
    put_bytes(begin, message(4, 0, {1, 2, 3}));
    const std::string magic = "#ROSBAG V2.0\n";
    Bytes out(magic.begin(), magic.end());
    const std::size_t header_at = out.size();
    put_bytes(out, bag_header(0));
    put_bytes(out, chunk(begin));
    for (std::size_t i = 0; i < times_s.size(); ++i) {
      Bytes frame;
      if (last_unit_m > 0 && i + 1 == times_s.size()) {
        number.clear();
        put(number, last_unit_m);
        put_bytes(frame, message(2, times_s[i], number));
      }
      const Bytes others = other ? message(6, times_s[i], other->image(i + 20)) : Bytes();
      if (other_first) put_bytes(frame, others);
      put_bytes(frame, message(3, times_s[i], image(i)));
      put_bytes(frame, message(5, times_s[i], {9, 9}));
      if (!other_first) put_bytes(frame, others);
      put_bytes(out, chunk(frame));
      put_bytes(out, Record().field<std::uint8_t>("op", 4).field<std::uint32_t>("conn", 3).with(Bytes(12, 7)));
    }
    const Bytes known = bag_header(out.size());
    std::ranges::copy(known, out.begin() + static_cast<std::ptrdiff_t>(header_at));
    put_bytes(out, index());
    return out;
  }

  /// `index_at`: the byte at which the index begins.
  static Bytes bag_header(std::uint64_t index_at) {
    return Record().field<std::uint8_t>("op", 3).field("index_pos", index_at).with(Bytes(100, ' '));
  }
  /// The end of a bag: its connections, and where its chunks are.
  static Bytes index() {
    Bytes out = describe(3, "/device_0/sensor_0/Depth_0/image/data");
    put_bytes(out, Record().field<std::uint8_t>("op", 6).with(Bytes(8, 7)));
    return out;
  }

  /// The rate, the lens and the depth unit, in these connections.
  Bytes description(std::uint32_t rate_at, std::uint32_t lens_at, std::uint32_t unit_at) const {
    Bytes out, number;
    put(number, rate_hz);
    put_text(number, encoding);
    put_bytes(out, message(rate_at, 0, number));
    if (lens) put_bytes(out, message(lens_at, 0, camera_info()));
    number.clear();
    put(number, unit_m);
    if (unit) put_bytes(out, message(unit_at, 0, number));
    return out;
  }

  Bytes camera_info() const {
    Bytes out = header();
    put(out, height);
    put(out, width);
    put_text(out, lens_model);
    put(out, static_cast<std::uint32_t>(distortion.size()));
    for (const double k : distortion)
      put(out, k);
    for (const double k : {fx, 0.0, width / 2.0, 0.0, fx + 1, height / 2.0, 0.0, 0.0, 1.0})
      put(out, k);
    return out;
  }

  Bytes image(std::size_t frame) const {
    Bytes out = header();
    put(out, height);
    put(out, width);
    put_text(out, encoding);
    put(out, std::uint8_t{0});
    put(out, width * 2 + padding);
    put(out, (width * 2 + padding) * height - missing);
    for (std::uint32_t v = 0; v < height; ++v) {
      for (std::uint32_t u = 0; u < width; ++u)
        put(out, depth_of(frame, v * width + u));
      out.resize(out.size() + padding, 0xee);
    }
    out.resize(out.size() - missing);
    return out;
  }

  Bytes chunk(const Bytes& records) const {
    Bytes packed = records;
    if (compression == "lz4") {
      packed.resize(LZ4F_compressFrameBound(records.size(), nullptr));
      packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), records.data(), records.size(), nullptr));
    }
    return Record()
        .field<std::uint8_t>("op", 5)
        .text("compression", compression)
        .field("size", static_cast<std::uint32_t>(records.size()))
        .with(packed);
  }

  static Bytes header() {
    Bytes out;
    put(out, std::uint32_t{1});
    put(out, std::uint64_t{2});
    put_text(out, "camera");
    return out;
  }
  static Bytes describe(std::uint32_t connection, const std::string& topic) {
    Bytes data;
    put_text(data, "topic=" + topic);
    return Record().field<std::uint8_t>("op", 7).field("conn", connection).text("topic", topic).with(data);
  }
  static Bytes message(std::uint32_t connection, double time_s, const Bytes& data) {
    return Record().field<std::uint8_t>("op", 2).field("conn", connection).time(time_s).with(data);
  }
};

}  // namespace palpa::driver::rosbag::test
