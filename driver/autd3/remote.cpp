#include "driver/autd3/remote.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <memory>

#include "base/error.hpp"
#include "base/system/descriptor.hpp"
#include "base/system/udp.hpp"

namespace palpa::driver::autd3 {
namespace {

constexpr std::size_t error_head = 5;  // the error mark and the text's size
constexpr std::size_t most_error_text = 200;
constexpr std::uint8_t newer_hello = 'A';  // "ARMT"

void put_float(std::vector<std::uint8_t>& out, double value) {
  const auto number = static_cast<float>(value);
  const auto* first = reinterpret_cast<const std::uint8_t*>(&number);
  out.insert(out.end(), first, first + sizeof number);
}

/// Each device's first transducer, in millimetres, and its rotation.
std::vector<std::uint8_t> geometry_request(const array::Layout& layout) {
  std::vector<std::uint8_t> out{static_cast<std::uint8_t>(Request::geometry)};
  for (int byte = 0; byte < 4; ++byte)
    out.push_back(static_cast<std::uint8_t>(layout.boards.size() >> (8 * byte)));
  for (const array::Board& board : layout.boards) {
    const Vec3 first = 1e3 * layout.transducers[board.first].position;
    const glm::dquat turn = glm::normalize(glm::quat_cast(glm::dmat3(board.T_layout_board)));
    for (const double value : {first.x, first.y, first.z, turn.w, turn.x, turn.y, turn.z})
      put_float(out, value);
  }
  return out;
}

}  // namespace

Address resolve(const std::string& text) {
  const auto [host, port, loopback] =
      parse_address(text, "link autd3 takes HOST:PORT, such as autd3:127.0.0.1:8080, not '" + text + "'");
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int fault = getaddrinfo(host.c_str(), port.c_str(), &wanted, &found);
  if (fault != 0) throw failure(fmt::format("link autd3: {}: {}", text, gai_strerror(fault)));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(found, freeaddrinfo);
  Address address;
  address.text = text;
  for (const addrinfo* one = found; one != nullptr; one = one->ai_next) {
    Address::Place& place = address.places.emplace_back();
    place.size = one->ai_addrlen;
    std::memcpy(&place.where, one->ai_addr, one->ai_addrlen);
  }
  return address;
}

Remote::Remote(Address address, const array::Layout& layout)
    : address_(std::move(address)),
      devices_(layout.boards.size()),
      geometry_(geometry_request(layout)),
      request_(1 + devices_ * message_size),
      reply_(std::max(1 + devices_ * answer_size, error_head + most_error_text)) {}

void Remote::connect(double now_s) {
  fault_.clear();
  tried_ = 0;  // begins with the place that answered last time
  connect_to_place(now_s);
}

void Remote::connect_to_place(double now_s) {
  const Address::Place& place = address_.places[place_];
  socket_ = Descriptor(socket(place.where.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int no_socket = socket_ ? 0 : errno;
  const int yes = 1;
  setsockopt(socket_.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  const int result = ::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&place.where), place.size);
  refused_ = result == 0 || errno == EINPROGRESS ? 0 : errno;
  if (no_socket != 0) refused_ = no_socket;
  begin(Step::connecting, 0, 0, now_s);
}

/// No server at this place. Tries the next one, if there is one that was not tried.
Remote::Progress Remote::not_there(std::string_view what, std::string_view detail, double now_s) {
  if (++tried_ >= address_.places.size()) return fail(what, detail);
  place_ = (place_ + 1) % address_.places.size();
  connect_to_place(now_s);
  return Progress::nothing;
}

void Remote::disconnect() {
  socket_ = Descriptor();
  step_ = Step::closed;
}

void Remote::send(double now_s) {
  id_ = static_cast<std::uint8_t>((id_ + 1) & most_id);
  request_[0] = static_cast<std::uint8_t>(Request::send);
  for (std::size_t d = 0; d < devices_; ++d)
    set_id(message(d), id_);
  out_ = request_;
  begin(Step::sending, out_.size(), 1, now_s);
}

void Remote::say_goodbye(double now_s) {
  short_request_[0] = static_cast<std::uint8_t>(Request::close);
  out_ = short_request_;
  begin(Step::goodbye, 1, 1, now_s);
}

void Remote::ask_for_answers(double now_s) {
  short_request_[0] = static_cast<std::uint8_t>(Request::read);
  out_ = short_request_;
  const double since_s = begun_s_;
  const bool again = step_ == Step::reading;
  begin(Step::reading, 1, 1 + devices_ * answer_size, now_s);
  if (again) begun_s_ = since_s;  // patience is for the acknowledgement, no matter how often it was asked for
}

void Remote::begin(Step step, std::size_t bytes, std::size_t answer, double now_s) {
  step_ = step;
  out_ = out_.first(std::min(bytes, out_.size()));
  sent_ = received_ = 0;
  expected_ = answer;
  begun_s_ = now_s;
}

Remote::Progress Remote::fail(std::string_view what, std::string_view detail) {
  fault_.format("{} {}{}{}", address_.text, what, detail.empty() ? "" : ": ", detail);
  disconnect();
  return Progress::failed;
}

Remote::Progress Remote::connected(double now_s) {
  if (refused_ != 0) return not_there("cannot be reached", std::strerror(refused_), now_s);
  pollfd one{socket_.get(), POLLOUT, 0};
  if (poll(&one, 1, 0) <= 0) return Progress::nothing;
  int fault = 0;
  socklen_t size = sizeof fault;
  getsockopt(socket_.get(), SOL_SOCKET, SO_ERROR, &fault, &size);
  if (fault != 0) return not_there("cannot be reached", std::strerror(fault), now_s);
  out_ = hello_request;
  begin(Step::hello, out_.size(), 1, now_s);
  return Progress::done;
}

Remote::Progress Remote::transfer() {
  while (sent_ < out_.size()) {
    const ssize_t size = ::send(socket_.get(), out_.data() + sent_, out_.size() - sent_, MSG_NOSIGNAL);
    if (size < 0) {
      if (errno == EAGAIN || errno == EINTR) return Progress::nothing;
      return fail("is gone", std::strerror(errno));
    }
    sent_ += static_cast<std::size_t>(size);
  }
  return transfer_reply();
}

Remote::Progress Remote::transfer_reply() {
  while (true) {
    // The first bytes of a reply give its length.
    const bool refused = received_ > 0 && reply_[0] != reply_ok;
    std::size_t whole = expected_;
    if (refused) {
      if (reply_[0] == newer_hello) {
        return fail(
            "is a server or simulator of autd3-sdk, whose protocol (ARMT) is newer than version 1, which palpa speaks");
      }
      if (reply_[0] != reply_error) return fail("does not speak AUTD3's Remote protocol, version 1");
      whole = error_head;
      if (received_ >= error_head) {
        std::uint32_t text = 0;
        std::memcpy(&text, reply_.data() + 1, sizeof text);
        whole += std::min<std::size_t>(text, most_error_text);
      }
    }
    if (received_ >= whole) {  // can be longer than a short refusal if more was expected
      if (!refused) return Progress::done;
      return fail("refuses", {reinterpret_cast<const char*>(reply_.data()) + error_head, whole - error_head});
    }
    const ssize_t size = recv(socket_.get(), reply_.data() + received_, whole - received_, 0);
    if (size == 0) return fail("closed the connection");
    if (size < 0) {
      if (errno == EAGAIN || errno == EINTR) return Progress::nothing;
      return fail("is gone", std::strerror(errno));
    }
    received_ += static_cast<std::size_t>(size);
  }
}

Remote::Progress Remote::check_answers(double now_s) {
  for (std::size_t d = 0; d < devices_; ++d) {
    const std::uint8_t acknowledge = reply_[2 + answer_size * d];
    if ((acknowledge & most_id) != id_) {
      ask_for_answers(now_s);
      return Progress::nothing;
    }
    if ((acknowledge >> 4) != 0) {
      return fail("answers", FixedText<80>("device {} refuses a message with error {}", d, acknowledge >> 4).view());
    }
  }
  step_ = Step::idle;
  return Progress::done;
}

Remote::Progress Remote::next(double now_s) {
  switch (step_) {
    case Step::hello:
      out_ = geometry_;
      begin(Step::geometry, out_.size(), 1, now_s);
      return Progress::nothing;
    case Step::sending:
      ask_for_answers(now_s);
      return Progress::nothing;
    case Step::reading:
      return check_answers(now_s);
    case Step::goodbye:
      disconnect();
      return Progress::done;
    default:
      step_ = Step::idle;
      return Progress::done;
  }
}

Remote::Progress Remote::pump(double now_s) {
  constexpr int most_reads = 4;  // from a server that does not acknowledge; then others have their turn
  for (int reads = 0; reads < most_reads;) {
    const Step before = step_;
    if (before == Step::closed) return Progress::nothing;
    if (before == Step::connecting) {
      const Progress progress = connected(now_s);
      if (progress == Progress::failed) return progress;
      if (progress == Progress::nothing) break;
      continue;
    }
    if (before == Step::idle) {
      // Nothing is expected now: anything that comes is the end, or this is not a server of this kind.
      std::uint8_t byte = 0;
      const ssize_t size = recv(socket_.get(), &byte, 1, 0);
      if (size == 0) return fail("closed the connection");
      if (size > 0) return fail("sent data that palpa did not ask for");
      if (errno != EAGAIN && errno != EINTR) return fail("is gone", std::strerror(errno));
      return Progress::nothing;
    }
    const Progress moved = transfer();
    if (moved == Progress::failed) return moved;
    if (moved == Progress::nothing) break;
    const Progress through = next(now_s);
    if (through != Progress::nothing) return through;
    if (before == Step::reading) ++reads;
  }
  if (now_s - begun_s_ <= (step_ == Step::geometry ? bus_patience_s : patience_s)) return Progress::nothing;
  return step_ == Step::connecting ? not_there("does not answer", {}, now_s) : fail("does not answer");
}

pollfd Remote::watched() const {
  const bool writes = step_ == Step::connecting || sent_ < out_.size();
  return {socket_.get(), static_cast<short>(POLLIN | (writes && step_ != Step::idle ? POLLOUT : 0)), 0};
}

}  // namespace palpa::driver::autd3
