// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study_store.h"

#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "calib/base/instruction_set.h"
#include "calib/error.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "sim/experiment.h"

namespace vernier::sim::internal {

using namespace localise;
using namespace vernier::internal;

namespace {

using Json = nlohmann::json;

constexpr const char* schema_version = "1";

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
double number(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

Json pose_json(const Pose2D& pose) { return {pose.x_m, pose.y_m, pose.heading_rad}; }
Pose2D pose_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

std::string trials_text(const std::vector<TrialResult>& trials) {
  Json rows = Json::array();
  for (const TrialResult& t : trials) {
    rows.push_back({t.trial, static_cast<int>(t.status), pose_json(t.truth), pose_json(t.answer),
                    pose_json(t.node), number(t.error_m), number(t.node_error_m),
                    number(t.heading_error_rad), t.lines, t.score, t.runner_up, t.corners,
                    t.corner_mismatches, t.cpu_ms, t.wall_ms});
  }
  return rows.dump();
}

std::vector<TrialResult> parse_trials(const std::string& text) {
  std::vector<TrialResult> trials;
  for (const Json& row : Json::parse(text)) {
    TrialResult t;
    t.trial = row.at(0).get<std::uint32_t>();
    t.status = static_cast<LocalisationStatus>(row.at(1).get<int>());
    t.truth = pose_of(row.at(2));
    t.answer = pose_of(row.at(3));
    t.node = pose_of(row.at(4));
    t.error_m = number(row.at(5));
    t.node_error_m = number(row.at(6));
    t.heading_error_rad = number(row.at(7));
    t.lines = row.at(8).get<int>();
    t.score = row.at(9).get<double>();
    t.runner_up = row.at(10).get<double>();
    t.corners = row.at(11).get<int>();
    t.corner_mismatches = row.at(12).get<int>();
    t.cpu_ms = row.at(13).get<double>();
    t.wall_ms = row.at(14).get<double>();
    trials.push_back(t);
  }
  return trials;
}

}  // namespace

struct StudyStore::Connection {
  std::string place;
  sqlite3* db = nullptr;

  ~Connection() { sqlite3_close(db); }

