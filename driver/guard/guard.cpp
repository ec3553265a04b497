#include "driver/guard/guard.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <limits>
#include <optional>
#include <vector>

#include "base/error.hpp"
#include "base/system/descriptor.hpp"
#include "base/system/now.hpp"
#include "base/system/real_time.hpp"
#include "driver/guard/brief.hpp"
#include "driver/guard/channel.hpp"
#include "session/links/hand_over.hpp"

namespace palpa::driver {
namespace {

constexpr std::size_t most_watched = 16;
constexpr long tend_ns = 5'000'000;

volatile std::sig_atomic_t asked_to_leave = 0;

void leave(int) {
  asked_to_leave = 1;
}

/// Signals that must not end the guard are ignored. Signals that ask it to leave set a flag, and are let through only
/// while it waits.
void set_signals() {
  struct sigaction action {};
  sigemptyset(&action.sa_mask);
  action.sa_handler = SIG_IGN;
  for (const int signal : {SIGINT, SIGHUP, SIGPIPE, SIGTSTP, SIGTTIN, SIGTTOU})
    sigaction(signal, &action, nullptr);
  action.sa_handler = leave;
  sigset_t blocked;
  sigemptyset(&blocked);
  for (const int signal : {SIGTERM, SIGQUIT}) {
    sigaction(signal, &action, nullptr);
    sigaddset(&blocked, signal);
  }
  sigprocmask(SIG_SETMASK, &blocked, nullptr);
}

/// Takes memory that libusb and the C library will need, so that it is locked with the rest. Later mappings are not
/// locked: beyond the limit (RLIMIT_MEMLOCK), those would be refused instead of being slow.
void take_spare_memory() {
  constexpr std::size_t spare = 1 << 20;
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());  // the heap keeps what it has
  mallopt(M_MMAP_THRESHOLD, 2 * spare);
  void* volatile some = std::malloc(spare);
  std::free(some);
}

class Notes final : public BoardNotes {
 public:
  void warning(std::string_view line) noexcept override { send_message(guard_socket, MessageKind::warning, line); }
  void info(std::string_view line) noexcept override { send_message(guard_socket, MessageKind::info, line); }
  void waits(std::string_view line) noexcept override { send_message(guard_socket, MessageKind::waits, line); }
};

/// Copies what the other process wrote. A transducer with anything but an amplitude and a phase is silent.
void copy_sound(std::span<const array::TransducerDrive> from, std::span<array::TransducerDrive> to) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    const auto [amplitude, phase] = from[i];
    const bool sane = amplitude > 0 && amplitude <= 1 && std::isfinite(phase);
    to[i] = sane ? from[i] : array::TransducerDrive{0.0f, std::isfinite(phase) ? phase : 0.0f};
  }
}

/// Passes drives and plans from a loop to a board.
class Guard {
 public:
  Guard(const SharedMemory& memory, bool plays_plans, double slot_s)
      : memory_(memory), plays_plans_(plays_plans), slot_s_(slot_s), drive_(memory.drive(0).drives.size()) {
    if (!plays_plans) return;
    plan_.resize(memory.plan(0).drives.size());
    foci_.resize(memory.plan(0).foci.size());
  }

  /// Runs until the loop is gone or a signal asks the guard to leave. Leaves the board as it sounds.
  MessageKind watch(Board& board) {
    while (true) {
      wait(board);
      if (asked_to_leave) return MessageKind::asked_to_leave;
      if (!listen()) return MessageKind::silent;
      play_newest(board);
      if (sounding_ && is_overdue(monotonic_s(), heard_s_, until_s_, slot_s_)) {
        board.all_off();
        sounding_ = false;
      }
      board.tend();
      tell_counts(board);
    }
  }

  /// Tells the board's counts to the loop.
  void tell_counts(const Board& board) const { memory_.tally().tell(taken_, board.counts()); }

 private:
  static void wait(Board& board) {
    std::array<pollfd, 1 + most_watched> fds{{{guard_socket, POLLIN, 0}}};
    const std::span<const pollfd> watched = board.watched();
    const std::size_t count = std::min(watched.size(), most_watched);
    std::copy_n(watched.begin(), count, fds.begin() + 1);
    const timespec at_most{0, tend_ns};
    sigset_t none;
    sigemptyset(&none);
    ppoll(fds.data(), 1 + count, &at_most, &none);
  }

  /// Takes the loop's messages, which only say that there is something. Returns false if the loop is gone.
  static bool listen() {
    std::array<char, Message::most + 1> buffer{};
    Message message{};
    while (true) {
      const Received received = receive_message(guard_socket, buffer, message);
      if (received == Received::gone) return false;
      if (received == Received::nothing) return true;
    }
  }

