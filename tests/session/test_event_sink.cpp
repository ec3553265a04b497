// The output of events: files, pipes that are read slowly or not at all, datagrams.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <sstream>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <thread>

#include "base/error.hpp"
#include "base/files/stream_writer.hpp"
#include "session/links/link.hpp"
#include "session/links/record_link.hpp"
#include "session/watch/event_sink.hpp"
#include "support/begins.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "support/udp_receiver.hpp"

namespace palpa::session {
namespace {

using namespace std::chrono_literals;

// As in every program of palpa: a closed pipe is an error of a write.
[[maybe_unused]] const auto no_sigpipe = std::signal(SIGPIPE, SIG_IGN);

const std::vector<std::string> names{"button"};

std::vector<Event> events(std::size_t count, std::uint32_t first = 0) {
  std::vector<Event> made(count);
  for (std::size_t i = 0; i < count; ++i)
    made[i].finger = first + static_cast<std::uint32_t>(i);
  return made;
}

/// A FIFO whose reader reads only on request.
struct Fifo {
  std::filesystem::path file;
  int reader = -1;
  explicit Fifo(const std::string& name) : file(test::scratch_folder(name) / "fifo") {
    EXPECT_EQ(mkfifo(file.c_str(), 0600), 0);
    reader = open(file.c_str(), O_RDONLY | O_NONBLOCK);
  }
  ~Fifo() { hang_up(); }
  void hang_up() {
    if (reader >= 0) close(reader);
    reader = -1;
  }
  /// Bytes that wait for the reader; a pipe has room for 65,536.
  int holds() const {
    int bytes = 0;
    ioctl(reader, FIONREAD, &bytes);
    return bytes;
  }
  /// Its current contents.
  std::string read_all() const {
    std::string text;
    char block[4096];
    for (ssize_t got; (got = read(reader, block, sizeof(block))) > 0;)
      text.append(block, static_cast<std::size_t>(got));
    return text;
  }
};

/// Reads a FIFO on a thread of its own.
class Reading {
 public:
  explicit Reading(const Fifo& fifo)
      : fifo_(fifo), thread_([this] {
          while (!over_) {
            text_ += fifo_.read_all();
            bytes_ = text_.size();
            std::this_thread::sleep_for(1ms);
          }
        }) {}
  /// Whether it comes to have read so much.
  bool comes_to(std::size_t bytes) const {
    return test::begins([&] { return bytes_ >= bytes; });
  }
  /// All that was written; nobody writes any more.
  std::string end() {
    over_ = true;
    thread_.join();
    return text_ + fifo_.read_all();
  }

