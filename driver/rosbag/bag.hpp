// The messages of a ROS bag (format 2.0), in the order in which they lie in the file. The bag is read once from
// beginning to end and needs no index, so a bag that was cut short can be read as far as it goes.
// http://wiki.ros.org/Bags/Format/2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/files/input_file.hpp"
#include "driver/rosbag/message.hpp"

namespace palpa::driver::rosbag {

class Bag final : public MessageReader {
 public:
  /// A chunk, compressed or not, is held in memory whole. RealSense Viewer's chunks have a few megabytes.
  static constexpr std::uint64_t most_chunk_bytes = 64u << 20;

  /// Throws as InputFile does, and bad_input for a file that is not a bag of this format.
  explicit Bag(const std::string& file);

  /// Throws bad_input for broken records, chunks above most_chunk_bytes, and chunks compressed with anything but lz4.
  bool next(Message& message) override;
  /// "in the middle of a record", or "before its index", which a recorder writes last.
  const char* cut_short() const override { return cut_short_; }
  const std::string& file() const override { return in_.name(); }
  [[noreturn]] void fault(const std::string& what) const override;
  std::vector<std::string> topics() const override;

 private:
  struct Header;

  bool read_record();
  bool next_in_chunk(Message& message);
  void open_chunk(const Header& header, std::uint32_t bytes);
  void add_connection(const Header& header);
  bool read(std::vector<std::uint8_t>& into, std::uint64_t bytes);
  bool read_length(std::uint32_t& length);

  InputFile in_;
  std::uint64_t size_ = 0, at_ = 0, record_at_ = 0;
  const char* cut_short_ = nullptr;
  std::optional<std::uint64_t> index_at_{};      ///< 0 if the recorder did not write an index
  std::map<std::uint32_t, std::string> topics_;  ///< by connection
  std::vector<std::uint8_t> header_, packed_, chunk_;
  std::size_t chunk_at_ = 0;
};

}  // namespace palpa::driver::rosbag
