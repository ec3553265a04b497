// The messages of a recording of ROS 2 in a database of SQLite (.db3), as RealSense Viewer writes it since librealsense
// 2.58.1: a table of topics and one of messages. The database is read through an InputFile; SQLite opens, writes and
// locks nothing. Such a file may come from anybody: views, virtual tables and computed columns are refused, and what
// the file claims neither takes memory beyond a message's limit nor keeps palpa busy longer than the file is long.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "driver/rosbag/message.hpp"

namespace palpa::driver::rosbag {

/// A depth image of 4096x4096, uncompressed, has half of it.
inline constexpr std::uint64_t most_message_bytes = 64u << 20;

/// Whether a file that begins with these bytes is a database of SQLite.
bool is_database(const std::string& head);

/// Reads the messages that describe depth cameras and hold their images (see says_of()), and no others. CameraInfo
/// messages come first. Throws as InputFile does, and bad_input for a file that was cut short or is broken, for one
/// without the two tables, and for topics that MessageReader refuses. Warns of a journal beside it that its recorder
/// did not put into it.
std::unique_ptr<MessageReader> open_database(const std::string& file);

}  // namespace palpa::driver::rosbag
