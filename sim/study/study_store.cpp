// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study_store.h"

#include <sys/stat.h>

#include <sqlite3.h>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "calib/base/instruction_set.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "sim/experiment.h"
#include "sim/study/instruction_sets.h"
#include "sim/study/store_database.h"
#include "sim/study/store_lock.h"
#include "sim/study/store_rows.h"
#include "sim/study/store_schema.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

namespace fs = std::filesystem;

/// What changes in a file when another process writes it.
struct FileState {
  bool exists = false;
  std::int64_t size = 0, inode = 0, modified_s = 0, modified_ns = 0;
  bool operator==(const FileState&) const = default;
};

FileState state_of(const fs::path& file) {
  struct stat found {};
  if (::stat(file.c_str(), &found) != 0) return {};
  return {true, found.st_size, static_cast<std::int64_t>(found.st_ino), found.st_mtim.tv_sec,
          found.st_mtim.tv_nsec};
}

fs::path beside(const fs::path& store, const char* ending) { return store.string() + ending; }

/// Of a file that does not change: neither locks nor a log are looked at.
constexpr const char* unlocked = "immutable=1";

std::array<FileState, 2> state_of_store(const fs::path& file) {
  return {state_of(file), state_of(beside(file, "-wal"))};
}

/// SQLite would wait for a pipe, and take it away.
void check_regular(const fs::path& file) {
  for (const char* end : {"", "-wal", "-shm", "-journal"}) {
    const fs::path one = beside(file, end);
    std::error_code unknown;
    const fs::file_status status = fs::status(one, unknown);
    if (fs::exists(status) && !fs::is_regular_file(status)) {
      throw Error(one.string(), "is not a regular file", "remove it, or give another folder");
    }
  }
}

/// Whether the file's head says that changes go to a log beside it (WAL). SQLite goes by the second
/// of its two bytes about this.
bool has_write_ahead_head(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    throw Error(file.string(), "cannot be read", "check that it exists, and its permissions");
  }
  std::array<char, 20> head{};
  in.read(head.data(), head.size());
  return in && head.back() == 2;
}

/// SQLite's options for reading a store that has a log without making or changing a file: a log
/// that holds changes is read with its index, which is not written; one that holds none, or is not
/// there, is left out, which is right as long as neither file changes.
std::string reading_options(const fs::path& file) {
  const FileState log = state_of(beside(file, "-wal"));
  if (log.exists && log.size > 0) {
    return "readonly_shm=1";
  }
  return has_write_ahead_head(file) ? unlocked : "";
}

/// Whether a killed writer left what only the next writer can mend: a change to undo, or a log's
/// index that is not complete, which a reader that may not write it waits for in vain.
bool needs_a_writer(int code) {
  return code == SQLITE_READONLY_ROLLBACK || code == SQLITE_READONLY_RECOVERY ||
         code == SQLITE_READONLY_CANTINIT || code == SQLITE_PROTOCOL;
}

/// A result for a store that only its next run can mend.
template <class Result>
Result interrupted() {
  Result none;
  none.interrupted = true;
  return none;
}

template <class Result>
Result read_once(const fs::path& file,
                 const std::string& options,
                 const std::function<Result(const Database&)>& read) {
  const Database database = Database::to_read(file, options);
  try {
    database.run("BEGIN");
    return read(database);
  } catch (const Error&) {
    if (needs_a_writer(database.code())) return interrupted<Result>();
    throw;
  }
}

/// Reads, again if the file has changed meanwhile. A Result has a member `interrupted`.
template <class Result>
Result read_unchanged(const fs::path& file, const std::function<Result(const Database&)>& read) {
  using namespace std::chrono_literals;
  constexpr int attempts = 20;
  for (int attempt = 1;; ++attempt) {
    check_regular(file);
    const auto before = state_of_store(file);
    if (before[0].exists && before[0].size == 0) return {};  // its writer was killed at the start
    // A log without its index: only a writer can make that.
    if (state_of(beside(file, "-wal")).size > 0 && !state_of(beside(file, "-shm")).exists) {
      return interrupted<Result>();
    }
    try {
      const std::string options = reading_options(file);
      Result result = read_once(file, options, read);
      if (options != unlocked || state_of(file) == before[0]) return result;
      if (attempt == attempts) {
        throw Error(file.string(), "is being changed by another process",
                    "run the same command again when that has ended");
      }
    } catch (const Error&) {
      if (attempt == attempts || state_of_store(file) == before) throw;
    }
    std::this_thread::sleep_for(50ms);
  }
}

/// What read_blocks and visit_store need.
struct SomeBlocks {
  std::vector<StoredBlock> blocks;
  bool interrupted = false;
};

