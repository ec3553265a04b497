// The one place where palpa opens a file to be written to. What is written whole goes through base/output_file.hpp,
// what grows through base/stream_writer.hpp; both come here.
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>

#include "base/error.hpp"
#include "base/output_place.hpp"

namespace palpa {

/// How long a named pipe's reader is waited for: seconds; nothing: as long as it takes. Then a line says what is waited
/// for once that has taken half a second.
using ReaderPatience = std::optional<double>;
/// Of links: an array's drives are for now, and whoever plays them is there before.
inline constexpr double link_patience_s = 0.5;

/// Somebody ended the wait for a pipe's reader: whoever asked for the end need not call it a failure.
class WaitEnded : public Error {
 public:
  using Error::Error;
};

/// While one lives, what this thread waits for is given up with a WaitEnded when `stop` becomes true. Without one a
/// signal ends the program or, where it is caught, the wait.
class WaitUntil {
 public:
  explicit WaitUntil(const std::atomic<bool>& stop);
  ~WaitUntil();
  WaitUntil(const WaitUntil&) = delete;
  WaitUntil& operator=(const WaitUntil&) = delete;

 private:
  const std::atomic<bool>* before_;
};

/// A descriptor, which writes may block on, of what `file` is: created where nothing is, emptied where a file is; for
/// stdout that of stdout. `place` is output_place(file). Asks the register of files first. Throws failure() naming the
/// file, also where nobody reads a pipe in time.
int open_output(const std::filesystem::path& file, const OutputPlace& place, ReaderPatience patience = std::nullopt);

/// The same where the place is known to be a file that is there.
int reopen_output(const OutputPlace& place);

}  // namespace palpa
