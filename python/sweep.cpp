#include <fmt/format.h>
#include <pybind11/stl.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <unordered_set>
#include <vector>

#include "base/error.hpp"
#include "base/reference.hpp"
#include "base/words.hpp"
#include "module.hpp"
#include "options.hpp"
#include "running.hpp"
#include "setup/options.hpp"
#include "setup/values.hpp"
#include "shapes.hpp"
#include "sweep/gather.hpp"
#include "sweep/run.hpp"
#include "sweep_doc.hpp"

namespace palpa::python {
namespace {

void add_sweep_options(CLI::App& app, setup::CommonOptions& o) {
  setup::add_common(app, o);
  setup::add_allow_outside(setup::Group(app, "What to compute"), o);
}
Declared<setup::CommonOptions>& sweep_options() {
  // Cases have their own seeds.
  static auto* const options =
      new Declared<setup::CommonOptions>("sweep", add_sweep_options, {"--json", "--quiet", "--log-level", "--seed"});
  return *options;
}

/// A folder that is removed at the end.
class ScratchFolder {
 public:
  ScratchFolder() : name_((std::filesystem::temp_directory_path() / "palpa-sweep-XXXXXX").string()) {
    if (!mkdtemp(name_.data()))
      throw failure(fmt::format("{}: cannot be created: {}", name_, std::generic_category().message(errno)));
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(name_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& name() const { return name_; }

 private:
  std::string name_;
};

sweep::Shard shard_of(const py::object& shard) {
  if (shard.is_none()) return {};
  if (py::isinstance<py::str>(shard)) return sweep::parse_shard(bytes_of("shard", shard));
  if (!is_list(shard) || py::len(shard) != 2) throw bad_usage("shard: give (i, n), \"i/n\" or \"env\"");
  return sweep::parse_shard(fmt::format("{}/{}", bytes_of("shard", py::str(shard[py::int_(0)])),
                                        bytes_of("shard", py::str(shard[py::int_(1)]))));
}

/// A value of a plan: a number if it is one, otherwise its text.
py::object number_or_text(const std::string& text) {
  double number = 0;
  std::int64_t whole = 0;
  const char* const end = text.data() + text.size();
  if (text.empty()) return py::none();
  if (const auto read = std::from_chars(text.data(), end, whole); read.ec == std::errc() && read.ptr == end)
    return py::int_(whole);
  if (const auto read = std::from_chars(text.data(), end, number); read.ec == std::errc() && read.ptr == end)
    return py::float_(number);
  return py::str(text);
}

py::list rows_of(const sweep::Table& table, const std::vector<std::string>& ids) {
  const std::unordered_set<std::string_view> mine(ids.begin(), ids.end());
  const py::object loads = py::module_::import("json").attr("loads");
  py::list rows;
  for (const sweep::Row& row : table.rows) {
    if (!mine.contains(row.id)) continue;
    py::dict made;
    made["id"] = row.id;
    for (std::size_t i = 0; i < table.varied.size(); ++i)
      made[table.varied[i].c_str()] = number_or_text(row.settings[i]);
    for (std::size_t i = 0; i < table.paths.size(); ++i)
      made[table.paths[i].c_str()] = row.results.empty() ? py::none() : loads(row.results[i]);
    made["state"] = std::string(word_of(sweep::state_words, row.state));
    if (row.state != sweep::State::done) made["error"] = row.error;
    rows.append(std::move(made));
  }
  return rows;
}

py::list run_sweep(const py::object& plan, const py::object& out, const py::object& shard, bool claim,
                   const py::kwargs& kwargs) {
  refuse_fork();
  const setup::CommonOptions o = sweep_options().read(kwargs);
  const std::string file = file_of("plan", plan);
  if (claim && !shard.is_none()) throw bad_usage("claim and shard exclude each other: give one of them");
  if (claim && out.is_none()) throw bad_usage("claim goes with out: the processes share a folder");
  check(o);
  std::atomic<bool> stop{false};
  sweep::SweepTask task{.shard = shard_of(shard), .claim = claim, .compute = o, .stop = &stop};
  if (!out.is_none()) task.out = file_of("out", out);
  allow_outside_references(o.allow_outside);
  std::vector<std::string> ids;
  sweep::Table table;
  run_beside(stop, [&] {
    std::optional<ScratchFolder> scratch;
    if (task.out.empty()) task.out = scratch.emplace().name();
    const sweep::Plan read = sweep::load_plan(file);
    ids = sweep::run_sweep(read, task).ids;
    if (!stop) table = sweep::table_of(read, task.out);
  });
  return rows_of(table, ids);
}

py::dict gather(const py::object& plan, const py::object& out, const py::object& file, bool partial) {
  const std::string from = file_of("plan", plan), folder = file_of("out", out), to = file_of("file", file);
  const sweep::Gathered gathered =
      cancellable([&] { return sweep::gather(sweep::load_plan(from), folder, to, partial); });
  py::dict made;
  made["rows"] = gathered.rows;
  made["missing"] = gathered.missing;
  made["refused"] = gathered.refused;
  made["failed"] = gathered.failed;
  made["others"] = gathered.others;
  return made;
}

}  // namespace

void add_sweeps(py::module_& m) {
  const std::string doc = sweep_options().documented(sweep_doc);
  m.def("sweep", &run_sweep, py::arg("plan"), py::arg("out") = py::none(), py::kw_only(), py::arg("shard") = py::none(),
        py::arg("claim") = false, doc.c_str());
  m.def("gather", &gather, py::arg("plan"), py::arg("out"), py::arg("file"), py::kw_only(), py::arg("partial") = false,
        gather_doc);
}

}  // namespace palpa::python
