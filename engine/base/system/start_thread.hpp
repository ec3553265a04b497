// Threads, and the error if the system cannot start one.
#pragma once

#include <system_error>
#include <thread>
#include <utility>

#include "base/error.hpp"

namespace palpa {

/// One line: what the thread is for, and which limit of this process or machine prevents it.
Error no_thread(const char* purpose, const std::system_error& fault);

/// Whether a system_error means that a thread could not be started.
bool is_no_thread(const std::system_error& fault);

/// Starts a thread that runs `work`. Throws no_thread(); the `purpose` "the camera" reads "no thread for the camera".
template <typename Work>
std::thread start_thread(const char* purpose, Work&& work) {
  try {
    return std::thread(std::forward<Work>(work));
  } catch (const std::system_error& fault) {
    throw no_thread(purpose, fault);
  }
}

/// The same for work that is optional: returns an empty thread if none can be started.
template <typename Work>
std::thread try_thread(Work&& work) {
  try {
    return std::thread(std::forward<Work>(work));
  } catch (const std::system_error&) {
    return {};
  }
}

}  // namespace palpa