void require_read(const fs::path& file, const SomeBlocks& read) {
  if (read.interrupted) {
    throw Error(file.string(), "was interrupted while it was written",
                "run its part of the study again, which completes it");
  }
}

}  // namespace

Journal journal_for(const fs::path& file) {
  return on_local_disk(file) ? Journal::write_ahead : Journal::roll_back;
}

struct StudyStore::Open {
  StoreLock lock;  // dropped after the file is closed
  Database database;
};

StudyStore::StudyStore(const fs::path& file, OtherInstructionSets others)
    : StudyStore(file, journal_for(file), others) {}

StudyStore::StudyStore(const fs::path& file, Journal journal, OtherInstructionSets others)
    : open_(new Open{StoreLock((check_regular(file), file)), Database::to_write(file)}) {
  const Database& database = open_->database;
  const int version = store_version(database);  // before anything is changed
  const bool log = journal == Journal::write_ahead;
  database.run(log ? "PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL"
                   : "PRAGMA journal_mode = DELETE; PRAGMA synchronous = FULL");
  if (version < 2) make_store(database);
  const std::string here(instruction_set());
  Statement row(database, "SELECT value FROM remark WHERE key = 'instruction_set'");
  if (!row.step()) {
    set_note("instruction_set", here);
  } else if (const std::string there = row.text(0); !has_instruction_sets(there, here)) {
    if (others == OtherInstructionSets::refused) {
      throw Error(file.string(),
                  "written with instruction set " + shortened(there) + ", this processor has " +
                      here + ": results would not be identical",
                  "continue in another folder, or give --allow-other-instruction-set");
    }
    set_note(instruction_set_note, all_instruction_sets(there, here));
  }
}

/// Leaves one file, without a log, also if another process is reading: SQLite leaves the log to a
/// reader that may not remove it.
StudyStore::~StudyStore() {
  using namespace std::chrono_literals;
  constexpr int attempts = 100;
  for (int attempt = 0; open_ && attempt < attempts; ++attempt) {
    try {
      open_->database.run("PRAGMA journal_mode = DELETE");
      return;
    } catch (...) {  // the log stays where the disk is full, for the next run
      if (open_->database.code() != SQLITE_BUSY) return;
    }
    std::this_thread::sleep_for(50ms);
  }
}
StudyStore::StudyStore(StudyStore&&) noexcept = default;

void StudyStore::put(const StoredBlock& block) { store_block(open_->database, block); }

void StudyStore::put(const BlockRow& row) { store_row(open_->database, row); }

void StudyStore::put(const std::vector<BlockRow>& rows) {
  Transaction together(open_->database);
  for (const BlockRow& row : rows) store_row(open_->database, row);
  together.commit();
}

void StudyStore::set_note(const std::string& key, const std::string& value) {
  store_note(open_->database, key, value);
}

StoreContent StudyStore::content() const { return stored_content(open_->database); }

StoreIndex StudyStore::index() const { return stored_index(open_->database); }

std::vector<StoredBlock> StudyStore::blocks(const BlockRange& range) const {
  return stored_blocks(open_->database, range);
}

StoreContent read_store(const fs::path& file) {
  return read_unchanged<StoreContent>(file, stored_content);
}

StoreIndex read_index(const fs::path& file) {
  return read_unchanged<StoreIndex>(file, stored_index);
}

std::vector<StoredBlock> read_blocks(const fs::path& file, const BlockRange& range) {
  SomeBlocks read = read_unchanged<SomeBlocks>(file, [&](const Database& database) {
    return SomeBlocks{stored_blocks(database, range), false};
  });
  require_read(file, read);
  return std::move(read.blocks);
}

void visit_store(const fs::path& file, const std::function<void(const BlockRow&)>& visit) {
  require_read(file, read_unchanged<SomeBlocks>(file, [&](const Database& database) {
                 visit_rows(database, visit);
                 return SomeBlocks{};
               }));
}

bool holds_results(const StoreIndex& index) {
  return !index.blocks.empty() || index.interrupted ||
         std::any_of(index.notes.begin(), index.notes.end(),
                     [](const auto& note) { return note.first.rfind("ceiling", 0) == 0; });
}

StoredBlock longer_block(StoredBlock a, StoredBlock b, const std::string& place) {
  const auto untimed = [](TrialResult trial) {
    trial.cpu_ms = trial.wall_ms = 0;
    trial.limit = success_radius_m;  // that of a study, not of a result
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

std::vector<fs::path> store_files(const fs::path& folder) {
  std::vector<fs::path> files;
  if (fs::is_directory(folder)) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      std::error_code unknown;
      if (entry.path().extension() == ".sqlite" && entry.is_regular_file(unknown)) {
        files.push_back(entry.path());
      }
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace vernier::sim::internal
