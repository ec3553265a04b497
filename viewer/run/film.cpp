#include "viewer/run/film.hpp"

#include <fmt/core.h>

#include <system_error>

#include "base/error.hpp"

namespace palpa::viewer {

Film::Film(const std::string& folder) : folder_(folder) {
  if (!wanted()) return;
  std::error_code error;
  std::filesystem::create_directory(folder_, error);
  if (error) throw failure(fmt::format("{}: cannot be created: {}", folder, error.message()));
}

void Film::add(const drawing::Pixels& pixels) {
  if (wanted()) write_png(folder_ / fmt::format("{:06}.png", next_++), pixels);
}

}  // namespace palpa::viewer
