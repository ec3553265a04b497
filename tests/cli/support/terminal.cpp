#include "cli/support/terminal.hpp"

#include <poll.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <ctime>
#include <stdexcept>
#include <utility>

#include "cli/support/process.hpp"

namespace palpa::test {

Terminal::Terminal(const std::vector<std::string>& arguments) : Terminal(palpa_binary(), arguments) {}

Terminal::Terminal(const std::string& program, const std::vector<std::string>& arguments) {
  std::vector<std::string> line{program};
  line.insert(line.end(), arguments.begin(), arguments.end());
  std::vector<char*> words;
  for (std::string& word : line)
    words.push_back(word.data());
  words.push_back(nullptr);
  const winsize size{.ws_row = 24, .ws_col = 80, .ws_xpixel = 0, .ws_ypixel = 0};
  child_ = forkpty(&master_, nullptr, nullptr, &size);
  if (child_ < 0) throw std::runtime_error("no terminal to be had");
  if (child_ == 0) {
    // A program that runs the tests in the background may ignore these; a person at a terminal does not.
    for (const int key : {SIGINT, SIGQUIT, SIGHUP})
      signal(key, SIG_DFL);
    execvp(words[0], words.data());
    _exit(127);
  }
}

Terminal::~Terminal() {
  if (child_ > 0) {
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
  }
  close(master_);
}

bool Terminal::read_some(int timeout_ms) {
  pollfd ready{master_, POLLIN, 0};
  if (poll(&ready, 1, timeout_ms) <= 0) return true;
  std::array<char, 4096> bytes;
  const ssize_t got = read(master_, bytes.data(), bytes.size());
  if (got <= 0) return false;  // nobody holds the other end any more
  text_.append(bytes.data(), static_cast<std::size_t>(got));
  return true;
}

bool Terminal::shows(const std::string& part) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (text_.find(part) == std::string::npos) {
    if (std::chrono::steady_clock::now() > end || !read_some(100)) return text_.find(part) != std::string::npos;
  }
  return true;
}

void Terminal::type(const std::string& keys) {
  clockid_t of_child{};
  timespec so_far{};
  if (clock_getcpuclockid(child_, &of_child) == 0 && clock_gettime(of_child, &so_far) == 0)
    processor_s_ = -(static_cast<double>(so_far.tv_sec) + 1e-9 * static_cast<double>(so_far.tv_nsec));
  if (write(master_, keys.data(), keys.size()) < 0) throw std::runtime_error("the terminal takes no keys");
}

int Terminal::ended_by_signal() {
  while (read_some(1000)) {
  }
  int status = 0;
  rusage usage{};
  wait4(std::exchange(child_, 0), &status, 0, &usage);
  for (const timeval& time : {usage.ru_utime, usage.ru_stime})
    processor_s_ += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

}  // namespace palpa::test
