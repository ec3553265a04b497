// One OpenMPD board at the end of its cable. It takes frames, and is in step or gets into step by itself.
//
// The board never sends anything, so nobody can see that it is out of step. Therefore it is resynchronised when it is
// opened and after every transfer that failed, was cancelled or took too long:
//
//   cancel -> purge -> 512 zeros, two all-off frames -> 1 s without a byte -> 512 zeros, an all-off frame -> in step
//
// The first burst silences it, wherever in a frame its parser was. The pause makes it drop what is left of a cut frame,
// and the second burst ends the parser's last frame. A device that is gone is looked for until it is back.
//
// tend() waits only for requests, and makes at most one of them. A board that does not answer therefore does not delay
// a caller that has several boards or has to end. Only the search for a lost device allocates.
#pragma once

#include <poll.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "driver/clock.hpp"
#include "driver/fixed_text.hpp"
#include "driver/openmpd/frame.hpp"
#include "driver/usb/device.hpp"

namespace palpa::driver::openmpd {

/// Which board: its serial number and, if several have the same one, where it is plugged in (usb::Entry::place).
struct Address {
  std::string serial, place;
  std::string text() const { return place.empty() ? serial : serial + "@" + place; }
};

class Connection {
 public:
  static constexpr double transfer_patience_s = 0.25;
  static constexpr double pause_s = 1.05;  ///< the board's own second is over by then
  static constexpr double retry_s = 0.5;
  static constexpr double idle_s = 0.4;           ///< a board clears its buffer every second in which it got nothing
  static constexpr std::size_t most_frames = 14;  ///< in one send()

  /// Transport and clock must outlive this object. `divider` is set once per opening.
  Connection(Address address, usb::Transport& transport, const Clock& clock, std::uint8_t divider);

  /// Opens the device and begins to resynchronise it. Throws failure() or bad_usage that names what is wrong and what
  /// would be right: no such board, several, a board that another program has, another device with the same ids.
  void open();

  /// Continues by a step: transfers that ended, the resynchronisation, a device that is back.
  void tend();
  /// Whether the next tend() waits for the device, for usb::request_patience_s at most.
  bool asks() const;
  /// Takes the next step at once instead of later, because the run ends.
  void hurry();

  bool in_step() const { return state_ == State::in_step; }
  /// Whether send() may be called: in step, and a transfer is free.
  bool takes() const;
  /// Begins to send, one frame after the other. tend() handles any trouble. `sounds`: it is a drive to be counted.
  void send(std::span<const Frame> frames, bool sounds = false);
  /// For a board in step that waits for another while nothing is sent. Sends zeros, which begin no frame, before the
  /// board could clear its buffer and cut the next frame.
  void keep_awake();
  /// Starts over, if it was in step: silence, and in step again a second later.
  void resync();

  /// The most frames that can be on their way or in the board's buffer now. The board says nothing about its buffer:
  /// bytes count as having come when their transfer is known to have ended, however long before they came.
  std::size_t most_queued() const;
  /// Ready when a transfer has ended; without a transfer, its fd is negative.
  pollfd watched() const { return device_ && flying_ > 0 ? device_->watched() : pollfd{-1, 0, 0}; }

  /// Whether nothing that was sent is still on its way.
  bool settled() const { return flying_ == 0; }
  /// Whether it is silent, as far as that can be known: the silence has left, as the last thing sent.
  bool silenced() const;

  const Address& address() const { return address_; }
  /// Why it is not in step, for messages; empty if all is well.
  std::string_view trouble() const { return trouble_.view(); }
  unsigned bus() const { return entry_.bus; }
  std::uint64_t frames() const { return frames_; }  ///< given to send()
  /// Drives that sound: those whose transfer was begun, and those that the device has taken to the last byte.
  std::uint64_t submitted() const { return submitted_; }
  std::uint64_t completed() const { return completed_; }

 private:
  /// lost: it is looked for; found: to be opened; asking: requests for what it is, and purges; draining: transfers are
  /// being ended; flushing and ending: the two bursts.
  enum class State { lost, found, asking, draining, flushing, pausing, ending, in_step };
  struct Pending {
    std::array<std::uint8_t, most_frames * frame_bytes> bytes{};
    std::size_t length = 0, sent = 0;
    std::uint64_t order = 0;  ///< in which they were begun
    double since_s = 0;
    bool flies = false;
    bool sounds = false;  ///< it is a drive to be counted
  };

  void note_arrival(std::size_t bytes);
  void look_for_device();
  void find_device();
  void take_device();
  void ask();
  void check_channel();
  void reap();
  void start_over(std::string_view trouble);
  void lose(std::string_view trouble);
  void fall_out(usb::Outcome outcome);
  void flush();
  void begin(std::span<const std::uint8_t> bytes, bool sounds = false);
  bool submit(unsigned number);
  double oldest_s() const;
  void forgive_absence(double now_s);

  Address address_;
  usb::Transport& transport_;
  const Clock& clock_;
  std::uint8_t divider_;
  usb::Entry entry_;
  std::unique_ptr<usb::Device> device_;
  State state_ = State::lost;
  std::size_t asked_ = 0;     ///< requests since it was opened
  bool halted_ = false;       ///< its endpoint stalled
  bool divider_set_ = false;  ///< since the device was opened
  double due_s_ = 0;          ///< when the state's next step may come
  double tended_s_ = 0;       ///< the last tend()
  std::array<Pending, usb::most_in_flight> pending_;
  unsigned flying_ = 0;
  std::uint64_t begun_ = 0;  ///< transfers, in all
  double begun_s_ = 0;       ///< when the last one was begun
  double drained_s_ = 0;     ///< when the board has taken the last frame from its buffer, at the latest
  FixedText<400> trouble_;
  std::uint64_t frames_ = 0;
  std::uint64_t submitted_ = 0, completed_ = 0;
};

}  // namespace palpa::driver::openmpd
