// The palpa::Error that something throws.
#pragma once

#include "base/error.hpp"

namespace palpa::test {

/// What `work` throws; an Error with Exit::ok where it throws none.
template <typename Work>
Error thrown_by(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return error;
  }
  return Error(Exit::ok, "");
}

}  // namespace palpa::test