 private:
  const Fifo& fifo_;
  std::string text_;
  std::atomic<std::size_t> bytes_{0};
  std::atomic<bool> over_{false};
  std::thread thread_;
};

std::vector<std::uint32_t> fingers(const std::string& lines) {
  std::vector<std::uint32_t> ids;
  std::istringstream in(lines);
  for (std::string line; std::getline(in, line);)
    ids.push_back(nlohmann::json::parse(line).at("finger"));
  return ids;
}

TEST(EventSink, AFileHoldsEveryLineAtOnce) {
  const auto file = test::scratch_folder("event-file") / "events";
  const auto sink = open_event_sink(file.string(), names);
  sink->write(events(3));
  // Another thread writes them; no call is needed.
  std::string text;
  const auto all_written = [&] {
    text = test::read_text(file);
    return std::ranges::count(text, '\n') == 3;
  };
  EXPECT_TRUE(test::begins(all_written));
  EXPECT_EQ(fingers(text), (std::vector<std::uint32_t>{0, 1, 2})) << "on their way with the frame";
  sink->finish();
  EXPECT_EQ(sink->written(), 3U);
  EXPECT_EQ(sink->dropped(), 0U);
}

TEST(EventSink, APipeThatNobodyReadsDelaysNothingAndLosesWholeLines) {
  Fifo fifo("event-slow");
  const auto sink = open_event_sink(fifo.file.string(), names);
  for (std::uint32_t n = 0; n < 20'000; ++n)  // 2 MB; the pipe holds 64 kB, and a megabyte waits
    sink->write(events(1, n));
  EXPECT_EQ(sink->written() + sink->dropped(), 20'000U);
  EXPECT_GT(sink->dropped(), 1000U);
  Reading reader(fifo);
  sink->finish();
  const std::vector<std::uint32_t> got = fingers(reader.end());
  EXPECT_EQ(got.size(), sink->written());
  EXPECT_TRUE(std::is_sorted(got.begin(), got.end()));
  EXPECT_EQ(got.front(), 0U);
}

TEST(EventSink, ThatMayWaitLeavesNothingOut) {
  Fifo fifo("event-wait");
  std::atomic<bool> stop{false};
  const auto sink = open_event_sink(fifo.file.string(), names, &stop, true);
  Reading reader(fifo);
  for (std::uint32_t n = 0; n < 20'000; ++n)
    sink->write(events(1, n));
  sink->finish();
  EXPECT_EQ(fingers(reader.end()).size(), 20'000U);
  EXPECT_EQ(sink->dropped(), 0U);
}

TEST(EventSink, ThatMayWaitStillStops) {
  Fifo fifo("event-stop");
  std::atomic<bool> stop{false};
  const auto sink = open_event_sink(fifo.file.string(), names, &stop, true);
  std::thread stopper([&] {
    test::begins([&] { return fifo.holds() > 32'000; });
    stop = true;
  });
  for (std::uint32_t n = 0; n < 20'000; ++n)
    sink->write(events(1, n));
  sink->finish();
  stopper.join();
  EXPECT_GT(sink->dropped(), 0U);
}

/// A write reports the result of earlier ones once it is known.
void write_until_known(EventSink& sink) {
  test::begins([&] {
    sink.write(events(1));
    return false;
  });
}

TEST(EventSink, AReaderThatLeavesAndAFullDiskAreErrors) {
  Fifo fifo("event-gone");
  const auto sink = open_event_sink(fifo.file.string(), names);
  sink->write(events(1));
  fifo.hang_up();
  const Error gone = test::thrown_by([&] { write_until_known(*sink); });
  EXPECT_EQ(gone.code(), Exit::failed);
  EXPECT_CONTAINS(gone.what(), "cannot be written: Broken pipe");
  const auto full = open_event_sink("/dev/full", names);
  EXPECT_EQ(test::thrown_by([&] { write_until_known(*full); }).code(), Exit::failed);
  EXPECT_EQ(test::thrown_by([] { open_event_sink("/no/such/folder/x", names); }).code(), Exit::failed);
}

TEST(EventSink, SendsADatagramPerEvent) {
  auto receiver = std::make_unique<test::UdpReceiver>();
  const auto sink = open_event_sink(receiver->address(), names);
  sink->write(events(2));
  for (std::uint32_t n = 0; n < 2; ++n) {
    const std::string text = receiver->next();
    ASSERT_FALSE(text.empty());
    EXPECT_EQ(fingers(text), std::vector<std::uint32_t>{n});
  }
  receiver.reset();
  for (int n = 0; n < 5; ++n)
    EXPECT_NO_THROW(sink->write(events(1))) << "nobody listens any more";
  EXPECT_EQ(sink->written(), 2u);
  EXPECT_EQ(sink->dropped(), 5u);
  for (const char* form : {"udp:", "udp:host", "udp:host:0", "udp::9", "udp:host:99999", ""})
    EXPECT_EQ(test::thrown_by([&] { open_event_sink(form, names); }).code(), Exit::usage) << form;
}

/// Records of this length fill the pipe soon.
struct Recorded {
  static constexpr std::size_t header = 24, record = 8 + 8000;
  Fifo fifo{"record"};
  array::Layout layout;
  LinkSetting setting{layout, names, 1.5e-3};
  array::Drive loud{1000, {1.0F, 0.5F}};

  Recorded() { layout.transducers.assign(1000, {Vec3(0), Vec3(0, 0, 1)}); }
};

TEST(RecordLink, AFifoThatNobodyReadsIsAFaultAndNotAHang) {
  Recorded r;
  const auto link = open_link("record:" + r.fifo.file.string(), builtin_links(), r.setting);
  std::uint64_t taken = 0;
  const Error stalled = test::thrown_by([&] {
    for (; taken < 100; ++taken)
      link->send(taken, r.loud);
  });
  EXPECT_EQ(stalled.code(), Exit::failed);
  EXPECT_CONTAINS(stalled.what(), "nobody reads it");
  // The loop does this then; now the reader is back, and has read.
  Reading reader(r.fifo);
  EXPECT_TRUE(reader.comes_to(r.header + taken * r.record));
  EXPECT_NO_THROW(link->send(100, array::Drive(1000, {0.0F, 0.0F})));
  EXPECT_NO_THROW(link->finish());
  const std::string text = reader.end();
  ASSERT_EQ((text.size() - r.header) % r.record, 0U) << "whole records";
  const std::string last = text.substr(text.size() - r.record);
  EXPECT_EQ(last[0], 100);
  EXPECT_TRUE(std::all_of(last.begin() + 8, last.end(), [](char c) { return c == 0; })) << "silence is the last thing";
}

TEST(RecordLink, WaitsForItsReaderWhereNothingSounds) {
  Recorded r;
  const std::atomic<bool> stop{false};
  const auto link = open_record_link(r.fifo.file.string(), r.setting, &stop);
  std::unique_ptr<Reading> reader;
  std::thread late([&] {
    std::this_thread::sleep_for(700ms);  // longer than a link waits
    reader = std::make_unique<Reading>(r.fifo);
  });
  for (std::uint64_t slot = 0; slot < 100; ++slot)
    EXPECT_NO_THROW(link->send(slot, r.loud));
  EXPECT_NO_THROW(link->finish());
  late.join();
  EXPECT_EQ(reader->end().size(), r.header + 100 * r.record);
}

}  // namespace
}  // namespace palpa::session
