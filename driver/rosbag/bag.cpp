#include "driver/rosbag/bag.hpp"

#include <fmt/core.h>
#include <lz4frame.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string_view>

#include "base/error.hpp"
#include "driver/rosbag/cursor.hpp"

namespace palpa::driver::rosbag {
namespace {

constexpr std::string_view magic = "#ROSBAG V2.0\n";
constexpr std::uint32_t most_header_bytes = 1u << 16;

void check_header(std::size_t bytes) {
  if (bytes > most_header_bytes)
    throw Malformed(fmt::format("a record's header has {} bytes; palpa takes at most {}", bytes, most_header_bytes));
}

enum Operation : std::uint8_t { message_data = 2, bag_header = 3, chunk_of_records = 5, connection = 7 };

constexpr const char* in_a_record = "in the middle of a record";

/// Fills `out`, which has the size given by the chunk, from LZ4 frames.
void unpack_lz4(std::span<const std::uint8_t> packed, std::span<std::uint8_t> out) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION))) throw Malformed("lz4 cannot be started");
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(made,
                                                                                     &LZ4F_freeDecompressionContext);
  while (!out.empty()) {
    std::size_t given = out.size(), taken = packed.size();
    const std::size_t result = LZ4F_decompress(context.get(), out.data(), &given, packed.data(), &taken, nullptr);
    if (LZ4F_isError(result))
      throw Malformed(fmt::format("a chunk's lz4 data is broken: {}", LZ4F_getErrorName(result)));
    if (given == 0 && taken == 0) throw Malformed("a chunk's lz4 data ends too soon");
    out = out.subspan(given);
    packed = packed.subspan(taken);
  }
}

}  // namespace

/// The fields of a record's header: name=value each.
struct Bag::Header {
  std::optional<std::uint8_t> operation{};
  std::optional<std::uint32_t> connection{}, size{};
  std::optional<std::uint64_t> index_at{};
  std::optional<double> time_s{};
  std::string_view topic{}, compression{};

  explicit Header(std::span<const std::uint8_t> bytes) {
    for (Cursor cursor(bytes); cursor.left() > 0;) {
      const std::span<const std::uint8_t> field = cursor.counted();
      const std::string_view text = Cursor::as_text(field);
      const std::size_t equals = text.find('=');
      if (equals == std::string_view::npos) throw Malformed("a field of a record's header has no value");
      const std::string_view name = text.substr(0, equals);
      Cursor value(field.subspan(equals + 1));
      if (name == "op") operation = value.take<std::uint8_t>();
      if (name == "conn") connection = value.take<std::uint32_t>();
      if (name == "size") size = value.take<std::uint32_t>();
      if (name == "index_pos") index_at = value.take<std::uint64_t>();
      if (name == "topic") topic = text.substr(equals + 1);
      if (name == "compression") compression = text.substr(equals + 1);
      if (name == "time") {
        const auto seconds = value.take<std::uint32_t>();
        time_s = seconds + value.take<std::uint32_t>() * 1e-9;
      }
    }
    if (!operation) throw Malformed("a record does not say what it is");
  }
};

Bag::Bag(const std::string& file) : in_(file), size_(in_.size()) {
  std::vector<std::uint8_t> begin;
  if (!read(begin, magic.size()) || Cursor::as_text(begin) != magic) {
    throw bad_input(
        file,
        "is neither a database of SQLite nor a bag of format 2.0, which begins with #ROSBAG V2.0; RealSense "
        "Viewer records .db3, and .bag before its version 2.58.1");
  }
}

void Bag::fault(const std::string& what) const {
  throw bad_input(file(), fmt::format("byte {}: {}", record_at_, what));
}

std::vector<std::string> Bag::topics() const {
  std::vector<std::string> names;
  for (const auto& [connection, topic] : topics_)
    names.push_back(topic);
  return names;
}

bool Bag::read(std::vector<std::uint8_t>& into, std::uint64_t bytes) {
  // A length is not trusted until the file is known to have that many bytes.
  if (bytes > size_ - at_) {
    cut_short_ = in_a_record;
    return false;
  }
  into.resize(bytes);
  in_.read_at(at_, into);
  at_ += bytes;
  return true;
}

