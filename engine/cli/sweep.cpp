#include "sweep/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/json_writer.hpp"
#include "base/log.hpp"
#include "base/memory.hpp"
#include "base/output_file.hpp"
#include "base/outputs.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "setup/options.hpp"
#include "setup/progress.hpp"
#include "setup/values.hpp"
#include "sweep/cases.hpp"
#include "sweep/forecast.hpp"
#include "sweep/gather.hpp"

namespace palpa::cli {
namespace {

struct SweepCommand {
  setup::CommonOptions common;
  std::vector<std::string> plan;
  std::string out, shard, gather;
  bool claim = false, list = false, estimate = false, partial = false;
};

void add_options_of_sweep(CLI::App& app, SweepCommand& o) {
  const setup::Group group(app, "What to compute");
  group.words("plan", o.plan, "PLAN", "TOML file of the command, its options, and which of them vary");
  group.text("--out", o.out, "DIR", "folder of the results; cases that have one there are not computed again");
  group.text("--shard", o.shard, "I/N|env",
             "computes shard I of N shards, counted from 0; env takes both from Slurm or mpirun [0/1]");
  group.flag("--claim", o.claim,
             "instead of a shard, computes whatever no other process with --claim computes in the same folder");
  add_allow_outside(group, o.common);
  const setup::Group instead(app, "Instead of computing");
  instead.flag("--list", o.list, "prints the cases as CSV; with --estimate, also how long they take");
  instead.flag(
      "--estimate", o.estimate,
      "prints how long the cases take, with this --backend, and how much memory they need; with --out, also from "
      "the results there");
  instead.text("--gather", o.gather, "FILE",
               "writes all results as one table (.csv, or .h5 with HDF5), and beside it where they come from");
  instead.flag("--partial", o.partial, "with --gather: also if cases have no result yet");
}

void check_sweep(const SweepCommand& o) {
  if (o.plan.size() != 1)
    throw bad_usage(o.plan.empty() ? "give palpa sweep a plan, such as plan.toml" : "give palpa sweep one plan");
  const bool looks = o.list || o.estimate, gathers = !o.gather.empty();
  if (looks && gathers) throw bad_usage("--gather excludes --list and --estimate: give one of them");
  if (o.claim && !o.shard.empty())
    throw bad_usage("--claim and --shard exclude each other: both say which cases are computed");
  if (gathers && (o.claim || !o.shard.empty()))
    throw bad_usage(fmt::format("--gather takes all results; leave out {}", o.claim ? "--claim" : "--shard"));
  if (looks && o.claim) throw bad_usage("--claim computes cases; leave it out with --list and --estimate");
  if (o.partial && !gathers) throw bad_usage("--partial goes with --gather");
  if (o.list && !o.estimate && !o.out.empty()) throw bad_usage("--out has no effect on --list; leave it out");
  if (o.out.empty() && !looks) throw bad_usage("--out is missing: give a folder for the results");
  if (o.common.seed != 0) throw bad_usage("--seed belongs to the cases: set seed in the plan");
  if (looks || gathers) {
    setup::refuse_gpu_options(o.common, "nothing is computed");
    if (o.common.backend != setup::Backend::automatic && !o.estimate)
      throw bad_usage("--backend: nothing is computed; leave it out");
  }
}

// ---- --list, --estimate -------------------------------------------------------------------------------------------

std::string minutes(double seconds) {
  if (seconds < 120) return fmt::format("{:.3g} s", seconds);
  if (seconds < 7200) return fmt::format("{:.3g} min", seconds / 60);
  return fmt::format("{:.3g} h", seconds / 3600);
}

std::string list_csv(const sweep::Plan& plan, const std::vector<sweep::Case>& cases, bool costs, double factor,
                     setup::Backend backend) {
  const std::vector<std::string> varied = plan.varied();
  std::string csv = "id";
  for (const std::string& option : varied)
    csv.append(",").append(option, 2);
  csv += costs ? ",seconds,megabytes\n" : "\n";
  for (const sweep::Case& one : cases) {
    std::vector<std::string> values(varied.size());
    for (const sweep::Setting& setting : plan.settings(one.index)) {
      const auto at = std::ranges::find(varied, setting.option);
      if (at != varied.end()) values[static_cast<std::size_t>(at - varied.begin())] = csv_cell(setting.shown());
    }
    csv += fmt::format("{}{}{}", one.id, values.empty() ? "" : ",", fmt::join(values, ","));
    if (costs) csv += fmt::format(",{:.3g},{:.3g}", one.cost.all_s(backend) * factor, one.cost.bytes / 1e6);
    csv += '\n';
  }
  return csv;
}

std::string forecast_text(const sweep::Forecast& forecast) {
  std::string text = fmt::format("{}: {:.3g} to {:.3g} s each, half of them at most {:.3g} s; {} in all\n",
                                 counted(forecast.cases, "case"), forecast.least_s, forecast.most_s, forecast.median_s,
                                 minutes(forecast.all_s));
  fmt::format_to(std::back_inserter(text), "memory: at most {} for a case, in addition to what palpa itself needs\n",
                 format_bytes(static_cast<std::uint64_t>(forecast.most_bytes)));
  if (forecast.measured != 0) {
    fmt::format_to(std::back_inserter(text), "the times are {:.2f} times the models', as {} there took\n",
                   forecast.factor, counted(forecast.measured, "result"));
  } else {
    text += "the times are those of two idle cores of a Xeon without a GPU\n";
  }
  return text;
}

std::string forecast_json(const sweep::Forecast& forecast) {
  JsonWriter json;
  json.begin_object()
      .member("cases", forecast.cases)
      .member("least_s", forecast.least_s)
      .member("median_s", forecast.median_s)
      .member("most_s", forecast.most_s)
      .member("all_s", forecast.all_s)
      .member("most_bytes", forecast.most_bytes)
      .member("measured", forecast.measured)
      .member("factor", forecast.factor)
      .end_object();
  return json.take();
}

void look(const SweepCommand& o, const sweep::Plan& plan) {
  const Outputs outputs({{"--json", o.common.json}});
  if (o.list && !o.estimate && !o.common.json.empty())
    throw bad_usage("--json: --list prints CSV; leave it out, or give --estimate");
  std::optional<setup::Preparing> preparing(std::in_place, o.common.quiet);
  sweep::refuse_hopeless(plan);
  const sweep::Inputs inputs(plan);
  const std::vector<sweep::Case> all = sweep::list_cases(plan, inputs, o.estimate || !o.shard.empty());
  const std::vector<sweep::Case> mine = o.shard.empty() ? all : sweep::deal(all, sweep::parse_shard(o.shard));
  const setup::Backend backend = o.estimate ? setup::used_backend(o.common).backend : setup::Backend::cpu;
  const sweep::Forecast forecast = sweep::forecast_of(all, mine, o.out, backend);
  preparing.reset();
  if (o.estimate && !o.common.json.empty()) write_file(o.common.json, forecast_json(forecast));
  if (outputs.on_stdout()) return;
  // --quiet leaves out summaries; the list is the result.
  if (o.list) {
    write_file("-", list_csv(plan, mine, o.estimate, forecast.factor, backend));
  } else if (!o.common.quiet) {
    write_file("-", forecast_text(forecast));
  }
}

// ---- --gather ------------------------------------------------------------------------------------------------------

void gather(const SweepCommand& o, const std::string& file) {
  sweep::check_table_name(o.gather);
  const Outputs outputs({{"--json", o.common.json}});
  std::optional<setup::Preparing> preparing(std::in_place, o.common.quiet);
  const sweep::Gathered gathered = sweep::gather(sweep::load_plan(file), o.out, o.gather, o.partial);
  preparing.reset();
  for (const std::string& path : gathered.empty_paths)
    log::warning(fmt::format("{}: results: no case has {}", file, path));
  if (!o.common.json.empty()) {
    JsonWriter json;
    json.begin_object()
        .member("rows", gathered.rows)
        .member("missing", gathered.missing)
        .member("refused", gathered.refused)
        .member("failed", gathered.failed)
        .member("others", gathered.others)
        .end_object();
    write_file(o.common.json, json.take());
  }
  if (!setup::shows_summary(o.common, outputs)) return;
  std::string text = counted(gathered.rows, "row");
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count != 0) text += fmt::format("; {} {}", count, what);
  };
  add(gathered.refused, "refused");
  add(gathered.failed, "failed");
  add(gathered.missing, "without a result");
  add(gathered.others,
      gathered.others == 1 ? "result in the folder is not of this plan" : "results in the folder are not of this plan");
  write_file("-", text + "\n");
}

