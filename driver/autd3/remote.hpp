// One connection to an AUTD3 server: requests and answers, one message at a time, without ever waiting.
#pragma once

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "array/layouts/layout.hpp"
#include "base/system/descriptor.hpp"
#include "driver/autd3/wire.hpp"
#include "driver/fixed_text.hpp"
#include "driver/guard/channel.hpp"

namespace palpa::driver::autd3 {

/// All addresses of a name, to be tried in this order: `localhost` may be ::1 although a server has only 127.0.0.1.
struct Address {
  struct Place {
    sockaddr_storage where{};
    socklen_t size = 0;
  };
  std::vector<Place> places;  ///< at least one
  std::string text;           ///< HOST:PORT
};
/// Throws bad_usage if the text is not HOST:PORT, failure() for an unknown host.
Address resolve(const std::string& text);

class Remote {
 public:
  /// A server that does not answer within this time is given up. It opens its bus before it answers the geometry.
  static constexpr double patience_s = 0.5, bus_patience_s = 30;

  /// The layout's boards are its devices.
  Remote(Address address, const array::Layout& layout);

  /// Begins to connect. It is idle when this is complete, including hello and geometry.
  void connect(double now_s);
  void disconnect();
  bool closed() const { return step_ == Step::closed; }
  bool idle() const { return step_ == Step::idle; }
  /// Whether it has waited longer than patience_s for the server to open its bus.
  bool waits_for_bus(double now_s) const { return step_ == Step::geometry && now_s > begun_s_ + patience_s; }

  /// The messages to be sent next. Write them while the connection is idle.
  std::size_t devices() const { return devices_; }
  Message message(std::size_t device) { return Message(request_.data() + 1 + device * message_size, message_size); }
  /// Sends the messages of all devices, and asks until all of them have acknowledged.
  void send(double now_s);
  /// Tells the server that the connection ends.
  void say_goodbye(double now_s);
  /// The data in the device's answer to the last acknowledged message.
  std::uint8_t data(std::size_t device) const { return reply_[1 + answer_size * device]; }

  enum class Progress { nothing, done, failed };
  /// Continues as far as possible. done: what was begun is complete. failed: the connection is closed, fault() says
  /// why.
  Progress pump(double now_s);
  std::string_view fault() const { return fault_.view(); }

  /// Ends the connection with a fault that the caller gives.
  void refuse(std::string_view what) { fail("cannot be driven", what); }

  pollfd watched() const;

 private:
  enum class Step { closed, connecting, hello, geometry, idle, sending, reading, goodbye };

  void connect_to_place(double now_s);
  Progress not_there(std::string_view what, std::string_view detail, double now_s);
  void begin(Step step, std::size_t bytes, std::size_t answer, double now_s);
  void ask_for_answers(double now_s);
  Progress next(double now_s);
  Progress fail(std::string_view what, std::string_view detail = {});
  Progress check_answers(double now_s);
  Progress connected(double now_s);
  Progress transfer();
  Progress transfer_reply();

  Address address_;
  std::size_t place_ = 0;  ///< of the address's places, the one that it connects to
  std::size_t tried_ = 0;  ///< places tried in vain
  std::size_t devices_;
  std::vector<std::uint8_t> geometry_, request_, reply_;
  std::array<std::uint8_t, 1> short_request_{};
  Descriptor socket_;
  Step step_ = Step::closed;
  std::span<const std::uint8_t> out_;  ///< what is being sent
  std::size_t sent_ = 0, received_ = 0, expected_ = 0;
  double begun_s_ = 0;
  int refused_ = 0;  ///< the errno of a connection that was refused at once
  std::uint8_t id_ = 0;
  FixedText<300> fault_;
};

}  // namespace palpa::driver::autd3
