// The destinations of events: lines of JSON to stdout, a file or a pipe, or one datagram per event. Sinks never block
// the loop.
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
  /// Called once per frame; never waits. Throws failure() once it is known that nobody will ever get the events: a
  /// closed pipe, a full disk.
  virtual void write(std::span<const Event> events) = 0;
  /// From the next write() on, the solids have these names.
  virtual void name_solids(std::span<const std::string> /*solid_names*/) {}
  /// Called after the last event: flushes the remaining lines, which takes at most half a second.
  virtual void finish() {}

  std::uint64_t written() const { return written_; }  ///< lines that were accepted
  std::uint64_t dropped() const { return dropped_; }  ///< lines left out because their reader was too slow

 protected:
  std::uint64_t written_ = 0, dropped_ = 0;
};

/// "-", a file or "udp:HOST:PORT". A separate thread writes the lines at once. If the reader or the disk is slower, up
/// to a megabyte is buffered. After that, complete lines are left out and counted, and there is one warning. If frames
/// wait for the loop, the sink `waits` for the reader, too, and no line is left out. `stop` ends such waits, and the
/// wait for somebody who opens a pipe. Throws bad_usage for another form, failure() if the target cannot be opened.
std::unique_ptr<EventSink> open_event_sink(const std::string& target, std::span<const std::string> solid_names,
                                           const std::atomic<bool>* stop = nullptr, bool waits = false);

}  // namespace palpa::session
