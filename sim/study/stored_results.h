// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "calib/interval.h"
#include "sim/study/instruction_sets.h"
#include "sim/study/study_store.h"

namespace vernier::sim::internal {

/// What several stores of one study hold together: which blocks, and in which files. The trials
/// stay on the disk and are read some blocks at a time, so that memory does not grow with them.
class StoredResults {
 public:
  explicit StoredResults(OtherInstructionSets others = OtherInstructionSets::refused)
      : others_(others) {}

  /// Throws Error naming the file if a note disagrees with what is there: on a ceiling, on the
  /// processor's instruction set.
  void add(StoreIndex index, const std::filesystem::path& file);
  /// Adds the stores of a folder.
  void add_folder(const std::filesystem::path& folder);
  /// From now on reads this file through the store that this process writes, which must outlive
  /// this; null: no more.
  void read_through(const StudyStore* store, const std::filesystem::path& file);

  const StoreNotes& notes() const { return notes_; }
  const std::vector<std::filesystem::path>& files() const { return files_; }
  /// The instruction sets that the results come from; empty if there are none.
  std::string instruction_sets() const;

  /// The keys of the cells that have blocks, ascending, and how many.
  std::map<std::string, std::size_t> cells() const;

  /// The number of trials of a block in the file that has most; 0: it is in none.
  int trials(const std::string& cell, int block) const { return count(cell, block).trials; }
  /// The same with its successes.
  ClusterCount count(const std::string& cell, int block) const;
  /// Whether this file is the first of those that have most trials of a block.
  bool is_best(const std::filesystem::path& file, const std::string& cell, int block) const;
  /// The blocks of a range, ascending, each with as many trials as a file has. Throws Error naming
  /// the file if two disagree on a trial, other than by instruction sets that may differ.
  std::vector<StoredBlock> read(const BlockRange& range) const;
  /// Throws the same for all blocks that are in several files.
  void check_agreement() const;

  /// Throws Error if a store cannot be read before its next run.
  void require_all_read() const;

 private:
  struct InFile {
    int file = 0;
    ClusterCount count;
  };
  std::vector<StoredBlock> read_file(int file, const BlockRange& range) const;
  void add_note(const StoreNotes::value_type& note, const std::filesystem::path& file);
  const std::vector<InFile>* places(const std::string& cell, int block) const;

  OtherInstructionSets others_;
  std::map<std::string, std::map<int, std::vector<InFile>>> blocks_;  // by cell and number
  StoreNotes notes_;
  std::vector<std::filesystem::path> files_;
  const StudyStore* own_ = nullptr;
  std::filesystem::path own_file_;
  std::vector<std::filesystem::path> interrupted_;  // stores that cannot be read yet
};

/// Those of a folder, read as read_index does.
StoredResults stored_results(const std::filesystem::path& folder);

}  // namespace vernier::sim::internal
