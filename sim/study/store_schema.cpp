// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/store_schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/interval.h"
#include "sim/experiment.h"
#include "sim/study/store_database.h"
#include "sim/study/store_rows.h"
#include "sim/study/study_store.h"

namespace vernier::sim::internal {

namespace {

constexpr int application_id = 0x56726e72;  // "Vrnr"
constexpr int newest_version = 2;

// The tables of the versions have other names, so that damage cannot make one version of another.
// The rows lie in their table, without an index beside it that might disagree.
constexpr const char* block_table =
    "CREATE TABLE trial_block (cell TEXT, block INTEGER, trials INTEGER, answered INTEGER,"
    " successes INTEGER, results TEXT, checksum TEXT, PRIMARY KEY (cell, block)) WITHOUT ROWID";
constexpr const char* note_table =
    "CREATE TABLE remark (key TEXT PRIMARY KEY, value TEXT, checksum TEXT) WITHOUT ROWID";
constexpr const char* old_block_table =
    "CREATE TABLE block (cell TEXT, block INTEGER, trials INTEGER, answered INTEGER,"
    " successes INTEGER, results TEXT, PRIMARY KEY (cell, block))";
constexpr const char* old_note_table = "CREATE TABLE note (key TEXT PRIMARY KEY, value TEXT)";

std::string block_checksum(const BlockRow& row) {
  const auto& [cell, block, counted, results] = row;
  return row_checksum({cell, std::to_string(block), std::to_string(counted[0]),
                       std::to_string(counted[1]), std::to_string(counted[2]), results});
}

/// One row of either version with its checksum verified.
BlockRow checked_row(const Database& database, const Statement& row, bool with_checksum) {
  BlockRow read{row.text(0), row.whole(1), {row.whole(2), row.whole(3), row.whole(4)}, row.text(5)};
  if (with_checksum && row.text(6) != block_checksum(read)) {
    database.fail_damaged(fmt::format("block {} has another checksum", read.block));
  }
  if (read.block < 0) database.fail_damaged("a block has a negative number");
  if (read.counted[0] < 1) database.fail_damaged(fmt::format("block {} has no trials", read.block));
  return read;
}

StoredBlock block_of(const Database& database, const BlockRow& row) {
  try {
    StoredBlock read{row.cell, row.block,
                     parse_trials(row.results, fmt::format("block {}", row.block))};
    if (row_counts(read.trials) != row.counted) {
      database.fail_damaged(fmt::format("block {} has other trials than it counts", row.block));
    }
    return read;
  } catch (const Error& error) {
    if (error.place() == database.place()) throw;
    database.fail_damaged(error.place() + " " + error.fault());
  }
}

/// Statement over the rows of either version.
std::string rows_of(int version, const std::string& condition) {
  return (version == 1 ? "SELECT cell, block, trials, answered, successes, results"
                         " FROM block NOT INDEXED"
                       : "SELECT cell, block, trials, answered, successes, results,"
                         " checksum FROM trial_block") +
         condition;
}

void check_pages(const Database& database) {
  Statement verdict(database, "PRAGMA quick_check(1)");
  if (!verdict.step() || verdict.text(0) != "ok") {
    database.fail_damaged("its pages do not fit together");
  }
}

void read_blocks(const Database& database, int version, StoreContent& content) {
  Statement rows(database, rows_of(version, ""));
  while (rows.step()) {
    content.blocks.push_back(block_of(database, checked_row(database, rows, version > 1)));
  }
  const auto key = [](const StoredBlock& b) { return std::tie(b.cell, b.block); };
  std::sort(content.blocks.begin(), content.blocks.end(),
            [&](const StoredBlock& a, const StoredBlock& b) { return key(a) < key(b); });
  const auto same = [&](const StoredBlock& a, const StoredBlock& b) { return key(a) == key(b); };
  if (std::adjacent_find(content.blocks.begin(), content.blocks.end(), same) !=
      content.blocks.end()) {
    database.fail_damaged("it has a block twice");
  }
}

void read_notes(const Database& database, int version, StoreNotes& notes) {
  Statement rows(database, version == 1 ? "SELECT key, value FROM note NOT INDEXED"
                                        : "SELECT key, value, checksum FROM remark");
  while (rows.step()) {
    const std::string key = rows.text(0), value = rows.text(1);
    if (version > 1 && rows.text(2) != row_checksum({key, value})) {
      database.fail_damaged("a note has another checksum");
    }
    if (!notes.emplace(key, value).second) database.fail_damaged("it has a note twice");
  }
  if (version == 1) notes.erase("schema");
}

}  // namespace

int store_version(const Database& database) {
  std::set<std::string> tables;
  Statement rows(database, "SELECT sql FROM sqlite_schema WHERE sql IS NOT NULL");
  while (rows.step()) tables.insert(rows.text(0));
  const int version = database.number("PRAGMA user_version");
  const int application = database.number("PRAGMA application_id");
  if (tables.empty() && version == 0 && application == 0) {
    if (database.number("PRAGMA page_count") > 1) database.fail_damaged("its tables are missing");
    return 0;
  }
  if (application == application_id && version > newest_version) {
    throw Error(database.place(),
                fmt::format("study store version {} is not supported; supported: 1 and 2", version),
                "use another folder, or the program that wrote it");
  }
  if (application == 0 && version == 0 &&
      tables == std::set<std::string>{old_block_table, old_note_table}) {
    return 1;
  }
  if (application == application_id && version == newest_version &&
      tables == std::set<std::string>{block_table, note_table}) {
    return 2;
  }
  throw Error(database.place(), "is not a study store, or its tables are damaged",
              "choose another folder, or delete the file: its blocks are then computed again");
}

void make_store(const Database& database) {
  Transaction whole(database);
  const int version = store_version(database);  // another process may have made it
  if (version == newest_version) return;
  const StoreContent old = stored_content(database);
  if (version == 1) database.run("DROP TABLE block; DROP TABLE note");
  database.run(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}; {}; {}",
                           application_id, newest_version, block_table, note_table));
  for (const StoredBlock& block : old.blocks) store_block(database, block);
  for (const auto& [key, value] : old.notes) store_note(database, key, value);
  whole.commit();
}

