#include "driver/guard/brief.hpp"

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "base/error.hpp"

namespace palpa::driver {
namespace {

/// Must change whenever the data below or in the channel changes: palpa and its guard must be of one build.
constexpr std::uint64_t mark = 0x70616c7061'0006;

class Writer {
 public:
  template <typename T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* first = reinterpret_cast<const std::byte*>(&v);
    bytes.insert(bytes.end(), first, first + sizeof v);
  }
  void text(const std::string& t) {
    value(std::uint64_t{t.size()});
    const auto* first = reinterpret_cast<const std::byte*>(t.data());
    bytes.insert(bytes.end(), first, first + t.size());
  }
  std::vector<std::byte> bytes;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}
  template <typename T>
  T value() {
    static_assert(std::is_trivially_copyable_v<T>);
    T v;
    std::memcpy(&v, next(sizeof v), sizeof v);
    return v;
  }
  std::string text() {
    const auto size = value<std::uint64_t>();
    return {reinterpret_cast<const char*>(next(size)), size};
  }
  /// Reads a number of items that take at least `each` bytes each.
  std::size_t count(std::size_t each) {
    const auto n = value<std::uint64_t>();
    if (n > rest_.size() / each) refuse();
    return n;
  }

 private:
  [[noreturn]] static void refuse() { throw failure("palpa-guard was started by another version of palpa"); }
  const std::byte* next(std::size_t size) {
    if (size > rest_.size()) refuse();
    const std::byte* at = rest_.data();
    rest_ = rest_.subspan(size);
    return at;
  }
  std::span<const std::byte> rest_;
};

void write(Writer& out, const array::Layout& layout) {
  out.text(layout.name);
  out.value(std::uint64_t{layout.transducers.size()});
  for (const array::Transducer& transducer : layout.transducers)
    out.value(transducer);
  out.value(std::uint64_t{layout.boards.size()});
  for (const array::Board& board : layout.boards) {
    out.text(board.type);
    out.value(board.first);
    out.value(board.count);
    out.value(board.width_m);
    out.value(board.height_m);
    out.value(board.T_layout_board);
  }
  out.value(layout.source_level_pa_m);
  out.value(layout.frequency_hz);
  out.value(layout.transducer_radius_m);
  out.value(layout.default_T_world_layout);
}

array::Layout read_layout(Reader& in) {
  array::Layout layout;
  layout.name = in.text();
  layout.transducers.resize(in.count(sizeof(array::Transducer)));
  for (array::Transducer& transducer : layout.transducers)
    transducer = in.value<array::Transducer>();
  layout.boards.resize(in.count(sizeof(Transform)));
  for (array::Board& board : layout.boards) {
    board.type = in.text();
    board.first = in.value<std::uint32_t>();
    board.count = in.value<std::uint32_t>();
    board.width_m = in.value<double>();
    board.height_m = in.value<double>();
    board.T_layout_board = in.value<Transform>();
  }
  layout.source_level_pa_m = in.value<double>();
  layout.frequency_hz = in.value<double>();
  layout.transducer_radius_m = in.value<double>();
  layout.default_T_world_layout = in.value<Transform>();
  return layout;
}

void write(Writer& out, const BoardSpec& board) {
  out.text(board.argument);
  out.text(board.files);
  write(out, board.layout);
  out.value(board.slot_s);
  out.value(std::uint8_t{board.foci_move});
  out.value(board.sound_speed_m_s);
  out.value(board.ramp_s);
  out.value(std::uint8_t{board.steps});
  out.value(std::uint8_t{board.nulls});
}

BoardSpec read_board(Reader& in) {
  BoardSpec board;
  board.argument = in.text();
  board.files = in.text();
  board.layout = read_layout(in);
  board.slot_s = in.value<double>();
  board.foci_move = in.value<std::uint8_t>() != 0;
  board.sound_speed_m_s = in.value<double>();
  board.ramp_s = in.value<double>();
  board.steps = in.value<std::uint8_t>() != 0;
  board.nulls = in.value<std::uint8_t>() != 0;
  return board;
}

}  // namespace

std::vector<std::byte> to_bytes(const Brief& brief) {
  Writer out;
  out.value(mark);
  out.text(brief.kind);
  write(out, brief.board);
  out.value(std::uint8_t{brief.only_silence});
  return std::move(out.bytes);
}

Brief brief_from(std::span<const std::byte> bytes) {
  Reader in(bytes);
  if (in.value<std::uint64_t>() != mark) throw failure("palpa-guard was started by another version of palpa");
  Brief brief;
  brief.kind = in.text();
  brief.board = read_board(in);
  brief.only_silence = in.value<std::uint8_t>() != 0;
  return brief;
}

}  // namespace palpa::driver
