// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/store_schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "calib/error.h"
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

/// Number of trials, of those with an answer and of successes, as in the columns for users of SQL.
std::array<int, 3> counts(const std::vector<TrialResult>& trials) {
  std::array<int, 3> counted{static_cast<int>(trials.size()), 0, 0};
  for (const TrialResult& trial : trials) {
    counted[1] += trial.answered();
    counted[2] += trial.success();
  }
  return counted;
}

std::string block_checksum(const std::string& cell,
                           int block,
                           const std::array<int, 3>& counted,
                           const std::string& results) {
  return row_checksum({cell, std::to_string(block), std::to_string(counted[0]),
                       std::to_string(counted[1]), std::to_string(counted[2]), results});
}

/// One row of either version, checked.
StoredBlock block_of(const Database& database, const Statement& row, bool with_checksum) {
  const std::string cell = row.text(0), results = row.text(5);
  const int block = row.whole(1);
  const std::array<int, 3> counted{row.whole(2), row.whole(3), row.whole(4)};
  if (with_checksum && row.text(6) != block_checksum(cell, block, counted, results)) {
    database.fail_damaged(fmt::format("block {} has another checksum", block));
  }
  if (block < 0) database.fail_damaged("a block has a negative number");
  try {
    StoredBlock read{cell, block, parse_trials(results, fmt::format("block {}", block))};
    if (counts(read.trials) != counted) {
      database.fail_damaged(fmt::format("block {} has other trials than it counts", block));
    }
    return read;
  } catch (const Error& error) {
    if (error.place() == database.place()) throw;
    database.fail_damaged(error.place() + " " + error.fault());
  }
}

void read_blocks(const Database& database, int version, StoreContent& content) {
  Statement rows(database, version == 1
                               ? "SELECT cell, block, trials, answered, successes, results"
                                 " FROM block NOT INDEXED"
                               : "SELECT cell, block, trials, answered, successes, results,"
                                 " checksum FROM trial_block");
  while (rows.step()) content.blocks.push_back(block_of(database, rows, version > 1));
  const auto key = [](const StoredBlock& b) { return std::tie(b.cell, b.block); };
  std::sort(content.blocks.begin(), content.blocks.end(),
            [&](const StoredBlock& a, const StoredBlock& b) { return key(a) < key(b); });
  const auto same = [&](const StoredBlock& a, const StoredBlock& b) { return key(a) == key(b); };
  if (std::adjacent_find(content.blocks.begin(), content.blocks.end(), same) !=
      content.blocks.end()) {
    database.fail_damaged("it has a block twice");
  }
}

void read_notes(const Database& database, int version, StoreContent& content) {
  Statement rows(database, version == 1 ? "SELECT key, value FROM note NOT INDEXED"
                                        : "SELECT key, value, checksum FROM remark");
  while (rows.step()) {
    const std::string key = rows.text(0), value = rows.text(1);
    if (version > 1 && rows.text(2) != row_checksum({key, value})) {
      database.fail_damaged("a note has another checksum");
    }
    if (!content.notes.emplace(key, value).second) database.fail_damaged("it has a note twice");
  }
  if (version == 1) content.notes.erase("schema");
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

void check_store(const Database& database) {
  if (store_version(database) == 0) return;
  Statement verdict(database, "PRAGMA quick_check(1)");
  if (!verdict.step() || verdict.text(0) != "ok")
    database.fail_damaged("its pages do not fit together");
}

int stored_trials(const Database& database, const std::string& cell, int block) {
  const int version = database.number("PRAGMA user_version");
  Statement row(database, version == newest_version
                              ? "SELECT trials FROM trial_block WHERE cell = ? AND block = ?"
                              : "SELECT trials FROM block WHERE cell = ? AND block = ?");
  row.bind(1, cell).bind(2, block);
  return row.step() ? row.whole(0) : 0;
}

StoredBlock stored_block(const Database& database, const std::string& cell, int block) {
  const bool with_checksum = database.number("PRAGMA user_version") == newest_version;
  Statement row(database, with_checksum
                              ? "SELECT cell, block, trials, answered, successes, results,"
                                " checksum FROM trial_block WHERE cell = ? AND block = ?"
                              : "SELECT cell, block, trials, answered, successes, results"
                                " FROM block WHERE cell = ? AND block = ?");
  row.bind(1, cell).bind(2, block);
  return row.step() ? block_of(database, row, with_checksum) : StoredBlock{cell, block, {}};
}

StoreContent stored_content(const Database& database) {
  const int version = store_version(database);
  StoreContent content;
  if (version == 0) return content;
  check_store(database);
  read_blocks(database, version, content);
  read_notes(database, version, content);
  return content;
}

void store_block(const Database& database, const StoredBlock& block) {
  const std::array<int, 3> counted = counts(block.trials);
  const std::string results = trials_text(block.trials);
  Statement(database, "INSERT OR REPLACE INTO trial_block VALUES (?, ?, ?, ?, ?, ?, ?)")
      .bind(1, block.cell)
      .bind(2, block.block)
      .bind(3, counted[0])
      .bind(4, counted[1])
      .bind(5, counted[2])
      .bind(6, results)
      .bind(7, block_checksum(block.cell, block.block, counted, results))
      .step();
}

void store_note(const Database& database, const std::string& key, const std::string& value) {
  Statement(database, "INSERT OR REPLACE INTO remark VALUES (?, ?, ?)")
      .bind(1, key)
      .bind(2, value)
      .bind(3, row_checksum({key, value}))
      .step();
}

}  // namespace vernier::sim::internal