// ---- computing -----------------------------------------------------------------------------------------------------

std::string report_json(const sweep::SweepReport& report) {
  JsonWriter json;
  json.begin_object()
      .member("cases", report.cases)
      .member("shard", report.mine)
      .member("before", report.before)
      .member("done", report.done)
      .member("refused", report.refused)
      .member("failed", report.failed)
      .member("elsewhere", report.elsewhere)
      .member("first_fault", std::string_view(report.first_fault))
      .key("timing_ms")
      .begin_object()
      .member("total", report.seconds * 1e3)
      .end_object()
      .end_object();
  return json.take();
}

std::string report_text(const sweep::SweepReport& report) {
  const std::uint64_t computed = report.done + report.refused + report.failed;
  std::string text = counted(report.cases, "case");
  if (report.mine != report.cases) text += fmt::format(", {} in this shard", report.mine);
  text += fmt::format(": {} computed in {:.2f} s", computed, report.seconds);
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count != 0) text += fmt::format(", {} {}", count, what);
  };
  add(report.before, "had a result");
  add(report.refused, "refused");
  add(report.failed, "failed");
  add(report.elsewhere, "computed by another process");
  return text + "\n";
}

void compute(const SweepCommand& o, const sweep::Plan& plan) {
  const Outputs outputs({{"--json", o.common.json}});
  sweep::SweepTask task{.out = o.out, .claim = o.claim, .compute = o.common};
  if (!o.shard.empty()) task.shard = sweep::parse_shard(o.shard);
  std::optional<setup::Progress> progress;
  const sweep::SweepReport report =
      sweep::run_sweep(plan, task, [&](const sweep::CaseLine&, std::uint64_t number, std::uint64_t of) {
        if (!progress) progress.emplace("cases", of, o.common.quiet);
        progress->set(number);
        return true;
      });
  progress.reset();
  if (!o.common.json.empty()) write_file(o.common.json, report_json(report));
  if (setup::shows_summary(o.common, outputs)) write_file("-", report_text(report));
  if (report.failed != 0) {
    throw failure(fmt::format("{} of {} failed; the same command computes what failed again; {}", report.failed,
                              counted(report.done + report.refused + report.failed, "case"), report.first_fault));
  }
  if (report.all_in_vain) {
    throw failure(
        fmt::format("no case could be computed: all were refused; {}",
                    report.first_fault.empty() ? "--gather writes why into provenance.csv" : report.first_fault));
  }
  if (report.refused == 0) return;
  log::warning(report.refused == 1
                   ? fmt::format("1 case was refused: {}", report.first_fault)
                   : fmt::format("{} cases were refused; the first: {}", report.refused, report.first_fault));
}

void run_sweep(const SweepCommand& o) {
  check_sweep(o);
  const std::string& file = o.plan.front();
  if (!o.gather.empty()) return gather(o, file);
  const sweep::Plan plan = sweep::load_plan(file);
  if (o.list || o.estimate) return look(o, plan);
  compute(o, plan);
}

}  // namespace

void add_sweep(Program& program) {
  add_subcommand<SweepCommand>(
      program,
      {"sweep", "many cases of touch, drive, field or simulate, in shards",
       "  palpa sweep plan.toml --out results --shard 0/4\n"
       "  palpa sweep plan.toml --out results --gather results/table.csv",
       "--out --shard --claim --list --estimate --gather --partial",
       "docs/files.md describes the plan, docs/sweeps.md job arrays, mpirun and others. Running the same command again "
       "continues.",
       "PLAN"},
      add_options_of_sweep, run_sweep);
}

}  // namespace palpa::cli
