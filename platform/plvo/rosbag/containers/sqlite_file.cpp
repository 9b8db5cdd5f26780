// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/containers/sqlite_file.hpp"

#include <fmt/core.h>
#include <sqlite3.h>

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "plvo/rosbag/messages/messages.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

// A row of a plain table takes a few dozen steps.
constexpr int kStepsPerCheck = 1000, kMostChecks = 10'000;

struct FinishStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, FinishStatement>;

Statement prepare(sqlite3* database, const char* text) {
  sqlite3_stmt* made = nullptr;
  sqlite3_prepare_v2(database, text, -1, &made, nullptr);
  return Statement(made);
}

std::string_view text_of(sqlite3_stmt* statement, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return text == nullptr
             ? std::string_view()
             : std::string_view(text, static_cast<std::size_t>(sqlite3_column_bytes(statement, column)));
}

// The name as a URI, in which some letters have a meaning.
std::string uri_of(const fs::path& path) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/._-";
  std::string uri = "file:";
  for (const char letter : fs::absolute(path).string())
    uri += kPlain.find(letter) != std::string_view::npos
               ? std::string(1, letter)
               : fmt::format("%{:02X}", static_cast<unsigned>(static_cast<unsigned char>(letter)));
  return uri + "?mode=ro&immutable=1";
}

int check_steps(void* steps_left) { return --*static_cast<int*>(steps_left) < 0 ? 1 : 0; }

}  // namespace

void SqliteFile::CloseDatabase::operator()(sqlite3* database) const { sqlite3_close_v2(database); }
void SqliteFile::CloseBlob::operator()(sqlite3_blob* blob) const { sqlite3_blob_close(blob); }

Status SqliteFile::damaged(const char* what) const {
  return {StatusCode::kDamaged, fmt::format("{} {}", path_.string(), what)};
}

Status SqliteFile::open_file(const fs::path& path) {
  path_ = path;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return {StatusCode::kNotFound, fmt::format("{} is not there", path.string())};
  if (!fs::is_regular_file(status))
    return {StatusCode::kInvalidArgument, fmt::format("{} is not a regular file", path.string())};
  sqlite3* made = nullptr;
  const int opened = sqlite3_open_v2(
      uri_of(path).c_str(), &made,
      SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_PRIVATECACHE, nullptr);
  database_.reset(made);
  if (opened != SQLITE_OK) return {StatusCode::kPermission, fmt::format("{} cannot be read", path.string())};
  steps_left_ = kMostChecks;
  sqlite3_progress_handler(made, kStepsPerCheck, check_steps, &steps_left_);
  if (Status restricted = restrict_database(); !restricted.ok()) return restricted;
  if (!has_tables()) return damaged("is not a database of rosbag2: it has no tables 'topics' and 'messages'");
  return read_topics();
}

