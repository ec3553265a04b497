// rtkit itself needs the system's bus and polkit. A stand-in answers the same call on a bus of its own.
#include "session/links/real_time_service.hpp"

#include <dbus/dbus.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "support/begins.hpp"

namespace palpa::session {
namespace {

/// A bus that only this test knows. Empty address: no dbus-daemon is installed.
class PrivateBus {
 public:
  PrivateBus() {
    std::array<int, 2> pipe_ends{};
    if (pipe(pipe_ends.data()) != 0) return;
    child_ = fork();
    if (child_ == 0) {
      dup2(pipe_ends[1], STDOUT_FILENO);
      close(STDERR_FILENO);  // it says that it cannot have more files
      execlp("dbus-daemon", "dbus-daemon", "--session", "--nofork", "--print-address", nullptr);
      _exit(127);
    }
    close(pipe_ends[1]);
    FILE* const said = fdopen(pipe_ends[0], "r");
    std::array<char, 512> line{};
    if (std::fgets(line.data(), line.size(), said)) address = line.data();
    std::fclose(said);
    if (!address.empty()) address.pop_back();
    setenv("DBUS_SYSTEM_BUS_ADDRESS", address.empty() ? "unix:path=/nonexistent" : address.c_str(), 1);
  }
  ~PrivateBus() {
    kill(child_, SIGTERM);
    waitpid(child_, nullptr, 0);
    unsetenv("DBUS_SYSTEM_BUS_ADDRESS");
  }
  PrivateBus(const PrivateBus&) = delete;
  PrivateBus& operator=(const PrivateBus&) = delete;

  std::string address;

 private:
  pid_t child_ = -1;
};

struct Call {
  std::uint64_t process = 0, thread = 0;
  std::uint32_t priority = 0;
};

/// Answers one call, as rtkit does or not at all.
class StandIn {
 public:
  StandIn(const std::string& address, bool answers) {
    connection_ = dbus_connection_open_private(address.c_str(), nullptr);
    if (!connection_ || !dbus_bus_register(connection_, nullptr)) return;
    dbus_connection_set_exit_on_disconnect(connection_, 0);
    ready = dbus_bus_request_name(connection_, "org.freedesktop.RealtimeKit1", 0, nullptr) ==
            DBUS_REQUEST_NAME_REPLY_PRIMARY_OWNER;
    thread_ = std::thread([this, answers] { serve(answers); });
  }
  ~StandIn() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
    if (!connection_) return;
    dbus_connection_close(connection_);
    dbus_connection_unref(connection_);
  }
  StandIn(const StandIn&) = delete;
  StandIn& operator=(const StandIn&) = delete;

  bool ready = false;
  std::atomic<bool> heard{false};
  Call call;  ///< once it is heard

 private:
  void serve(bool answers) {
    while (!over_ && dbus_connection_read_write(connection_, 10)) {
      DBusMessage* const message = dbus_connection_pop_message(connection_);
      if (!message) continue;
      if (dbus_message_is_method_call(message, "org.freedesktop.RealtimeKit1", "MakeThreadRealtimeWithPID") &&
          dbus_message_get_args(message, nullptr, DBUS_TYPE_UINT64, &call.process, DBUS_TYPE_UINT64, &call.thread,
                                DBUS_TYPE_UINT32, &call.priority, DBUS_TYPE_INVALID)) {
        heard = true;
        if (answers) answer(message);
      }
      dbus_message_unref(message);
    }
  }
  void answer(DBusMessage* message) {
    const sched_param wish{.sched_priority = static_cast<int>(call.priority)};
    sched_setscheduler(static_cast<pid_t>(call.thread), SCHED_RR | SCHED_RESET_ON_FORK, &wish);
    DBusMessage* const done = dbus_message_new_method_return(message);
    dbus_connection_send(connection_, done, nullptr);
    dbus_connection_flush(connection_);
    dbus_message_unref(done);
  }

  DBusConnection* connection_ = nullptr;
  std::thread thread_;
  std::atomic<bool> over_{false};
};

TEST(RealTimeService, AsksRtkitForAThreadOfAProcess) {
  const PrivateBus bus;
  if (bus.address.empty()) GTEST_SKIP() << "dbus-daemon is not installed (./dev deps test)";
  for (const bool answers : {true, false}) {
    StandIn rtkit(bus.address, answers);
    ASSERT_TRUE(rtkit.ready);
    Scheduling got = Scheduling::unknown;
    std::uint64_t number = 0;
    std::thread([&] {
      number = static_cast<std::uint64_t>(gettid());
      real_time_service()(getpid(), gettid(), 7);  // without an answer, or with a late one, this returns, too
      test::begins([&] { return rtkit.heard.load(); });
      const auto is_real_time = [&] { return (got = scheduling_of(0)) == Scheduling::real_time; };
      if (geteuid() == 0 && answers) test::begins(is_real_time);
    }).join();
    ASSERT_TRUE(rtkit.heard);
    EXPECT_EQ(rtkit.call.process, static_cast<std::uint64_t>(getpid()));
    EXPECT_EQ(rtkit.call.thread, number);
    EXPECT_EQ(rtkit.call.priority, 7u);
    if (geteuid() == 0 && answers) {
      EXPECT_EQ(got, Scheduling::real_time) << "what the stand-in did counts";
    }
  }
}

TEST(RealTimeService, WithoutRtkitOrABusNothingChanges) {
  const PrivateBus bus;
  real_time_service()(getpid(), gettid(), 7);
  setenv("DBUS_SYSTEM_BUS_ADDRESS", "unix:path=/nonexistent", 1);
  real_time_service()(getpid(), gettid(), 7);
  EXPECT_EQ(scheduling_of(0), Scheduling::normal);
}

}  // namespace
}  // namespace palpa::session
