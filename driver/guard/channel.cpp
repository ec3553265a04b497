#include "driver/guard/channel.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "base/error.hpp"
#include "base/system/descriptor.hpp"

namespace palpa::driver {
namespace {

constexpr std::uint64_t mark = 0x70616c70'61677562;
constexpr std::size_t line = 64;  // a cache line, so that what the two sides write lies apart

std::size_t whole_lines(std::size_t size) {
  return (size + line - 1) / line * line;
}

Error no_memory() {
  return failure(fmt::format("there is no memory to share with palpa-guard: {}", std::strerror(errno)));
}

}  // namespace

/// At the beginning of the memory. Its members are offsets from there.
struct SharedMemory::Head {
  std::uint64_t mark, size;
  std::uint64_t brief, brief_size;
  std::uint64_t transducers, most_cycle;
  std::uint64_t drives, drive_size;  ///< the turns, then three places
  std::uint64_t plans, plan_size;
  std::uint64_t tally;
};

void Tally::tell(const session::Passed& taken, const BoardCounts& counts) {
  const std::array now{taken.drives,
                       taken.plans,
                       counts.submitted.drives,
                       counts.submitted.plans,
                       counts.completed.drives,
                       counts.completed.plans,
                       counts.starting,
                       std::uint64_t{counts.out_of_reach},
                       counts.late ? *counts.late + 1 : 0};
  // Not all at one instant: a reader may miss the newest values meanwhile, and asks again.
  for (std::size_t i = 0; i < now.size(); ++i)
    values_[i].store(now[i], std::memory_order_relaxed);
}

session::Carried Tally::read() const {
  const auto value = [&](std::size_t i) { return values_[i].load(std::memory_order_relaxed); };
  return {.guard = session::Passed{value(0), value(1)},
          .submitted = {value(2), value(3)},
          .completed = {value(4), value(5)},
          .starting = value(6),
          .out_of_reach = value(7) != 0,
          .late = value(8) != 0 ? std::optional(value(8) - 1) : std::nullopt};
}

SharedMemory::SharedMemory(Descriptor fd, std::size_t size) : fd_(std::move(fd)), size_(size) {
  // All pages are there from the start, so no drive waits for one.
  void* base = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, fd_.get(), 0);
  if (base == MAP_FAILED) throw no_memory();
  base_ = static_cast<std::byte*>(base);
}

SharedMemory::SharedMemory(SharedMemory&& other) noexcept
    : fd_(std::move(other.fd_)), base_(std::exchange(other.base_, nullptr)), size_(other.size_) {}

SharedMemory::~SharedMemory() {
  if (base_ != nullptr) munmap(base_, size_);
}

SharedMemory SharedMemory::make(std::span<const std::byte> brief, std::size_t transducers, std::uint32_t most_cycle) {
  Head head{};
  head.mark = mark;
  head.transducers = transducers;
  head.most_cycle = most_cycle;
  const std::size_t drive_bytes = transducers * sizeof(array::TransducerDrive);
  head.drive_size = whole_lines(sizeof(DriveHead) + drive_bytes);
  head.plan_size = most_cycle == 0 ? 0 : whole_lines(sizeof(PlanHead) + most_cycle * (sizeof(Vec3) + drive_bytes));
  head.brief = whole_lines(sizeof head);
  head.brief_size = brief.size();
  head.drives = head.brief + whole_lines(brief.size());
  head.plans = head.drives + line + 3 * head.drive_size;
  head.tally = head.plans + line + 3 * head.plan_size;
  head.size = head.tally + line;

  Descriptor fd(memfd_create("palpa-guard", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (!fd || ftruncate(fd.get(), static_cast<off_t>(head.size)) != 0) throw no_memory();
  fcntl(fd.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW);  // neither side can take the memory away from the other
  SharedMemory memory(std::move(fd), head.size);
  std::memcpy(memory.base_, &head, sizeof head);
  std::copy(brief.begin(), brief.end(), memory.base_ + head.brief);
  memory.drive_buffer().init();
  memory.plan_buffer().init();
  return memory;
}

SharedMemory SharedMemory::of(Descriptor fd) {
  struct stat status {};
  const Error wrong = failure("palpa-guard must be started by palpa, not by hand");
  if (fstat(fd.get(), &status) != 0 || static_cast<std::size_t>(status.st_size) < sizeof(Head)) throw wrong;
  SharedMemory memory(std::move(fd), static_cast<std::size_t>(status.st_size));
  if (memory.head().mark != mark || memory.head().size != memory.size_) throw wrong;
  return memory;
}

std::span<const std::byte> SharedMemory::brief() const {
  return {base_ + head().brief, head().brief_size};
}

TripleBuffer& SharedMemory::drive_buffer() const {
  return at<TripleBuffer>(head().drives);
}

TripleBuffer& SharedMemory::plan_buffer() const {
  return at<TripleBuffer>(head().plans);
}

Tally& SharedMemory::tally() const {
  return at<Tally>(head().tally);
}

SharedMemory::Place<DriveHead> SharedMemory::drive(std::uint32_t place) const {
  const std::size_t begin = head().drives + line + place * head().drive_size;
  return {at<DriveHead>(begin), {&at<array::TransducerDrive>(begin + sizeof(DriveHead)), head().transducers}};
}

SharedMemory::PlanPlace SharedMemory::plan(std::uint32_t place) const {
  const std::size_t begin = head().plans + line + place * head().plan_size;
  const std::size_t foci = begin + sizeof(PlanHead), drives = foci + head().most_cycle * sizeof(Vec3);
  return {at<PlanHead>(begin),
          {&at<Vec3>(foci), head().most_cycle},
          {&at<array::TransducerDrive>(drives), head().transducers * head().most_cycle}};
}

bool send_message(int socket, MessageKind kind, std::string_view text) {
  text = text.substr(0, Message::most);
  std::array<iovec, 2> parts{{{&kind, 1}, {const_cast<char*>(text.data()), text.size()}}};
  msghdr message{};
  message.msg_iov = parts.data();
  message.msg_iovlen = parts.size();
  return sendmsg(socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0 || (errno != EPIPE && errno != ECONNRESET);
}

Received receive_message(int socket, std::span<char, Message::most + 1> buffer, Message& message) {
  const auto take = [&] { return recv(socket, buffer.data(), buffer.size(), MSG_DONTWAIT); };
  ssize_t size = take();
  if (size < 0 && errno == ECONNRESET) size = take();  // it left with unread messages; its last words are there
  if (size < 0) return errno == EAGAIN || errno == EINTR ? Received::nothing : Received::gone;
  if (size == 0) return Received::gone;
  message = {static_cast<MessageKind>(buffer[0]), {buffer.data() + 1, static_cast<std::size_t>(size) - 1}};
  return Received::message;
}

}  // namespace palpa::driver
