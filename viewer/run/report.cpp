#include "viewer/run/report.hpp"

#include <fmt/core.h>

#include <string>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/text.hpp"
#include "setup/sessions/live_run.hpp"

namespace palpa::viewer {
namespace {

using drawing::Pixels;

std::string to_json(const PicturesDrawn& drawn, std::optional<double> difference) {
  JsonWriter json;
  json.begin_object().member("frames", drawn.ms.count());
  json.member("width", drawn.size.width).member("height", drawn.size.height);
  if (difference) json.member("difference", *difference);
  json.key("timing_ms").begin_object().member("frame", drawn.ms.quantile(0.5));
  json.member("frame_p95", drawn.ms.quantile(0.95)).end_object().end_object();
  return json.take();
}

std::string told(const PicturesDrawn& drawn) {
  const std::uint64_t frames = drawn.ms.count();
  const std::string most = frames > 1 ? fmt::format(", 95 % of them in {:.1f} ms", drawn.ms.quantile(0.95)) : "";
  return fmt::format("{} of {}x{} pixels, {:.1f} ms each{}", counted(frames, "frame"), drawn.size.width,
                     drawn.size.height, drawn.ms.quantile(0.5), most);
}

double compare(const ViewerOptions& options, const Pixels& pixels) {
  const Pixels reference = drawing::read_png(options.reference);
  if (reference.width != pixels.width || reference.height != pixels.height) {
    throw bad_input(options.reference,
                    fmt::format("is {}x{} pixels, but the picture is {}x{}: give --size {}x{}", reference.width,
                                reference.height, pixels.width, pixels.height, reference.width, reference.height));
  }
  return mean_difference(pixels, reference);
}

}  // namespace

void report_picture(const ViewerOptions& options, const Outputs& outputs, const Pixels& pixels,
                    const PicturesDrawn& drawn) {
  if (!options.screenshot.empty()) write_png(options.screenshot, pixels);
  std::optional<double> difference;
  if (!options.reference.empty()) difference = compare(options, pixels);
  if (!options.common.json.empty()) write_file(options.common.json, to_json(drawn, difference));
  const double threshold = options.threshold.value_or(0.02);
  if (difference && *difference > threshold) {
    throw failure(fmt::format("the picture differs from {} by {:.4f} on average, more than {}", options.reference,
                              *difference, threshold));
  }
  if (setup::shows_summary(options.common, outputs)) {
    write_file(
        "-", fmt::format("{}{}{}{}\n", told(drawn), options.video.empty() ? "" : "; in " + options.video,
                         options.screenshot.empty() ? "" : "; the last one is " + options.screenshot,
                         difference ? fmt::format("; differs from {} by {:.4f}", options.reference, *difference) : ""));
  }
}

void report_window(const ViewerOptions& options, const Outputs& outputs, const PicturesDrawn& drawn) {
  if (!options.common.json.empty()) write_file(options.common.json, to_json(drawn, {}));
  if (options.frames && setup::shows_summary(options.common, outputs)) write_file("-", told(drawn) + "\n");
}

void report_run(const ViewerOptions& options, const Outputs& outputs, const LiveSession* session) {
  const std::optional<session::LoopStats> stats = session ? session->stats() : std::nullopt;
  if (stats && setup::shows_summary(options.common, outputs))
    write_file("-", setup::summary(*stats, "", options.live.safety.ceiling));
}

}  // namespace palpa::viewer
