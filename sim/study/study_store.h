// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calib/interval.h"
#include "sim/experiment.h"
#include "sim/study/instruction_sets.h"
#include "sim/study/store_rows.h"

namespace vernier::sim::internal {

/// A completed block of trials of one cell.
struct StoredBlock {
  std::string cell;  ///< key: everything that its results depend on
  int block = 0;
  std::vector<TrialResult> trials;
};

/// Texts by key: the processor's instruction set, commands, ceilings.
using StoreNotes = std::map<std::string, std::string>;

/// All that a store holds.
struct StoreContent {
  std::vector<StoredBlock> blocks;  ///< ascending by cell and block
  StoreNotes notes;
  /// It cannot be read before its next run, which undoes a change that was cut short, or makes the
  /// index of a log that was copied without it.
  bool interrupted = false;
};

/// Which blocks a store holds, without their trials.
struct StoreIndex {
  std::map<std::string, std::map<int, ClusterCount>> blocks;  ///< by cell and number
  StoreNotes notes;
  bool interrupted = false;  ///< as StoreContent's
};

/// Whether it has a block, or a part of a ceiling.
bool holds_results(const StoreIndex& index);

/// Blocks first to end - 1 of a cell.
struct BlockRange {
  std::string cell;
  int first = 0, end = 0;
};

/// How SQLite keeps changes that are not complete.
enum class Journal {
  write_ahead,  ///< WAL: readers and the writer never wait; needs a local disk
  roll_back,    ///< DELETE: safe on network disks too
};

/// WAL on local disks, DELETE on others.
Journal journal_for(const std::filesystem::path& file);

/// Completed blocks in an SQLite file, open for writing by its only writer: one committed row per
/// block, with a checksum. A killed process loses only the block in progress.
class StudyStore {
 public:
  /// Opens or creates the file. Throws Error if another process writes it, if it is not a store or
  /// damaged, or was written on a processor with another instruction set (results would not be
  /// comparable to the bit) unless that is allowed, which it then notes. A store of version 1,
  /// which has no checksums, becomes one of version 2.
  explicit StudyStore(const std::filesystem::path& file,
                      OtherInstructionSets others = OtherInstructionSets::refused);
  StudyStore(const std::filesystem::path& file,
             Journal journal,
             OtherInstructionSets others = OtherInstructionSets::refused);
  ~StudyStore();
  StudyStore(StudyStore&&) noexcept;

  /// Adds or replaces a block; committed on return.
  void put(const StoredBlock& block);
  void put(const BlockRow& row);
  /// The same for several, committed together.
  void put(const std::vector<BlockRow>& rows);
  void set_note(const std::string& key, const std::string& value);
  /// Reads and checks everything. Throws Error if anything is damaged.
  StoreContent content() const;
  StoreIndex index() const;
  /// Those of a range that are there, ascending, checked.
  std::vector<StoredBlock> blocks(const BlockRange& range) const;

 private:
  struct Open;
  std::unique_ptr<Open> open_;
};

/// Reads and checks a store of version 1 or 2, also while another process writes it. Needs no
/// permission to write, changes nothing and leaves no file behind. Throws Error as above. Not for
/// a store that this process is writing: POSIX locks would be lost; use content().
StoreContent read_store(const std::filesystem::path& file);

/// The same for which blocks it holds, for some of them, and for every row: what is read is not
/// kept. Where another process changes the file meanwhile they may begin again, so that `visit`
/// sees rows twice.
StoreIndex read_index(const std::filesystem::path& file);
std::vector<StoredBlock> read_blocks(const std::filesystem::path& file, const BlockRange& range);
void visit_store(const std::filesystem::path& file,
                 const std::function<void(const BlockRow&)>& visit);

/// The longer of two versions of a block. Throws Error(`place`) if their common trials differ in
/// more than the timings.
StoredBlock longer_block(StoredBlock a, StoredBlock b, const std::string& place);

/// Store files of a study's folder, sorted by name.
std::vector<std::filesystem::path> store_files(const std::filesystem::path& folder);

}  // namespace vernier::sim::internal
