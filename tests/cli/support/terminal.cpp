#include "cli/support/terminal.hpp"

#include <poll.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "cli/support/process.hpp"
#include "support/files.hpp"

namespace palpa::test {
namespace {

/// The processes of a session: what its first process started and did not send away.
std::vector<pid_t> processes_of(pid_t session) {
  std::vector<pid_t> processes;
  std::error_code gone;
  std::filesystem::directory_iterator entry("/proc", gone);
  for (; !gone && entry != std::filesystem::directory_iterator(); entry.increment(gone)) {
    const pid_t process = std::atoi(entry->path().filename().c_str());
    if (process <= 0) continue;
    const std::string stat = read_text(entry->path() / "stat");  // PID (NAME) STATE PARENT GROUP SESSION ...
    const std::size_t name_end = stat.rfind(") ");
    if (name_end == std::string::npos) continue;
    std::istringstream fields(stat.substr(name_end + 2));
    char state = 0;
    pid_t parent = 0, group = 0, own = 0;
    if (fields >> state >> parent >> group >> own && own == session) processes.push_back(process);
  }
  return processes;
}

}  // namespace

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
    unsetenv("COLUMNS");
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

bool Terminal::read_some() {
  if (delays_) delays_->look();
  pollfd ready{master_, POLLIN, 0};
  if (poll(&ready, 1, 2) <= 0) return true;
  std::array<char, 4096> bytes;
  const ssize_t got = read(master_, bytes.data(), bytes.size());
  if (got <= 0) return false;  // nobody holds the other end any more
  text_.append(bytes.data(), static_cast<std::size_t>(got));
  return true;
}

bool Terminal::shows(const std::string& part) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (text_.find(part) == std::string::npos) {
    if (std::chrono::steady_clock::now() > end || !read_some()) return text_.find(part) != std::string::npos;
  }
  return true;
}

void Terminal::type(const std::string& keys) {
  delays_.emplace(processes_of(child_));
  clockid_t of_child{};
  timespec so_far{};
  if (clock_getcpuclockid(child_, &of_child) == 0 && clock_gettime(of_child, &so_far) == 0)
    processor_s_ = -(static_cast<double>(so_far.tv_sec) + 1e-9 * static_cast<double>(so_far.tv_nsec));
  if (write(master_, keys.data(), keys.size()) < 0) throw std::runtime_error("the terminal takes no keys");
}

int Terminal::ended_by_signal() {
  while (read_some()) {
  }
  int status = 0;
  rusage usage{};
  wait4(std::exchange(child_, 0), &status, 0, &usage);
  for (const timeval& time : {usage.ru_utime, usage.ru_stime})
    processor_s_ += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

bool Terminal::cut_short() const {
  if (!delays_ || delays_->sum_s() <= delay_that_is_told_s) return false;
  const std::size_t error = text_.find("palpa: error: ");
  if (error == std::string::npos) return exit_code_ == 1;  // no time for the line
  return text_.find("ended without finishing, one second after the signal", error) != std::string::npos;
}

}  // namespace palpa::test
