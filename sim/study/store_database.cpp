// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/store_database.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <cstddef>
#include <filesystem>
#include <limits>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/error.h"

namespace vernier::sim::internal {

namespace {

constexpr int patience_ms = 10'000;    ///< for the short locks of other processes
constexpr int longest_row = 64 << 20;  ///< bytes; a block of 50 trials takes about 15 kB
constexpr const char* again =
    "free some space and run the same command again: it goes on from the "
    "blocks that are stored";

/// As SQLite's URI names want a path: % and what ends it are escaped.
std::string uri_of(const std::filesystem::path& file, const std::string& options) {
  std::string uri = "file:";
  if (file.is_relative()) uri += "./";
  for (const char c : file.string()) {
    if (c == '%' || c == '?' || c == '#') {
      uri += fmt::format("%{:02X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      uri += c;
    }
  }
  return uri + "?" + options;
}

/// Of this process: the system's files, none of which is ever made. SQLite makes an empty log
/// beside a store it opens for reading, if the writer has just removed its own.
const char* files_that_exist() {
  static sqlite3_vfs* const system = sqlite3_vfs_find(nullptr);
  static sqlite3_vfs existing = *system;
  static const int registered = [] {
    existing.pNext = nullptr;
    existing.zName = "vernier-existing";
    existing.xOpen = [](sqlite3_vfs*, sqlite3_filename name, sqlite3_file* file, int flags,
                        int* given) {
      return system->xOpen(system, name, file, flags & ~SQLITE_OPEN_CREATE, given);
    };
    return sqlite3_vfs_register(&existing, 0);
  }();
  return registered == SQLITE_OK ? existing.zName : nullptr;
}

struct Advice {
  const char *fault, *remedy;
};

/// What a result code means to the user; its words are SQLite's own if there is none here.
Advice advice(int code) {
  constexpr Advice no_memory{"out of memory", "run it where there is more"};
  if (code == SQLITE_IOERR_NOMEM || code == SQLITE_IOERR_SHMMAP || code == SQLITE_IOERR_MMAP) {
    return no_memory;
  }
  switch (code & 0xff) {
    case SQLITE_FULL:
      return {"cannot be written: no space is left on the disk", again};
    case SQLITE_NOTADB:
      return {"is not a study store, or its start is damaged",
              "choose another folder, or delete the file: its blocks are then computed again"};
    case SQLITE_READONLY:
      return {"cannot be written", "check the permissions of the file and its folder"};
    case SQLITE_PERM:
    case SQLITE_CANTOPEN:
      return {"cannot be opened", "check the permissions of the file and its folder"};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {"is locked by another process", "run the same command again"};
    case SQLITE_IOERR:
      return {"cannot be read or written",
              "check that the disk has space and works, then run the "
              "same command again"};
    case SQLITE_NOMEM:
      return no_memory;
    default:
      return {nullptr, "delete it and run the study again: its blocks are then computed again"};
  }
}

}  // namespace

Database Database::to_write(const std::filesystem::path& file) {
  return {file, uri_of(file, "mode=rwc"), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr};
}

Database Database::to_read(const std::filesystem::path& file, const std::string& options) {
  return {file, uri_of(file, "mode=ro" + (options.empty() ? "" : "&" + options)),
          SQLITE_OPEN_READONLY, files_that_exist()};
}

Database::Database(std::filesystem::path file, const std::string& uri, int flags, const char* vfs)
    : file_(std::move(file)) {
  // Not SQLITE_OPEN_NOFOLLOW: a folder of results may be a link.
  if (sqlite3_open_v2(uri.c_str(), &db_, flags | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, vfs) !=
      SQLITE_OK) {
    const Database closed(std::move(*this));  // the destructor of this does not run
    closed.fail();
  }
  // The file may be anybody's: no view, trigger or function of its own is run.
  sqlite3_db_config(db_, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_db_config(db_, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(db_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(db_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_limit(db_, SQLITE_LIMIT_LENGTH, longest_row);
  sqlite3_busy_timeout(db_, patience_ms);
}

Database::Database(Database&& other) noexcept
    : file_(std::move(other.file_)), db_(std::exchange(other.db_, nullptr)) {}

void Database::fail() const {
  const auto [fault, remedy] = advice(code());
  const std::string own = vernier::internal::printable(sqlite3_errmsg(db_), 100);
  throw Error(place(), fault ? fault : "is damaged (" + own + ")", remedy);
}

void Database::fail_damaged(const std::string& how) const {
  throw Error(place(), "is damaged: " + vernier::internal::printable(how, 200),
              advice(SQLITE_CORRUPT).remedy);
}

void Database::run(const std::string& sql) const {
  if (sqlite3_exec(db_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

int Database::number(const std::string& sql) const {
  Statement row(*this, sql);
  return row.step() ? row.whole(0) : 0;
}

Statement::Statement(const Database& database, const std::string& sql) : database_(database) {
  if (sqlite3_prepare_v2(database.db_, sql.c_str(), -1, &statement_, nullptr) != SQLITE_OK) {
    database.fail();
  }
}

Statement& Statement::bind(int index, const std::string& value) {
  if (sqlite3_bind_text64(statement_, index, value.data(), value.size(), SQLITE_TRANSIENT,
                          SQLITE_UTF8) != SQLITE_OK) {
    database_.fail();
  }
  return *this;
}

Statement& Statement::bind(int index, int value) {
  if (sqlite3_bind_int(statement_, index, value) != SQLITE_OK) database_.fail();
  return *this;
}

bool Statement::step() {
  const int status = sqlite3_step(statement_);
  if (status != SQLITE_ROW && status != SQLITE_DONE) database_.fail();
  return status == SQLITE_ROW;
}

std::string Statement::text(int column) const {
  if (sqlite3_column_type(statement_, column) != SQLITE_TEXT) {
    database_.fail_damaged("a field is no text");
  }
  const auto* bytes = sqlite3_column_text(statement_, column);
  if (!bytes) database_.fail();
  const int size = sqlite3_column_bytes(statement_, column);
  return {reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(size)};
}

int Statement::whole(int column) const {
  const sqlite3_int64 value = sqlite3_column_int64(statement_, column);
  if (sqlite3_column_type(statement_, column) != SQLITE_INTEGER ||
      value < std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max()) {
    database_.fail_damaged("a field is no whole number in its range");
  }
  return static_cast<int>(value);
}

Transaction::Transaction(const Database& database) : database_(database) {
  database_.run("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  if (!open_) return;
  try {
    database_.run("ROLLBACK");
  } catch (...) {  // SQLite has undone it by itself, as on a full disk
  }
}

void Transaction::commit() {
  database_.run("COMMIT");
  open_ = false;
}

}  // namespace vernier::sim::internal
