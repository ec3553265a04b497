#include "session/links/record_link.hpp"

#include <atomic>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/stream_writer.hpp"

namespace palpa::session {
namespace {

static_assert(std::endian::native == std::endian::little, "the file format is written as memory lies");
static_assert(sizeof(array::TransducerDrive) == 8);

constexpr char magic[8] = {'p', 'a', 'l', 'p', 'a', 'd', 'r', 'v'};
constexpr std::uint32_t version = 1;

struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t transducers;
  double slot_s;
};
static_assert(sizeof(Header) == 24);

template <typename T>
std::string_view text_of(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

/// The patience of a link: its drives are only useful now, so their reader has to be there first.
constexpr double link_patience_s = 0.5;

class RecordLink : public Link {
 public:
  RecordLink(const std::string& file, const LinkSetting& setting, const std::atomic<bool>* wait_unless)
      : wait_unless_(wait_unless),
        transducers_(setting.layout.transducers.size()),
        record_bytes_(sizeof(std::uint64_t) + transducers_ * sizeof(array::TransducerDrive)),
        writer_(opened(file, wait_unless, record_bytes_)) {
    Header header{{}, version, static_cast<std::uint32_t>(transducers_), setting.slot_s};
    std::memcpy(header.magic, magic, sizeof(magic));
    writer_.add(text_of(std::span<const Header>(&header, 1)));
    if (!flush()) writer_.fail_stalled();
    // If the disk becomes full, the data written so far must not end with a sounding drive.
    writer_.end_in_zeros(transducers_ * sizeof(array::TransducerDrive));
  }

  void plan(const PlayedPlan&) override {}
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    record_ = text_of(std::span<const std::uint64_t>(&slot, 1));
    record_ += text_of(drive);
    // Write a complete record or nothing, so that the rest stays readable. Room for the silence after a fault is kept
    // free.
    stalled_ = !add();
    if (stalled_) writer_.fail_stalled();
    written_ += sounds(drive) ? 1 : 0;
  }
  std::optional<Carried> carried() const override { return Carried{.completed = {.drives = written_}}; }
  void finish() override {
    if (!flush()) {
      close_stalled();
      writer_.fail_stalled();
    }
    writer_.close();
  }

 private:
  bool waits() const { return wait_unless_ && !*wait_unless_; }
  bool add() {
    if (waits() && writer_.add(record_, {.stop = wait_unless_})) return true;
    return stalled_ ? writer_.add(record_) : writer_.add(record_, {.seconds = StreamWriter::patience_s}, record_bytes_);
  }
  bool flush() { return (waits() && writer_.flush({.stop = wait_unless_})) || writer_.flush(); }
  /// Ends the file in silence now, without waiting for other slow parts of the program.
  void close_stalled() {
    try {
      writer_.close();
    } catch (const Error&) {  // the stall is the error to report
    }
  }

  /// A stalled reader must not get drives long after they are over; a stalled disk must have no effect on the sound.
  static constexpr std::size_t room_of_pipe = 1 << 18, room_of_disk = 1 << 25;

  static StreamWriter opened(const std::string& file, const std::atomic<bool>* wait_unless, std::size_t record_bytes) {
    Patience patience{.stop = wait_unless};
    if (wait_unless == nullptr) patience.seconds = link_patience_s;
    OpenFile out = open_output(file, patience);
    const std::size_t room = out.on_disk() ? room_of_disk : room_of_pipe;
    return {std::move(out), room + 4 * record_bytes};
  }

  const std::atomic<bool>* wait_unless_;
  std::size_t transducers_, record_bytes_;
  StreamWriter writer_;
  std::string record_;  ///< the record that is being written
  bool stalled_ = false;
  std::uint64_t written_ = 0;  ///< drives that sound
};

}  // namespace

std::unique_ptr<Link> open_record_link(const std::string& file, const LinkSetting& setting,
                                       const std::atomic<bool>* wait_unless) {
  if (file.empty()) throw bad_usage("link record needs a file: record:FILE");
  return std::make_unique<RecordLink>(file, setting, wait_unless);
}

}  // namespace palpa::session
