#include "sweep/hdf5_table.hpp"

#include "base/error.hpp"

#ifdef PALPA_WITH_HDF5
#include <hdf5.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/units.hpp"
#endif

namespace palpa::sweep {

#ifdef PALPA_WITH_HDF5

namespace {

/// An object of HDF5, closed at the end.
class Owned {
 public:
  Owned(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    if (id < 0) throw failure("HDF5 cannot make a table");
  }
  ~Owned() { close_(id_); }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  hid_t get() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void check(herr_t result) {
  if (result < 0) throw failure("HDF5 cannot write a table");
}

/// A file in memory, to which columns are added.
class File {
 public:
  File() : access_(H5Pcreate(H5P_FILE_ACCESS), H5Pclose), plain_(H5Pcreate(H5P_DATASET_CREATE), H5Pclose) {
    check(H5Pset_fapl_core(access_.get(), 1U << 20, false));
    check(H5Pset_libver_bounds(access_.get(), H5F_LIBVER_V18, H5F_LIBVER_V18));
    check(H5Pset_obj_track_times(plain_.get(), false));  // the same table, the same bytes
    const Owned root(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    check(H5Pset_obj_track_times(root.get(), false));
    file_ = std::make_unique<Owned>(H5Fcreate("table", H5F_ACC_TRUNC, root.get(), access_.get()), H5Fclose);
  }

  void add(const std::string& name, const std::vector<double>& numbers) {
    write(name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, numbers.size(), numbers.data());
  }
  void add(const std::string& name, const std::vector<std::string>& texts) {
    std::size_t width = 1;
    for (const std::string& text : texts)
      width = std::max(width, text.size());
    std::string bytes;
    for (const std::string& text : texts)
      bytes += text + std::string(width - text.size(), '\0');
    const Owned type(H5Tcopy(H5T_C_S1), H5Tclose);
    check(H5Tset_size(type.get(), width));
    check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD));
    check(H5Tset_cset(type.get(), H5T_CSET_UTF8));
    write(name, type.get(), type.get(), texts.size(), bytes.data());
  }

  std::string bytes() const {
    check(H5Fflush(file_->get(), H5F_SCOPE_GLOBAL));
    const ssize_t size = H5Fget_file_image(file_->get(), nullptr, 0);
    if (size < 0) throw failure("HDF5 cannot write a table");
    std::string image(static_cast<std::size_t>(size), '\0');
    if (H5Fget_file_image(file_->get(), image.data(), image.size()) != size) throw failure("HDF5 cannot write a table");
    return image;
  }

 private:
  void write(const std::string& name, hid_t stored, hid_t given, std::size_t count, const void* values) {
    const hsize_t size = count;
    const Owned space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    const Owned set(H5Dcreate2(file_->get(), name.c_str(), stored, space.get(), H5P_DEFAULT, plain_.get(), H5P_DEFAULT),
                    H5Dclose);
    check(H5Dwrite(set.get(), given, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
  }

  Owned access_, plain_;
  std::unique_ptr<Owned> file_;
};

/// The JSON texts as numbers if all of them are numbers or missing; empty otherwise.
std::vector<double> as_numbers(const std::vector<std::string>& texts) {
  std::vector<double> numbers;
  for (const std::string& text : texts) {
    const auto number = parse_number(text);
    if (!number && !text.empty() && text != "null") return {};
    numbers.push_back(number.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  return numbers;
}

void add_column(File& file, const std::string& name, const std::vector<std::string>& texts) {
  if (const std::vector<double> numbers = as_numbers(texts); numbers.size() == texts.size()) {
    file.add(name, numbers);
    return;
  }
  std::vector<std::string> plain;
  plain.reserve(texts.size());
  for (const std::string& text : texts)
    plain.push_back(text == "null"          ? ""
                    : text.starts_with('"') ? nlohmann::json::parse(text).get<std::string>()
                                            : text);
  file.add(name, plain);
}

}  // namespace

bool has_hdf5() {
  return true;
}

std::string to_hdf5(const Table& table) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are palpa's own
  File file;
  const auto column = [&](const std::string& name, const std::function<std::string(const Row&)>& cell) {
    std::vector<std::string> texts;
    for (const Row& row : table.rows)
      texts.push_back(cell(row));
    add_column(file, name, texts);
  };
  std::vector<std::string> ids;
  for (const Row& row : table.rows)
    ids.push_back(row.id);
  file.add("id", ids);  // some of them look like numbers
  for (std::size_t v = 0; v < table.varied.size(); ++v)
    column(table.varied[v], [v](const Row& row) { return row.settings[v]; });
  for (std::size_t p = 0; p < table.paths.size(); ++p)
    column(table.paths[p], [p](const Row& row) { return row.state == State::done ? row.results[p] : std::string(); });
  column("state", [](const Row& row) { return std::string(word_of(state_words, row.state)); });
  return file.bytes();
}

#else

bool has_hdf5() {
  return false;
}

std::string to_hdf5(const Table&) {
  throw failure("this palpa was built without HDF5");
}

#endif

}  // namespace palpa::sweep
