// Where events go: lines of JSON to stdout, a file or a pipe, or a datagram each. Sinks never keep the loop waiting.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "session/watch/events.hpp"

namespace palpa::session {

class EventSink {
 public:
  virtual ~EventSink() = default;
  /// Once per frame; never waits. Throws failure() where nobody will ever get them, once that is known: a closed pipe,
  /// a full disk.
  virtual void write(std::span<const Event> events) = 0;
  /// After the last event: hands over what still waits, which takes half a second at most.
  virtual void finish() {}

  std::uint64_t written() const { return written_; }  ///< lines that were accepted
  std::uint64_t dropped() const { return dropped_; }  ///< lines left out, since their reader was too slow

 protected:
  std::uint64_t written_ = 0, dropped_ = 0;
};

/// "-", a file or "udp:HOST:PORT". Lines leave at once, written by a thread of their own; of a reader, or a disk, that
/// is slower than that up to a megabyte waits, then whole lines are left out, counted, and there is one warning. With
/// `wait_unless`, for frames that wait for the loop, no line is left out: the reader is waited for until that flag
/// becomes true. Throws bad_usage for another form, failure() for what cannot be opened.
std::unique_ptr<EventSink> open_event_sink(const std::string& target, std::span<const std::string> solid_names,
                                           const std::atomic<bool>* wait_unless = nullptr);

}  // namespace palpa::session
