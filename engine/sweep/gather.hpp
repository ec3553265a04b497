// All results of a plan as one table.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sweep/plan.hpp"
#include "sweep/store.hpp"

namespace palpa::sweep {

struct Row {
  std::uint64_t index = 0;  ///< in the plan
  std::string id;
  State state = State::done;
  std::vector<std::string> settings;  ///< the values of Table::varied; empty where a value of an axis does not set one
  std::vector<std::string> results;   ///< JSON texts, one for each path of the plan; none unless done
  std::string error;                  ///< unless done
  double took_s = 0;
  std::int64_t ended_s = 0;
  std::size_t run = 0;  ///< an index of Table::runs
};

struct Table {
  std::vector<std::string> varied;  ///< options without "--"
  std::vector<std::string> paths;
  std::vector<Row> rows;      ///< in the plan's order; cases without a result are absent
  std::uint64_t missing = 0;  ///< so many of them
  std::uint64_t others = 0;   ///< results in the folder that belong to no case of the plan
  std::vector<RunInfo> runs;
  std::vector<std::string> empty_paths;  ///< that the plan names and no case has
};

/// Reads the folder of a sweep. Throws bad_input for missing files, bad_usage for results of another version.
Table table_of(const Plan& plan, const std::string& out);

/// id, the options that vary, the results, state: a line for each row. The same results give the same bytes, however
/// and wherever the cases were computed.
std::string to_csv(const Table& table);

/// Throws bad_usage if no table can be written under that name: it must end in .csv, or in .h5 if palpa has HDF5.
void check_table_name(const std::string& file);

/// What was gathered.
struct Gathered {
  std::uint64_t rows = 0, missing = 0, refused = 0, failed = 0, others = 0;
  std::vector<std::string> empty_paths;
};

/// Writes `file` (check_table_name), and beside it the provenance (crate.hpp). Throws failure() if cases have no
/// result, unless `partial`; if a line of a result is broken; if another process gathers the same folder at the moment;
/// and if the folder of `file` has the provenance of other results. Throws bad_usage if one of these files is an input
/// of the plan.
Gathered gather(const Plan& plan, const std::string& out, const std::string& file, bool partial);

}  // namespace palpa::sweep