  [[noreturn]] void fail() const {
    throw Error(place, std::string("study store: ") + sqlite3_errmsg(db),
                "check that the file is a study store, and the disk");
  }
  void run(const char* sql) const {
    if (sqlite3_exec(db, sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }

  /// A prepared statement that is finalised on destruction.
  class Statement {
   public:
    Statement(const Connection& connection, const char* sql) : connection_(connection) {
      if (sqlite3_prepare_v2(connection.db, sql, -1, &statement_, nullptr) != SQLITE_OK) {
        connection.fail();
      }
    }
    ~Statement() { sqlite3_finalize(statement_); }
    Statement(const Statement&) = delete;
    Statement& operator=(const Statement&) = delete;

    Statement& bind(int index, const std::string& value) {
      sqlite3_bind_text(statement_, index, value.data(), static_cast<int>(value.size()),
                        SQLITE_TRANSIENT);
      return *this;
    }
    Statement& bind(int index, int value) {
      sqlite3_bind_int(statement_, index, value);
      return *this;
    }
    bool step() {
      const int status = sqlite3_step(statement_);
      if (status != SQLITE_ROW && status != SQLITE_DONE) connection_.fail();
      return status == SQLITE_ROW;
    }
    std::string text(int column) const {
      const auto* bytes = sqlite3_column_text(statement_, column);
      return bytes ? reinterpret_cast<const char*>(bytes) : "";
    }
    int integer(int column) const { return sqlite3_column_int(statement_, column); }

   private:
    const Connection& connection_;
    sqlite3_stmt* statement_ = nullptr;
  };
};

StudyStore::StudyStore(const std::filesystem::path& file)
    : connection_(std::make_unique<Connection>()) {
  connection_->place = file.string();
  if (sqlite3_open(file.c_str(), &connection_->db) != SQLITE_OK) connection_->fail();
  sqlite3_busy_timeout(connection_->db, 10'000);
  connection_->run(
      "PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;"
      "CREATE TABLE IF NOT EXISTS note (key TEXT PRIMARY KEY, value TEXT);"
      "CREATE TABLE IF NOT EXISTS block (cell TEXT, block INTEGER, trials INTEGER,"
      " answered INTEGER, successes INTEGER, results TEXT, PRIMARY KEY (cell, block));");
  const std::string version = note("schema");
  if (version.empty()) {
    set_metadata("schema", schema_version);
  } else if (version != schema_version) {
    throw Error(file.string(), "study store version " + version + " is not supported; supported: 1",
                "use another folder");
  }
  const std::string here(instruction_set()), there = note("instruction_set");
  if (there.empty()) {
    set_metadata("instruction_set", here);
  } else if (there != here) {
    throw Error(file.string(),
                "written with instruction set " + there + ", this processor has " + here +
                    ": results would not be identical",
                "continue in another folder");
  }
}

StudyStore::~StudyStore() = default;
StudyStore::StudyStore(StudyStore&&) noexcept = default;

void StudyStore::put(const StoredBlock& block) {
  int answered = 0, successes = 0;
  for (const TrialResult& trial : block.trials) {
    answered += trial.answered();
    successes += trial.success();
  }
  Connection::Statement(*connection_, "INSERT OR REPLACE INTO block VALUES (?, ?, ?, ?, ?, ?)")
      .bind(1, block.cell)
      .bind(2, block.block)
      .bind(3, static_cast<int>(block.trials.size()))
      .bind(4, answered)
      .bind(5, successes)
      .bind(6, trials_text(block.trials))
      .step();
}

std::vector<StoredBlock> StudyStore::blocks() const {
  Connection::Statement rows(*connection_,
                             "SELECT cell, block, results FROM block ORDER BY cell, block");
  std::vector<StoredBlock> blocks;
  while (rows.step()) {
    try {
      blocks.push_back({rows.text(0), rows.integer(1), parse_trials(rows.text(2))});
    } catch (const Json::exception&) {
      throw Error(connection_->place, "block " + rows.text(1) + " is damaged",
                  "delete the store and run its shard again");
    }
  }
  return blocks;
}

void StudyStore::set_metadata(const std::string& key, const std::string& value) {
  Connection::Statement(*connection_, "INSERT OR REPLACE INTO note VALUES (?, ?)")
      .bind(1, key)
      .bind(2, value)
      .step();
}

std::string StudyStore::note(const std::string& key) const {
  Connection::Statement row(*connection_, "SELECT value FROM note WHERE key = ?");
  row.bind(1, key);
  return row.step() ? row.text(0) : "";
}

std::vector<std::pair<std::string, std::string>> StudyStore::notes() const {
  Connection::Statement rows(*connection_, "SELECT key, value FROM note ORDER BY key");
  std::vector<std::pair<std::string, std::string>> notes;
  while (rows.step()) notes.emplace_back(rows.text(0), rows.text(1));
  return notes;
}

StoredBlock longer_block(StoredBlock a, StoredBlock b, const std::string& place) {
  const auto untimed = [](TrialResult trial) {
    trial.cpu_ms = trial.wall_ms = 0;
    return trials_text({trial});
  };
  for (std::size_t i = 0; i < std::min(a.trials.size(), b.trials.size()); ++i) {
    if (untimed(a.trials[i]) != untimed(b.trials[i])) {
      throw Error(place,
                  "disagrees with another store on trial " + std::to_string(a.trials[i].trial),
                  "the stores come from different builds or processors; run one again");
    }
  }
  return a.trials.size() >= b.trials.size() ? std::move(a) : std::move(b);
}

std::vector<std::filesystem::path> store_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(folder)) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".sqlite") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace vernier::sim::internal
