// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sqlite3.h>

#include <filesystem>
#include <string>

namespace vernier::sim::internal {

/// An open SQLite file. What SQLite refuses is thrown as Error with the file as place.
class Database {
 public:
  /// Opens or creates a file for writing.
  static Database to_write(const std::filesystem::path& file);
  /// Opens a file for reading, with options of SQLite's URI names, such as "immutable=1". Makes no
  /// file.
  static Database to_read(const std::filesystem::path& file, const std::string& options);
  ~Database() { sqlite3_close(db_); }
  Database(Database&& other) noexcept;
  Database& operator=(Database&&) = delete;

  void run(const std::string& sql) const;
  /// Value of a pragma or another query with one number.
  int number(const std::string& sql) const;
  /// The result code of the last call.
  int code() const { return sqlite3_extended_errcode(db_); }
  /// Throws Error for the last call.
  [[noreturn]] void fail() const;
  /// Throws Error: the file is damaged.
  [[noreturn]] void fail_damaged(const std::string& how) const;
  std::string place() const { return file_.string(); }

 private:
  Database(std::filesystem::path file, const std::string& uri, int flags, const char* vfs);
  friend class Statement;

  std::filesystem::path file_;
  sqlite3* db_ = nullptr;
};

/// A statement of SQL with its parameters and rows.
class Statement {
 public:
  Statement(const Database& database, const std::string& sql);
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  /// Parameters and columns count from 1 and from 0, as in SQLite.
  Statement& bind(int index, const std::string& value);
  Statement& bind(int index, int value);
  /// Whether there is another row.
  bool step();
  /// Throws Error if the column holds another type.
  std::string text(int column) const;
  int whole(int column) const;

 private:
  const Database& database_;
  sqlite3_stmt* statement_ = nullptr;
};

/// Statements are one transaction while this exists, undone without commit().
class Transaction {
 public:
  explicit Transaction(const Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  const Database& database_;
  bool open_ = true;
};

}  // namespace vernier::sim::internal