Status SqliteFile::restrict_database() {
  sqlite3* database = database_.get();
  bool good = true;
  for (const auto& [setting, value] : {std::pair<int, int>{SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
                                       {SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION, 0},
                                       {SQLITE_DBCONFIG_ENABLE_TRIGGER, 0},
                                       {SQLITE_DBCONFIG_ENABLE_VIEW, 0},
                                       // Reads a file that is shorter than it says. Nothing can be written,
                                       // because the file is open for reading only.
                                       {SQLITE_DBCONFIG_DEFENSIVE, 0},
                                       {SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1}})
    good = good && sqlite3_db_config(database, setting, value, nullptr) == SQLITE_OK;
  for (const auto& [limit, value] :
       {std::pair<int, int>{SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxPiece) + 4096},
        {SQLITE_LIMIT_SQL_LENGTH, 65'536},
        {SQLITE_LIMIT_COLUMN, 100},
        {SQLITE_LIMIT_EXPR_DEPTH, 50},
        {SQLITE_LIMIT_COMPOUND_SELECT, 10},
        {SQLITE_LIMIT_VDBE_OP, 25'000},
        {SQLITE_LIMIT_FUNCTION_ARG, 8},
        {SQLITE_LIMIT_ATTACHED, 0},
        {SQLITE_LIMIT_TRIGGER_DEPTH, 1},
        {SQLITE_LIMIT_WORKER_THREADS, 0}})
    sqlite3_limit(database, limit, value);
  // The first reads a page, which tells whether this is SQLite at all.
  for (const char* setting : {"PRAGMA cell_size_check=ON", "PRAGMA cache_size=-2000", "PRAGMA mmap_size=0"})
    good = good && sqlite3_exec(database, setting, nullptr, nullptr, nullptr) == SQLITE_OK;
  return good ? Status() : damaged("is not a database of SQLite that can be read");
}

bool SqliteFile::has_tables() {
  const Statement statement =
      prepare(database_.get(),
              "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND rootpage > 0 "
              "AND name IN ('topics', 'messages')");
  return statement != nullptr && sqlite3_step(statement.get()) == SQLITE_ROW &&
         sqlite3_column_int(statement.get(), 0) == 2;
}

Status SqliteFile::read_topics() {
  const Statement statement =
      prepare(database_.get(), "SELECT id, name, type, serialization_format FROM topics ORDER BY id");
  if (statement == nullptr) return damaged("has a table of topics that is not rosbag2's");
  while (sqlite3_step(statement.get()) == SQLITE_ROW) {
    const std::string_view format = text_of(statement.get(), 3);
    if (format != "cdr" && format != "ros1") continue;
    const std::size_t topic = topic_number(text_of(statement.get(), 1), text_of(statement.get(), 2),
                                           format == "cdr" ? WireFormat::kCdr : WireFormat::kRos1);
    if (topic != kNoTopic) topics_by_number_.emplace(sqlite3_column_int64(statement.get(), 0), topic);
  }
  return {};
}

int SqliteFile::open_data(std::int64_t row) {
  steps_left_ = kMostChecks;
  if (data_ == nullptr || sqlite3_blob_reopen(data_.get(), row) != SQLITE_OK) {
    data_.reset();
    sqlite3_blob* opened = nullptr;
    if (sqlite3_blob_open(database_.get(), "main", "messages", "data", row, 0, &opened) != SQLITE_OK) {
      sqlite3_blob_close(opened);
      return -1;
    }
    data_.reset(opened);
  }
  return sqlite3_blob_bytes(data_.get());
}

Status SqliteFile::scan(const Take& take) {
  std::size_t damaged_rows = 0;
  std::string remark;
  // In the order of recording. The data themselves are not read here.
  const Statement statement =
      prepare(database_.get(), "SELECT rowid, topic_id, timestamp FROM messages ORDER BY rowid");
  if (statement == nullptr) return damaged("has a table of messages that is not rosbag2's");
  steps_left_ = kMostChecks;
  int step = SQLITE_ROW;
  std::optional<std::int64_t> last_row;
  while ((step = sqlite3_step(statement.get())) == SQLITE_ROW) {
    const std::int64_t row = sqlite3_column_int64(statement.get(), 0);
    // In a damaged file the pages may form a circle, which has rows without end.
    if (last_row && row <= *last_row) break;
    last_row = row;
    steps_left_ = kMostChecks;
    const auto topic = topics_by_number_.find(sqlite3_column_int64(statement.get(), 1));
    if (topic == topics_by_number_.end()) continue;
    const int bytes = open_data(row);
    if (bytes < 0) {
      ++damaged_rows;
      continue;
    }
    Found found;
    found.topic = topic->second;
    found.received_ns = sqlite3_column_int64(statement.get(), 2);
    found.place.position = static_cast<std::uint64_t>(row);
    found.place.bytes = static_cast<std::uint32_t>(bytes);
    found.read = [this](std::span<unsigned char> out) {
      steps_left_ = kMostChecks;
      return sqlite3_blob_read(data_.get(), out.data(), static_cast<int>(out.size()), 0) == SQLITE_OK;
    };
    if (Status status = take(found); !status.ok()) return status;
  }
  const std::string name = path_.filename().string();
  if (step != SQLITE_DONE)
    remark = fmt::format("{} is damaged or cut short; the messages before that are used", name);
  else if (damaged_rows > 0)
    remark = fmt::format("{} damaged messages of {} are left out", damaged_rows, name);
  std::error_code error;
  const fs::path log = path_.string() + "-wal";
  if (const std::uintmax_t bytes = fs::file_size(log, error); !error && bytes > 0)
    remark += fmt::format(
        "{}{} has messages that are not in the database yet: sqlite3 {} 'PRAGMA "
        "wal_checkpoint' puts them in",
        remark.empty() ? "" : "; ", log.filename().string(), name);
  set_remark(std::move(remark));
  return {};
}

Status SqliteFile::read_stored(const BagMessage& place, std::span<unsigned char> bytes) {
  const int there = open_data(static_cast<std::int64_t>(place.position));
  if (there < 0 || static_cast<std::size_t>(there) != bytes.size() ||
      sqlite3_blob_read(data_.get(), bytes.data(), there, 0) != SQLITE_OK)
    return damaged("has a damaged message");
  return {};
}

void SqliteFile::release() { sqlite3_db_release_memory(database_.get()); }

}  // namespace plvo
