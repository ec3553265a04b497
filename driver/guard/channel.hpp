// What a loop and its guard share: memory with the newest drive and the newest plan, and a socket. The loop writes into
// memory that only it sees, and hands it over in one step. A guard therefore sees only whole drives, no matter when the
// loop is ended. The socket announces a drive and carries a board's notes back. When the socket closes, the other side
// is gone.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "array/transducer_drive.hpp"
#include "base/math.hpp"
#include "base/system/descriptor.hpp"
#include "driver/board.hpp"
#include "session/links/hand_over.hpp"

namespace palpa::driver {

/// Three places for a value in shared memory. They take turns as the writer's, the waiting one and the reader's, as
/// session::Newest does between threads. Neither side waits. A value that was not taken is replaced.
class TripleBuffer {
 public:
  void init() { waiting_ = 1; }
  struct Committed {
    std::uint32_t place;  ///< where to write next
    bool unread;          ///< the value that waited before was not taken
  };
  /// Writer: the value that it has written at `mine` waits from now on.
  Committed commit(std::uint32_t mine) {
    const std::uint32_t before = waiting_.exchange(mine | fresh, std::memory_order_acq_rel);
    return {before & place, (before & fresh) != 0};
  }
  /// Reader: the place of the newest value, if it is new, in exchange for its own.
  std::optional<std::uint32_t> take(std::uint32_t mine) {
    if (!(waiting_.load(std::memory_order_relaxed) & fresh)) return std::nullopt;
    return waiting_.exchange(mine, std::memory_order_acq_rel) & place;
  }
  static constexpr std::uint32_t writers_first = 0, readers_first = 2;

 private:
  static constexpr std::uint32_t place = 3, fresh = 4;
  std::atomic<std::uint32_t> waiting_;
  static_assert(std::atomic<std::uint32_t>::is_always_lock_free);
};

struct DriveHead {
  std::uint64_t slot;
  double until_s;               ///< it may sound until then at most, on CLOCK_MONOTONIC
  std::uint32_t is_in_pattern;  ///< if not 0, the newest plan is a pattern that has it at that slot
};
struct PlanHead {
  TimedSlots timed;
  std::uint32_t foci;  ///< how many there are, see BoardPlan
};

/// The guard's counts of drives and plans that sound, and whether its board is out of reach. The loop may read them at
/// any time.
class Tally {
 public:
  /// For the guard: `taken` is what it has taken from the loop, and `counts` are its board's.
  void tell(const session::Passed& taken, const BoardCounts& counts);
  /// For the loop.
  session::Carried read() const;

 private:
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
  /// In the order of the hand-overs: drives, then plans of each; then the drives that came too soon, whether the
  /// board is out of reach, and one more than the frames that were late, or 0.
  std::array<std::atomic<std::uint64_t>, 9> values_;
};

/// The shared memory: the guard's Brief, drives, and plans if the board plays any.
class SharedMemory {
 public:
  /// Throws failure() if there is no memory.
  static SharedMemory make(std::span<const std::byte> brief, std::size_t transducers, std::uint32_t most_cycle);
  /// The memory that the other process has made. Throws failure() for any other descriptor.
  static SharedMemory of(Descriptor fd);
  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory& operator=(SharedMemory&&) = delete;
  ~SharedMemory();

  int fd() const { return fd_.get(); }
  std::span<const std::byte> brief() const;

  template <typename Head>
  struct Place {
    Head& head;
    std::span<array::TransducerDrive> drives;  ///< all that there is room for
  };
  Place<DriveHead> drive(std::uint32_t place) const;
  struct PlanPlace {
    PlanHead& head;
    std::span<Vec3> foci;  ///< one for each drive that there is room for
    std::span<array::TransducerDrive> drives;
  };
  PlanPlace plan(std::uint32_t place) const;
  TripleBuffer& drive_buffer() const;
  TripleBuffer& plan_buffer() const;
  Tally& tally() const;

 private:
  struct Head;
  SharedMemory(Descriptor fd, std::size_t size);
  const Head& head() const { return *reinterpret_cast<const Head*>(base_); }
  template <typename T>
  T& at(std::size_t offset) const {
    return *reinterpret_cast<T*>(base_ + offset);
  }

  Descriptor fd_;
  std::byte* base_ = nullptr;
  std::size_t size_ = 0;
};

/// What loop and guard say to each other. One message each.
enum class MessageKind : char {
  drive = 'd',  ///< from the loop: there is another drive
  /// All others are from the guard.
  opened = 'o',   ///< the board is there
  refused = 'r',  ///< the exit code, then the line of the Error
  warning = 'w',
  info = 'i',
  waits = 'b',           ///< opening is slow; a line that is written at once
  asked_to_leave = 't',  ///< SIGTERM: the board is silent, and the guard ends
  silent = 's',          ///< the last thing on the wire was all-off
  unsure = 'u',          ///< it should be, but it is not known whether it arrived
};

struct Message {
  static constexpr std::size_t most = 512;  ///< longer lines are cut
  MessageKind kind;
  std::string_view text;
};

/// Never waits. A message that does not fit is dropped. Returns false if the other side is gone.
bool send_message(int socket, MessageKind kind, std::string_view text = {});
enum class Received { message, nothing, gone };
/// Takes the next message, if there is one; it stays valid until the next call.
Received receive_message(int socket, std::span<char, Message::most + 1> buffer, Message& message);

}  // namespace palpa::driver
