#include "study/files/gzip.hpp"

#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/files/input_file.hpp"

namespace palpa::study {
namespace {

/// Ends zlib's state however its user leaves.
struct Inflating {
  z_stream stream{};
  Inflating() = default;
  Inflating(const Inflating&) = delete;
  Inflating& operator=(const Inflating&) = delete;
  ~Inflating() { inflateEnd(&stream); }
};

}  // namespace

Unpacked read_gzip(const std::filesystem::path& file, std::uint64_t most_packed, std::uint64_t most_bytes) {
  std::string packed = read_file(file, most_packed);
  Inflating inflating;
  z_stream& stream = inflating.stream;
  constexpr int gzip_only = 16 + MAX_WBITS;
  if (inflateInit2(&stream, gzip_only) != Z_OK) throw failure("zlib cannot start: not enough memory");
  stream.next_in = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  Unpacked out;
  for (;;) {
    const std::size_t before = out.text.size();
    const std::size_t room = std::min<std::uint64_t>(std::max<std::size_t>(before, 1u << 16), most_bytes + 1 - before);
    out.text.resize(before + room);
    stream.next_out = reinterpret_cast<Bytef*>(out.text.data() + before);
    stream.avail_out = static_cast<uInt>(room);
    const int code = inflate(&stream, Z_NO_FLUSH);
    out.text.resize(before + room - stream.avail_out);
    if (out.text.size() > most_bytes)
      throw bad_input(file.string(), fmt::format("has more than {} bytes unpacked", most_bytes));
    if (code == Z_STREAM_END) {
      // Zeros at the end are no data: tapes, disks and copies are filled with them.
      if (std::all_of(stream.next_in, stream.next_in + stream.avail_in, [](Bytef byte) { return byte == 0; }))
        return out;
      // Another packed file follows, which counts as the rest of this one.
      if (inflateReset(&stream) != Z_OK) throw bad_input(file.string(), "is damaged");
      continue;
    }
    if (code == Z_BUF_ERROR || (code == Z_OK && stream.avail_in == 0 && stream.avail_out > 0)) {
      out.cut = true;
      return out;
    }
    if (code != Z_OK) {
      throw bad_input(file.string(), out.text.empty()
                                         ? "is not a gzip file, or it is damaged"
                                         : fmt::format("is damaged after {} unpacked bytes", out.text.size()));
    }
  }
}

std::string gzip_of(std::string_view bytes) {
  z_stream stream{};
  constexpr int gzip_only = 16 + MAX_WBITS, memory = 8;
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, gzip_only, memory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw failure("zlib cannot start: not enough memory");
  std::string packed(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  std::string input(bytes);  // zlib's interface has no const
  stream.next_in = reinterpret_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(input.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int code = deflate(&stream, Z_FINISH);
  packed.erase(std::min<std::size_t>(packed.size(), stream.total_out));
  deflateEnd(&stream);
  if (code != Z_STREAM_END) throw failure("zlib cannot pack: not enough memory");
  return packed;
}

std::uint32_t crc32_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      ::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<z_size_t>(bytes.size())));
}

}  // namespace palpa::study
