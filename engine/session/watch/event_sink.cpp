#include "session/watch/event_sink.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/stream_writer.hpp"
#include "base/log.hpp"
#include "base/system/udp.hpp"

namespace palpa::session {
namespace {

class StreamSink : public EventSink {
 public:
  StreamSink(const std::string& file, std::span<const std::string> solid_names, const std::atomic<bool>* stop,
             bool waits)
      : writer_(open_output(file, {.stop = stop}), room),
        solid_names_(solid_names.begin(), solid_names.end()),
        patience_{.seconds = waits ? std::nullopt : std::optional(0.0), .stop = stop} {}

  void write(std::span<const Event> events) override {
    for (const Event& event : events) {
      write_event_line(event, solid_names_, json_);
      const bool taken = writer_.add(json_.finish(), patience_);
      written_ += taken ? 1 : 0;
      drop(taken ? 0 : 1);
    }
  }

  void name_solids(std::span<const std::string> names) override { solid_names_.assign(names.begin(), names.end()); }

  void finish() override {
    if (!patience_.seconds) writer_.flush(patience_);
    writer_.flush();
    writer_.close();  // from here on nothing more is written
    const std::uint64_t lost = writer_.waiting();
    written_ -= std::min(lost, written_);
    drop(lost);
  }

 private:
  static constexpr std::size_t room = 1 << 20;

  void drop(std::uint64_t lines) {
    if (lines > 0 && !std::exchange(warned_, true)) {
      log::warning(fmt::format("events: {} is read too slowly, lines are left out", writer_.name()));
    }
    dropped_ += lines;
  }

  StreamWriter writer_;
  std::vector<std::string> solid_names_;
  Patience patience_;  ///< for lines
  bool warned_ = false;
  JsonWriter json_;
};

class UdpSink : public EventSink {
 public:
  UdpSink(const std::string& address, std::span<const std::string> solid_names)
      : sender_(address, "events", "--events takes -, a file or udp:HOST:PORT, for example udp:127.0.0.1:9001"),
        solid_names_(solid_names.begin(), solid_names.end()) {}

  void write(std::span<const Event> events) override {
    for (const Event& event : events) {
      write_event_line(event, solid_names_, json_);
      const bool sent = sender_.send(json_.finish()) == UdpSender::Sent::yes;
      ++(sent ? written_ : dropped_);
      sender_.warn();
    }
  }

  void name_solids(std::span<const std::string> names) override { solid_names_.assign(names.begin(), names.end()); }

 private:
  UdpSender sender_;
  std::vector<std::string> solid_names_;
  JsonWriter json_;
};

}  // namespace

std::unique_ptr<EventSink> open_event_sink(const std::string& target, std::span<const std::string> solid_names,
                                           const std::atomic<bool>* stop, bool waits) {
  if (target.starts_with("udp:")) return std::make_unique<UdpSink>(target.substr(4), solid_names);
  if (target.empty()) throw bad_usage("--events needs -, a file or udp:HOST:PORT");
  return std::make_unique<StreamSink>(target, solid_names, stop, waits);
}

}  // namespace palpa::session
