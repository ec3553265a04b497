// `palpa calibrate --by-touch`: the poses of cameras from foci that a person touches.
#include <string>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "cli/calibrate.hpp"
#include "setup/options/options.hpp"
#include "setup/tasks/by_touch.hpp"

namespace palpa::cli {

void run_by_touch(const Extensions& extensions, const CalibrateCommand& given) {
  CalibrateCommand o = given;
  check_keys(o, "--by-touch");
  if (o.source.empty()) o.source = "synthetic";
  o.every_frame = !o.keys.empty();  // a script takes as many frames as it has keys
  setup::ByTouch by_touch(o, o.out, extensions.sources, extensions.links);
  setup::check(o);
  const Outputs outputs({{"--json", o.common.json},
                         {"--out", o.out},
                         {"--link", session::file_of_link(o.link, setup::with_builtin(extensions.links))}});
  const KeysEnd end = run_with_keys(o, by_touch.sources(), extensions.links, "--by-touch", &by_touch.touches());
  const std::string summary = by_touch.finish(end.saves, o.common.json);
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary);
  if (end.fault) throw Error(*end.fault);
}

}  // namespace palpa::cli