StoreContent stored_content(const Database& database) {
  const int version = store_version(database);
  StoreContent content;
  if (version == 0) return content;
  check_pages(database);
  read_blocks(database, version, content);
  read_notes(database, version, content.notes);
  return content;
}

StoreIndex stored_index(const Database& database) {
  const int version = store_version(database);
  StoreIndex index;
  if (version == 0) return index;
  check_pages(database);
  Statement rows(database, rows_of(version, ""));
  while (rows.step()) {
    BlockRow row = checked_row(database, rows, version > 1);
    const ClusterCount count{.successes = row.counted[2], .trials = row.counted[0]};
    if (!index.blocks[std::move(row.cell)].emplace(row.block, count).second) {
      database.fail_damaged("it has a block twice");
    }
  }
  read_notes(database, version, index.notes);
  return index;
}

std::vector<StoredBlock> stored_blocks(const Database& database, const BlockRange& range) {
  const int version = store_version(database);
  std::vector<StoredBlock> blocks;
  if (version == 0) return blocks;
  Statement rows(database,
                 rows_of(version, " WHERE cell = ? AND block >= ? AND block < ? ORDER BY block"));
  rows.bind(1, range.cell).bind(2, range.first).bind(3, range.end);
  while (rows.step()) {
    blocks.push_back(block_of(database, checked_row(database, rows, version > 1)));
  }
  return blocks;
}

void visit_rows(const Database& database, const std::function<void(const BlockRow&)>& visit) {
  const int version = store_version(database);
  if (version == 0) return;
  Statement rows(database, rows_of(version, ""));
  while (rows.step()) {
    const BlockRow row = checked_row(database, rows, version > 1);
    block_of(database, row);
    visit(row);
  }
}

void store_row(const Database& database, const BlockRow& row) {
  Statement(database, "INSERT OR REPLACE INTO trial_block VALUES (?, ?, ?, ?, ?, ?, ?)")
      .bind(1, row.cell)
      .bind(2, row.block)
      .bind(3, row.counted[0])
      .bind(4, row.counted[1])
      .bind(5, row.counted[2])
      .bind(6, row.results)
      .bind(7, block_checksum(row))
      .step();
}

void store_block(const Database& database, const StoredBlock& block) {
  store_row(database, block_row(block.cell, block.block, block.trials));
}

void store_note(const Database& database, const std::string& key, const std::string& value) {
  Statement(database, "INSERT OR REPLACE INTO remark VALUES (?, ?, ?)")
      .bind(1, key)
      .bind(2, value)
      .bind(3, row_checksum({key, value}))
      .step();
}

}  // namespace vernier::sim::internal
