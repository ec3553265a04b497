#include "base/error.hpp"

namespace palpa {

Error bad_input(const std::string& file, const std::string& fault) {
  return {Exit::bad_input, file + ": " + fault};
}
Error bad_usage(const std::string& line) {
  return {Exit::usage, line};
}
Error failure(const std::string& line) {
  return {Exit::failed, line};
}

}  // namespace palpa
