// The docstrings of sweeps.
#pragma once

namespace palpa::python {

inline constexpr const char* sweep_doc = R"(Compute the cases of a plan, as palpa sweep does (docs/sweeps.md).

Several processes may compute the same plan into the same folder at the same time, each with another shard. Cases that
have a result in the folder are not computed again. Ctrl-C loses only the case that is computed at that time.

Parameters
----------
plan : path
    TOML file of the command, its options, and which of them vary (docs/files.md).
out : path, optional
    Folder of the results, for palpa.gather() and for other processes. Without it, results are only returned.
shard : (int, int) or str, optional
    (i, n) computes shard i of n, counted from 0; "i/n" and "env" are read as on the command line. The default is the
    whole plan.
claim : bool, optional
    Instead of a shard: compute whatever no other process with `claim` computes in the same folder.

Returns
-------
list of dict
    One for each case of the shard that has a result, in the plan's order: `id`, the options that vary, the results that
    the plan names, `state` ("done", "refused" or "failed"), and `error` if it is not done.
    pandas.DataFrame(palpa.sweep(plan)) is a table.

Raises
------
BadInput
    The plan or one of its files is missing or broken.
BadUsage
    The folder has results of another version of palpa, or arguments do not go together.
NoDevice
    There is no usable GPU, but one was asked for.)";

inline constexpr const char* gather_doc = R"(Write all results of a plan as one table, as palpa sweep --gather does.

The same results give the same bytes, however the cases were divided. The files of a Research Object Crate are written
beside the table (docs/sweeps.md).

Parameters
----------
plan : path
out : path
    The folder of the results.
file : path
    The table: .csv, or .h5 if palpa has HDF5.
partial : bool, optional
    Also if cases have no result yet.

Returns
-------
dict of str to int
    How many `rows` there are, how many of them were `refused` or `failed`, how many cases are `missing`, and how many
    results in the folder belong to `others` than this plan's cases.

Raises
------
BadUsage
    The table, or a file beside it, would replace an input of the plan.
Error
    Cases have no result yet, the disk is full, another process gathers the same folder, or the files beside the table
    would replace those of other results.)";

}  // namespace palpa::python
