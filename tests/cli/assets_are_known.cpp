// Programs that these tests start, and palpa's code in the tests themselves, find palpa's own files in the source tree.
#include <cstdlib>

#include "support/shared_data.hpp"

namespace {

[[maybe_unused]] const int assets_are_known = setenv("PALPA_ASSETS", palpa::test::source_file("assets").c_str(), 1);

}  // namespace