  void play_newest(Board& board) {
    // The loop writes a plan before the drives that belong to it. Taken in the opposite order, no drive comes before
    // its plan.
    const std::optional<std::uint32_t> drive = memory_.drive_buffer().take(drive_place_);
    if (plays_plans_) take_plan(board);
    if (!drive) return;
    drive_place_ = *drive;
    heart_beats();
    const auto newest = memory_.drive(drive_place_);
    if (newest.head.slot < planned_from_) return;  // it is older than the plan that is there already
    until_s_ = newest.head.until_s;
    copy_sound(newest.drives, drive_);
    const bool sounds = session::sounds(drive_);
    taken_.drives += sounds ? 1 : 0;
    if (!sounds && newest.head.is_in_pattern != 0) return;  // a pause that the board makes by its own clock
    board.play(newest.head.slot, drive_);
  }

  /// Also called for a plan, which may make a board sound before its first drive comes.
  void heart_beats() {
    heard_s_ = monotonic_s();
    sounding_ = true;
  }

  void take_plan(Board& board) {
    const std::optional<std::uint32_t> plan = memory_.plan_buffer().take(plan_place_);
    if (!plan) return;
    plan_place_ = *plan;
    const auto newest = memory_.plan(plan_place_);
    const TimedSlots& timed = newest.head.timed;
    const session::Cycle& cycle = timed.slots.cycle;
    const std::size_t size = drive_.size() * cycle.length;
    if (size > plan_.size() || cycle.is_listed() != (cycle.length > 0)) return;
    planned_from_ = timed.slots.from;
    until_s_ = timed.until_s();
    const std::span<array::TransducerDrive> drives(plan_.data(), size);
    copy_sound(newest.drives, drives);
    taken_.plans += cycle.is_listed() ? 1 : 0;
    const std::size_t foci = newest.head.foci == cycle.length ? cycle.length : 0;
    std::copy_n(newest.foci.begin(), foci, foci_.begin());
    board.plan({timed, drives, std::span(foci_).first(foci)});
    heart_beats();
  }

  const SharedMemory& memory_;
  bool plays_plans_;
  double slot_s_;
  array::Drive drive_, plan_;
  std::vector<Vec3> foci_;
  std::uint32_t drive_place_ = TripleBuffer::readers_first, plan_place_ = TripleBuffer::readers_first;
  std::uint64_t planned_from_ = 0;  ///< the newest plan's first slot
  session::Passed taken_;           ///< those that sound
  double heard_s_ = 0;
  double until_s_ = std::numeric_limits<double>::infinity();  ///< the newest drive's plan may sound until then
  bool sounding_ = false;
};

int hold_board(std::span<const BoardKind> kinds) {
  const SharedMemory memory = SharedMemory::of(Descriptor(guard_memory));
  const Brief brief = brief_from(memory.brief());
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const BoardKind& k) { return k.name == brief.kind; });
  if (kind == kinds.end()) throw failure("palpa-guard does not know the board " + brief.kind);
  Notes notes;
  Guard guard(memory, kind->plays_plans, brief.board.slot_s);  // takes all its memory before the board sounds
  const auto board = kind->open(brief.board, notes);
  take_spare_memory();
  const KeptInMemory kept(KeptInMemory::Pages::all);
  MessageKind end = MessageKind::silent;
  std::exception_ptr fault;
  if (!brief.only_silence) {
    send_message(guard_socket, MessageKind::opened);
    try {
      end = guard.watch(*board);
    } catch (...) {  // nothing should throw there; if something does, it ends in silence, too
      fault = std::current_exception();
    }
  }
  board->all_off();
  const bool sure = board->close();
  guard.tell_counts(*board);
  if (fault) std::rethrow_exception(fault);
  send_message(guard_socket, sure ? end : MessageKind::unsure);
  return sure ? 0 : 1;
}

}  // namespace

void guard_main(std::span<const BoardKind> kinds) {
  set_signals();
  allow_lower_limit();
  // Silence must not wait, and the guard takes little time. If the system does not allow it to go first, its loop asks
  // the service.
  const RealTime turns(guard_priority, [](pid_t, pid_t, int) {});
  close_range(guard_memory + 1, ~0U, 0);  // descriptors that palpa's parent left open
  int status = 1;
  try {
    status = hold_board(kinds);
  } catch (const Error& error) {
    send_message(guard_socket, MessageKind::refused, static_cast<char>(error.code()) + std::string(error.what()));
  } catch (const std::exception& error) {
    send_message(guard_socket, MessageKind::refused, static_cast<char>(Exit::failed) + std::string(error.what()));
  }
  _exit(status);
}

}  // namespace palpa::driver
