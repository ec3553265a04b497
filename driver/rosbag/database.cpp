#include "driver/rosbag/database.hpp"

#include <fmt/core.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <map>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "driver/rosbag/messages.hpp"

namespace palpa::driver::rosbag {
namespace {

constexpr std::string_view database_magic("SQLite format 3\0", 16);
constexpr std::size_t database_header_bytes = 100;

// ---- SQLite reads an InputFile --------------------------------------------------------------------------------------

/// What SQLite has of an open file.
struct OpenInput {
  sqlite3_file base;
  const InputFile* in;
};

int read_input(sqlite3_file* file, void* out, int bytes, sqlite3_int64 at) {
  const InputFile& in = *reinterpret_cast<OpenInput*>(file)->in;
  const std::span<unsigned char> all(static_cast<unsigned char*>(out), static_cast<std::size_t>(bytes));
  const auto begin = static_cast<std::uint64_t>(at);
  const std::uint64_t there = begin < in.size() ? std::min<std::uint64_t>(in.size() - begin, all.size()) : 0;
  try {
    if (there > 0) in.read_at(begin, all.first(there));
  } catch (const Error&) {
    return SQLITE_IOERR_READ;
  }
  std::ranges::fill(all.subspan(there), 0);
  return there == all.size() ? SQLITE_OK : SQLITE_IOERR_SHORT_READ;
}

int size_of_input(sqlite3_file* file, sqlite3_int64* bytes) {
  *bytes = static_cast<sqlite3_int64>(reinterpret_cast<OpenInput*>(file)->in->size());
  return SQLITE_OK;
}

/// SQLite takes the file for one that nobody changes: it neither locks it nor looks for a journal.
const sqlite3_io_methods input_methods = [] {
  sqlite3_io_methods methods{};
  methods.iVersion = 1;
  methods.xClose = [](sqlite3_file*) { return SQLITE_OK; };
  methods.xRead = read_input;
  methods.xWrite = [](sqlite3_file*, const void*, int, sqlite3_int64) { return SQLITE_READONLY; };
  methods.xTruncate = [](sqlite3_file*, sqlite3_int64) { return SQLITE_READONLY; };
  methods.xSync = [](sqlite3_file*, int) { return SQLITE_OK; };
  methods.xFileSize = size_of_input;
  methods.xLock = [](sqlite3_file*, int) { return SQLITE_OK; };
  methods.xUnlock = [](sqlite3_file*, int) { return SQLITE_OK; };
  methods.xCheckReservedLock = [](sqlite3_file*, int* reserved) { return *reserved = 0, SQLITE_OK; };
  methods.xFileControl = [](sqlite3_file*, int, void*) { return SQLITE_NOTFOUND; };
  methods.xSectorSize = [](sqlite3_file*) { return 4096; };
  methods.xDeviceCharacteristics = [](sqlite3_file*) { return SQLITE_IOCAP_IMMUTABLE; };
  return methods;
}();

int open_input(sqlite3_vfs* system, sqlite3_filename, sqlite3_file* file, int flags, int* opened) {
  file->pMethods = nullptr;
  if ((flags & SQLITE_OPEN_MAIN_DB) == 0) return SQLITE_CANTOPEN;
  auto* const input = reinterpret_cast<OpenInput*>(file);
  input->base.pMethods = &input_methods;
  input->in = static_cast<const InputFile*>(system->pAppData);
  if (opened) *opened = SQLITE_OPEN_READONLY;
  return SQLITE_OK;
}

/// A file system with one file, for as long as this object lives.
class InputSystem {
 public:
  explicit InputSystem(const InputFile& in) : name_(fmt::format("palpa-{}", static_cast<const void*>(this))) {
    sqlite3_initialize();
    const sqlite3_vfs* const usual = sqlite3_vfs_find(nullptr);  // it knows the time, and how to sleep
    if (!usual) throw failure("SQLite cannot be started");
    system_ = *usual;
    system_.iVersion = 1;
    system_.szOsFile = sizeof(OpenInput);
    system_.pNext = nullptr;
    system_.zName = name_.c_str();
    system_.pAppData = const_cast<InputFile*>(&in);
    system_.xOpen = open_input;
    system_.xDelete = [](sqlite3_vfs*, const char*, int) { return SQLITE_READONLY; };
    system_.xAccess = [](sqlite3_vfs*, const char*, int, int* there) { return *there = 0, SQLITE_OK; };
    system_.xFullPathname = [](sqlite3_vfs*, const char* name, int most, char* out) {
      sqlite3_snprintf(most, out, "%s", name);
      return SQLITE_OK;
    };
    if (sqlite3_vfs_register(&system_, 0) != SQLITE_OK) throw failure("SQLite cannot be started");
  }
  ~InputSystem() { sqlite3_vfs_unregister(&system_); }
  InputSystem(const InputSystem&) = delete;
  InputSystem& operator=(const InputSystem&) = delete;
  const char* name() const { return name_.c_str(); }

