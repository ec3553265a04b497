// The only place where palpa opens a file for writing. Whole files go through base/output_file.hpp, growing files
// through base/stream_writer.hpp, and both call this file.
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "base/output_place.hpp"

namespace palpa {

/// How long to wait for the reader of a named pipe, in seconds; nullopt: without limit. Without a limit, a line says
/// what palpa waits for once the wait has taken half a second.
using ReaderPatience = std::optional<double>;
/// The patience of links. An array's drives are only useful now, so their reader has to be there first.
inline constexpr double link_patience_s = 0.5;

/// The wait for a pipe's reader was stopped on request. The code that requested the stop need not treat it as a
/// failure.
class WaitEnded : public Error {
 public:
  using Error::Error;
};

/// While one lives, the waits of this thread end with a WaitEnded when `stop` becomes true. Without one, a signal ends
/// the program or, if it is caught, the wait.
class WaitUntil {
 public:
  explicit WaitUntil(const std::atomic<bool>& stop);
  ~WaitUntil();
  WaitUntil(const WaitUntil&) = delete;
  WaitUntil& operator=(const WaitUntil&) = delete;

 private:
  const std::atomic<bool>* before_;
};

/// A descriptor for `file`, on which writes may block. A missing file is created, an existing one is emptied, and
/// stdout gives its own descriptor. `place` is output_place(file). Asks the register of files first. Locks a regular
/// file as lock_output does, before it is emptied. Throws failure() naming the file, also if nobody reads a pipe in
/// time.
int open_output(const std::filesystem::path& file, const OutputPlace& place, ReaderPatience patience = std::nullopt);

/// Keeps other writers away from a regular file until its descriptor is closed, however that ends. They may be in this
/// process or in another one, but must lock the file, too. Throws bad_usage if one has it. False, with errno, if the
/// file system has no locks.
bool lock_output(int descriptor, const std::string& name);
/// For a file that is about to be removed: throws bad_usage if somebody writes it at the moment.
void refuse_while_written(const std::filesystem::path& file);

/// The same as open_output for a place that is known to be an existing file.
int reopen_output(const OutputPlace& place);

}  // namespace palpa
