#include "bench/bench.hpp"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/text.hpp"
#include "bench/growth.hpp"
#include "cli/commands.hpp"
#include "line/values.hpp"
#include "setup/options/options.hpp"
#include "setup/process/progress.hpp"

namespace palpa::cli {
namespace {

enum class Suite { all, touch, surface, array, acoustics, loop, links, growth };

struct BenchCommand {
  setup::CommonOptions common;
  Suite suite = Suite::all;
  std::uint32_t runs = 200;
  std::string csv, scene;
};

void add_options_of_bench(CLI::App& app, BenchCommand& o) {
  const line::Group group(app, "What to measure");
  group.choice("--suite", o.suite,
               {{"all", Suite::all},
                {"touch", Suite::touch},
                {"surface", Suite::surface},
                {"array", Suite::array},
                {"acoustics", Suite::acoustics},
                {"loop", Suite::loop},
                {"links", Suite::links},
                {"growth", Suite::growth}},
               "what is measured: points to foci (touch), solids of many faces (surface), drives (array), their sound "
               "(acoustics), depth frames to drives (loop), drives to the wire (links), how frames grow with the size "
               "of everything (growth, not part of all)");
  group.text("--scene", o.scene, "FILE", "with --suite surface or all: glTF model that is measured as well [no model]");
  add_allow_outside(group, o.common);
  group.integer("--runs", o.runs, 3, 100'000, "number of timed runs of each case, after a warm-up");
  group.text("--csv", o.csv, "FILE|-", "writes the table as CSV, with the names of its columns in the first line");
}

std::string bench_csv(const std::vector<bench::Row>& rows, const gpu::DeviceDescription& device) {
  std::string csv = "suite,case,stage,median_ms,p99_ms,min_ms,runs,value,unit,note,device,driver\n";
  for (const bench::Row& row : rows) {
    csv += fmt::format("{},{},{},{:.5g},{:.5g},{:.5g},{},{:.6g},{},{},{},{}\n", row.suite, csv_cell(row.name),
                       row.stage, row.median_ms, row.p99_ms, row.least_ms, row.runs, row.value, row.unit,
                       csv_cell(row.note), csv_cell(device.name), csv_cell(device.driver));
  }
  return csv;
}

std::string bench_json(const std::vector<bench::Row>& rows, const gpu::DeviceDescription& device,
                       std::uint64_t resident) {
  JsonWriter json;
  json.begin_object().member("device", device.name).member("driver", device.driver);
  json.member("peak_resident_bytes", resident).key("rows").begin_array();
  for (const bench::Row& row : rows) {
    json.begin_object().member("suite", row.suite).member("case", row.name).member("stage", row.stage);
    json.member("median_ms", row.median_ms).member("p99_ms", row.p99_ms).member("min_ms", row.least_ms);
    json.member("runs", std::uint64_t{row.runs})
        .member("value", row.value)
        .member("unit", row.unit)
        .member("note", row.note);
    json.end_object();
  }
  json.end_array().end_object();
  return json.take();
}

std::string bench_table(const std::vector<bench::Row>& rows, const gpu::DeviceDescription& device,
                        std::uint64_t resident) {
  std::string text = fmt::format("{}, {}\n{:<9} {:<32} {:<14} {:>10} {:>10} {:>10}\n", device.name, device.driver,
                                 "suite", "case", "stage", "median ms", "p99 ms", "min ms");
  for (const bench::Row& row : rows) {
    text += fmt::format("{:<9} {:<32} {:<14} {:>10.3f} {:>10.3f} {:>10.3f}", row.suite, row.name, row.stage,
                        row.median_ms, row.p99_ms, row.least_ms);
    if (row.value > 0) text += fmt::format("  {:.0f} {}", row.value, row.unit);
    if (!row.note.empty()) text += "; " + row.note;
    text += '\n';
  }
  return text + fmt::format("resident memory at most {} MB\n", resident / 1'000'000);
}

void run_bench(const BenchCommand& o, const Extensions& extensions) {
  if (o.common.backend == setup::Backend::cpu)
    throw bad_usage("bench measures the GPU's passes, which --backend cpu does not have");
  if (!o.scene.empty() && o.suite != Suite::all && o.suite != Suite::surface)
    throw bad_usage("--scene goes with --suite surface or --suite all");
  const Outputs outputs({{"--json", o.common.json}, {"--csv", o.csv}});
  std::optional<bench::Model> model;
  if (!o.scene.empty()) {
    const setup::Preparing progress(o.common.quiet);
    model = bench::load_model(o.scene);
  }
  const gpu::Device device(setup::device_options(o.common));
  std::vector<bench::Row> rows;
  std::unique_ptr<setup::Progress> bar;
  std::string shown;
  const bench::Context context{device, o.runs, std::move(model),
                               [&](const std::string& what, std::uint64_t done, std::uint64_t total) {
                                 if (what != shown || !bar) {
                                   bar.reset();
                                   bar = std::make_unique<setup::Progress>(what, total, o.common.quiet);
                                   shown = what;
                                 }
                                 bar->set(done);
                               }};
  if (o.suite == Suite::all || o.suite == Suite::touch) {
    bench::measure_touch(context, rows);
    bench::measure_methods(context, rows);
  }
  if (o.suite == Suite::all || o.suite == Suite::surface) bench::measure_surface(context, rows);
  if (o.suite == Suite::all || o.suite == Suite::array) {
    bench::measure_array(context, rows);
    bench::measure_solvers(context, rows);
    bench::measure_nulls(context, rows);
  }
  if (o.suite == Suite::all || o.suite == Suite::acoustics) {
    bench::measure_field(context, rows);
    bench::measure_scattering(context, rows);
  }
  if (o.suite == Suite::all || o.suite == Suite::loop) bench::measure_loop(context, rows);
  if (o.suite == Suite::all || o.suite == Suite::links) {
    for (const auto& measure : extensions.benches)
      measure(o.runs, rows);
  }
  if (o.suite == Suite::growth) bench::measure_growth(context, bench::any_size, rows);
  bar.reset();

  const std::uint64_t resident = bench::peak_resident_bytes();
  if (!o.csv.empty()) write_file(o.csv, bench_csv(rows, device.description()));
  if (!o.common.json.empty()) write_file(o.common.json, bench_json(rows, device.description(), resident));
  if (setup::shows_summary(o.common, outputs)) {
    write_file("-", bench_table(rows, device.description(), resident));
  }
}

}  // namespace

void add_bench(Program& program) {
  add_subcommand<BenchCommand>(program,
                               {"bench", "how fast this machine is, after a check that its results are correct",
                                "  palpa bench\n"
                                "  palpa bench --suite loop --runs 1000 --csv loop.csv"},
                               add_options_of_bench,
                               [&extensions = program.extensions](const BenchCommand& o) { run_bench(o, extensions); });
}

}  // namespace palpa::cli