 private:
  std::string name_;
  sqlite3_vfs system_{};
};

// ---- the database ---------------------------------------------------------------------------------------------------

struct Close {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, Close>;

std::string text_of(const Statement& row, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(row.get(), column));
  return text ? std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(row.get(), column))) : std::string();
}

std::uint32_t big_endian_at(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (const char byte : bytes.substr(at, count))
    value = value << 8 | static_cast<unsigned char>(byte);
  return value;
}

class Database final : public MessageReader {
 public:
  explicit Database(const std::string& file) : in_(file), system_(in_) {
    refuse_cut_short();
    warn_of_journals();
    open();
    for (const char* table : {"topics", "messages"})
      check_table(table);
    read_topics();
    queue_messages();
  }

  bool next(Message& message) override {
    for (; !queue_.empty(); queue_.pop_back(), row_ = 0) {
      if (step(queue_.back())) {
        take(queue_.back(), message);
        return true;
      }
    }
    return false;
  }
  const char* cut_short() const override { return nullptr; }
  const std::string& file() const override { return in_.name(); }
  void fault(const std::string& what) const override {
    throw bad_input(file(), fmt::format("message {}: {}", row_, what));
  }
  std::vector<std::string> topics() const override { return all_topics_; }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw bad_input(file(), fmt::format("is no recording of ROS 2: {}", what));
  }

  /// SQLite says only that such a file is malformed.
  void refuse_cut_short() const {
    const std::string head = in_.head(database_header_bytes);
    if (head.size() < database_header_bytes)
      throw bad_input(file(), "was cut short within its header; copy the whole file");
    const std::uint64_t page = big_endian_at(head, 16, 2), pages = big_endian_at(head, 28, 4);
    const std::uint64_t bytes = (page == 1 ? 65536 : page) * pages;
    if (bytes > in_.size())
      throw bad_input(file(), fmt::format("was cut short: it has {} of its {} bytes; copy the whole file, or record it "
                                          "again",
                                          in_.size(), bytes));
  }

  void warn_of_journals() const {
    for (const char* kind : {"-wal", "-journal"}) {
      std::error_code error;
      const std::string journal = file() + kind;
      const std::uintmax_t bytes = std::filesystem::file_size(journal, error);
      if (error || bytes == 0) continue;
      log::warning(
          fmt::format("{}: its recorder ended too soon: palpa does not read what is in {}; sqlite3 {} VACUUM "
                      "puts it into the file",
                      file(), journal, file()));
    }
  }

  void open() {
    sqlite3* opened = nullptr;
    const int result = sqlite3_open_v2("recording", &opened, SQLITE_OPEN_READONLY, system_.name());
    database_.reset(opened);
    if (result != SQLITE_OK) throw failure(fmt::format("{}: SQLite cannot open it", file()));
    for (const auto& [option, value] : {std::pair(SQLITE_DBCONFIG_DEFENSIVE, 1),
                                        {SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
                                        {SQLITE_DBCONFIG_ENABLE_VIEW, 0},
                                        {SQLITE_DBCONFIG_ENABLE_TRIGGER, 0}})
      sqlite3_db_config(opened, option, value, nullptr);
    sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, static_cast<int>(most_message_bytes));
    // A row takes about ten operations and more than ten bytes. Pages that many others refer to take more.
    most_ticks_ = (1'000'000 + in_.size()) / operations_per_tick;
    sqlite3_progress_handler(
        opened, operations_per_tick,
        [](void* self) {
          auto& database = *static_cast<Database*>(self);
          return ++database.ticks_ > database.most_ticks_ ? 1 : 0;
        },
        this);
  }

  Statement prepare(const std::string& sql) {
    sqlite3_stmt* made = nullptr;
    ticks_ = 0;
    if (sqlite3_prepare_v2(database_.get(), sql.c_str(), -1, &made, nullptr) != SQLITE_OK)
      refuse(one_line(sqlite3_errmsg(database_.get()), 200));
    return Statement(made);
  }

  /// Whether there is another row.
  bool step(const Statement& statement) const {
    switch (const int result = sqlite3_step(statement.get())) {
      case SQLITE_ROW:
        return true;
      case SQLITE_DONE:
        return false;
      case SQLITE_TOOBIG:
        throw bad_input(file(),
                        fmt::format("a message after message {} has more than {} bytes", row_, most_message_bytes));
      case SQLITE_INTERRUPT:
        throw bad_input(file(), "is a broken database: its pages refer to the same ones over and over");
      default:
        throw bad_input(file(), fmt::format("is a broken database: {}",
                                            result == SQLITE_NOMEM ? "it claims more memory than there is"
                                                                   : one_line(sqlite3_errmsg(database_.get()), 200)));
    }
  }

  /// A table may be one in name only: its rows may be those of a program, or be computed.
  void check_table(const std::string& table) {
    const Statement definition =
        prepare(fmt::format("SELECT sql FROM sqlite_master WHERE name = '{}' COLLATE NOCASE", table));
    while (step(definition)) {
      if (!text_of(definition, 0).starts_with("CREATE TABLE")) refuse(fmt::format("{} is not a plain table", table));
    }
    const Statement columns = prepare(fmt::format("PRAGMA table_xinfo({})", table));
    while (step(columns)) {
      constexpr int hidden = 6;
      if (sqlite3_column_int(columns.get(), hidden) != 0) refuse(fmt::format("{} has a computed column", table));
    }
  }

  void read_topics() {
    const Statement topics = prepare("SELECT id, name, type FROM topics NOT INDEXED");
    while (step(topics)) {
      const std::string name = text_of(topics, 1);
      if (name.size() > most_topic_bytes) refuse(fmt::format("a topic has a name of {} bytes", name.size()));
      if (all_topics_.size() == most_topics) refuse(fmt::format("there are more than {} topics", most_topics));
      all_topics_.push_back(name);
      const std::string type = text_of(topics, 2);
      if (says_of(name, type) == Says::nothing) continue;
      const sqlite3_int64 id = sqlite3_column_int64(topics.get(), 0);
      wanted_[id] = name;
      if (type == camera_info_type) infos_.push_back(id);
    }
  }

  /// Rows come in the order of their numbers, which is that of recording. Each CameraInfo would come after the image
  /// that it describes, and they are all alike, so the first comes before everything else.
  void queue_messages() {
    const std::string rows = "SELECT rowid, topic_id, timestamp, data FROM messages NOT INDEXED WHERE topic_id ";
    std::string others;
    for (const auto& [id, name] : wanted_) {
      if (std::ranges::find(infos_, id) == infos_.end()) others += fmt::format("{}{}", others.empty() ? "" : ", ", id);
    }
    queue_.push_back(prepare(fmt::format("{}IN ({})", rows, others)));
    for (const sqlite3_int64 id : infos_)
      queue_.push_back(prepare(fmt::format("{}= {} LIMIT 1", rows, id)));
  }

  void take(const Statement& row, Message& message) {
    const sqlite3_int64 number = sqlite3_column_int64(row.get(), 0);
    if (row_ != 0 && number <= row_) throw bad_input(file(), "is a broken database: its messages are not in order");
    row_ = number;
    if (sqlite3_column_type(row.get(), 2) != SQLITE_INTEGER) fault("its time is no whole number of nanoseconds");
    if (sqlite3_column_type(row.get(), 3) != SQLITE_BLOB) fault("it has no data");
    const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(row.get(), 3));
    message.topic = &wanted_.at(sqlite3_column_int64(row.get(), 1));
    message.time_s = static_cast<double>(sqlite3_column_int64(row.get(), 2)) * 1e-9;
    message.data = {data, static_cast<std::size_t>(data ? sqlite3_column_bytes(row.get(), 3) : 0)};
    message.encoding = Encoding::cdr;
  }

  static constexpr int operations_per_tick = 10'000;

  InputFile in_;
  InputSystem system_;
  std::unique_ptr<sqlite3, Close> database_;
  std::uint64_t ticks_ = 0, most_ticks_ = 0;
  std::vector<std::string> all_topics_;
  std::map<sqlite3_int64, std::string> wanted_;  ///< by number
  std::vector<sqlite3_int64> infos_;             ///< those of them that are CameraInfo
  std::vector<Statement> queue_;                 ///< the last comes first
  sqlite3_int64 row_ = 0;                        ///< the message that was read last
};

}  // namespace

bool is_database(const std::string& head) {
  return head.starts_with(database_magic);
}

std::unique_ptr<MessageReader> open_database(const std::string& file) {
  return std::make_unique<Database>(file);
}

}  // namespace palpa::driver::rosbag
