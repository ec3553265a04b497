#include <dbus/dbus.h>

#include <cstdint>
#include <memory>

#include "session/links/real_time_service.hpp"

namespace palpa::session {
namespace {

struct CloseConnection {
  void operator()(DBusConnection* connection) const {
    dbus_connection_close(connection);
    dbus_connection_unref(connection);
  }
};
struct EndMessage {
  void operator()(DBusMessage* message) const { dbus_message_unref(message); }
};

constexpr int answer_ms = 500;

void ask_rtkit(pid_t process, pid_t thread, int priority) {
  // A private connection: a shared one ends the program when the bus goes away.
  const std::unique_ptr<DBusConnection, CloseConnection> bus(dbus_bus_get_private(DBUS_BUS_SYSTEM, nullptr));
  if (!bus) return;
  dbus_connection_set_exit_on_disconnect(bus.get(), 0);
  const std::unique_ptr<DBusMessage, EndMessage> call(
      dbus_message_new_method_call("org.freedesktop.RealtimeKit1", "/org/freedesktop/RealtimeKit1",
                                   "org.freedesktop.RealtimeKit1", "MakeThreadRealtimeWithPID"));
  const auto whose = static_cast<std::uint64_t>(process), which = static_cast<std::uint64_t>(thread);
  const auto wish = static_cast<std::uint32_t>(priority);
  if (!call || !dbus_message_append_args(call.get(), DBUS_TYPE_UINT64, &whose, DBUS_TYPE_UINT64, &which,
                                         DBUS_TYPE_UINT32, &wish, DBUS_TYPE_INVALID))
    return;
  // Its answer does not count: the kernel says how the thread is scheduled.
  const std::unique_ptr<DBusMessage, EndMessage> answer(
      dbus_connection_send_with_reply_and_block(bus.get(), call.get(), answer_ms, nullptr));
}

}  // namespace

RealTimeService real_time_service() {
  return ask_rtkit;
}

}  // namespace palpa::session
