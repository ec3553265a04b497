// Threads, and what is said where the system gives none.
#pragma once

#include <system_error>
#include <thread>
#include <utility>

#include "base/error.hpp"

namespace palpa {

/// One line: what the thread is for, and which limit of this process or machine leaves no room for it.
Error no_thread(const char* purpose, const std::system_error& fault);

/// Whether a system_error is of a thread that could not be started.
bool is_no_thread(const std::system_error& fault);

/// A thread that runs `work`. Throws no_thread(): "the camera" as `purpose` reads "no thread for the camera".
template <typename Work>
std::thread start_thread(const char* purpose, Work&& work) {
  try {
    return std::thread(std::forward<Work>(work));
  } catch (const std::system_error& fault) {
    throw no_thread(purpose, fault);
  }
}

/// The same where the work can be done without: an empty thread where there is none.
template <typename Work>
std::thread try_thread(Work&& work) {
  try {
    return std::thread(std::forward<Work>(work));
  } catch (const std::system_error&) {
    return {};
  }
}

}  // namespace palpa
