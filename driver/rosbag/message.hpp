// What a recording of a RealSense camera says, message by message: a bag of ROS (bag.hpp), or a database of ROS 2
// (database.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace palpa::driver::rosbag {

/// How the values of a message follow each other: ROS's way, or that of ROS 2 (CDR).
enum class Encoding { ros, cdr };

/// Valid until the next one is read.
struct Message {
  const std::string* topic = nullptr;
  double time_s = 0;  ///< when it was recorded
  std::span<const std::uint8_t> data;
  Encoding encoding = Encoding::ros;
};

/// More is refused.
inline constexpr std::size_t most_topics = 10'000, most_topic_bytes = 256;

/// Goes through a file once, from beginning to end.
class MessageReader {
 public:
  virtual ~MessageReader() = default;
  /// Returns false at the end. Throws bad_input that names file, place and fault.
  virtual bool next(Message& message) = 0;
  /// Where the file was cut short; null if it was not, or if its end is not reached.
  virtual const char* cut_short() const = 0;
  virtual const std::string& file() const = 0;
  /// Throws an Error that names where next() read last.
  [[noreturn]] virtual void fault(const std::string& what) const = 0;
  /// The topics that are known so far.
  virtual std::vector<std::string> topics() const = 0;
};

}  // namespace palpa::driver::rosbag