bool Bag::read_length(std::uint32_t& length) {
  std::array<std::uint8_t, 4> bytes{};
  if (size_ - at_ < bytes.size()) {
    cut_short_ = in_a_record;
    return false;
  }
  in_.read_at(at_, bytes);
  at_ += bytes.size();
  length = Cursor(bytes).take<std::uint32_t>();
  return true;
}

void Bag::add_connection(const Header& header) {
  if (!header.connection || header.topic.empty()) throw Malformed("a connection has no number or no topic");
  if (header.topic.size() > most_topic_bytes)
    throw Malformed(fmt::format("a topic has a name of {} bytes", header.topic.size()));
  if (topics_.size() >= most_topics && !topics_.contains(*header.connection))
    throw Malformed(fmt::format("there are more than {} connections", most_topics));
  topics_[*header.connection] = std::string(header.topic);
}

void Bag::open_chunk(const Header& header, std::uint32_t bytes) {
  if (!header.size) throw Malformed("a chunk does not say its size");
  if (*header.size == 0 && bytes == 0) {  // its recorder would have written both at its end
    cut_short_ = in_a_record;
    return;
  }
  if (*header.size > most_chunk_bytes || bytes > most_chunk_bytes)
    throw Malformed(
        fmt::format("a chunk has {} bytes; palpa takes at most {}", std::max(*header.size, bytes), most_chunk_bytes));
  const std::string compression(header.compression);
  chunk_at_ = 0;
  if (compression == "none") {
    if (!read(chunk_, bytes)) chunk_.clear();
    return;
  }
  if (compression != "lz4") {
    throw Malformed(fmt::format("a chunk is compressed with {}; palpa reads only lz4 and none: run rosbag decompress",
                                compression.empty() ? "an unknown method" : compression));
  }
  const std::uint32_t unpacked = *header.size;
  if (!read(packed_, bytes)) {
    chunk_.clear();
    return;
  }
  chunk_.resize(unpacked);
  unpack_lz4(packed_, chunk_);
}

bool Bag::read_record() {
  record_at_ = at_;
  std::uint32_t bytes = 0;
  if (at_ == size_) {
    if (index_at_ && (*index_at_ == 0 || *index_at_ >= size_)) cut_short_ = "before its index";
    return false;
  }
  if (!read_length(bytes)) return false;
  check_header(bytes);
  if (!read(header_, bytes) || !read_length(bytes)) return false;
  const Header header(header_);
  if (*header.operation == connection) add_connection(header);
  if (*header.operation == bag_header) index_at_ = header.index_at;
  if (*header.operation == chunk_of_records) {
    open_chunk(header, bytes);
    return !cut_short_;
  }
  // Indices and the like are not needed.
  if (bytes > size_ - at_) {
    cut_short_ = in_a_record;
    return false;
  }
  at_ += bytes;
  return true;
}

bool Bag::next_in_chunk(Message& message) {
  while (chunk_at_ < chunk_.size()) {
    Cursor cursor(std::span<const std::uint8_t>(chunk_).subspan(chunk_at_));
    const std::size_t before = cursor.left();
    const std::span<const std::uint8_t> fields = cursor.counted();
    check_header(fields.size());
    const Header header(fields);
    const std::span<const std::uint8_t> data = cursor.counted();
    chunk_at_ += before - cursor.left();
    if (*header.operation == connection) add_connection(header);
    if (*header.operation != message_data) continue;
    if (!header.connection || !header.time_s) throw Malformed("a message has no connection or no time");
    const auto topic = topics_.find(*header.connection);
    if (topic == topics_.end()) throw Malformed("a message of a connection that was never described");
    message = {&topic->second, *header.time_s, data, Encoding::ros};
    return true;
  }
  return false;
}

bool Bag::next(Message& message) {
  try {
    while (!next_in_chunk(message)) {
      if (!read_record()) return false;
    }
    return true;
  } catch (const Malformed& malformed) {
    fault(malformed.what());
  }
}

}  // namespace palpa::driver::rosbag
