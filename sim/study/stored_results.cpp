// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/stored_results.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "calib/interval.h"
#include "sim/study/instruction_sets.h"
#include "sim/study/study_store.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

void StoredResults::add_note(const StoreNotes::value_type& note,
                             const std::filesystem::path& file) {
  const auto& [key, value] = note;
  const auto [known, is_new] = notes_.emplace(key, value);
  if (is_new || known->second == value) return;
  if (key != instruction_set_note) {
    throw Error(file.string(), "disagrees with another store on a world ceiling",
                "the stores come from different builds or processors; run one again");
  }
  if (others_ == OtherInstructionSets::refused && !are_compatible_sets(known->second, value)) {
    throw Error(file.string(),
                "was written with instruction set " + shortened(value) + ", another store with " +
                    shortened(known->second) + ": results are not comparable to the bit",
                "run one again, or merge them with --allow-other-instruction-set");
  }
  known->second = all_instruction_sets(known->second, value);
}

void StoredResults::add(StoreIndex index, const std::filesystem::path& file) {
  if (index.interrupted) {
    interrupted_.push_back(file);
    return;
  }
  for (const auto& note : index.notes) {
    // a store just made says what its processor is, and has nothing of it
    if (note.first != instruction_set_note || holds_results(index)) add_note(note, file);
  }
  const int number = static_cast<int>(files_.size());
  files_.push_back(file);
  for (const auto& [cell, blocks] : index.blocks) {
    auto& places = blocks_[cell];
    for (const auto& [block, count] : blocks) places[block].push_back({number, count});
  }
}

void StoredResults::add_folder(const std::filesystem::path& folder) {
  for (const auto& file : store_files(folder)) add(read_index(file), file);
}

std::string StoredResults::instruction_sets() const {
  const auto note = notes_.find(instruction_set_note);
  return note == notes_.end() ? "" : note->second;
}

std::map<std::string, std::size_t> StoredResults::cells() const {
  std::map<std::string, std::size_t> found;
  for (const auto& [cell, blocks] : blocks_) found.emplace(cell, blocks.size());
  return found;
}

const std::vector<StoredResults::InFile>* StoredResults::places(const std::string& cell,
                                                                int block) const {
  const auto of_cell = blocks_.find(cell);
  if (of_cell == blocks_.end()) return nullptr;
  const auto found = of_cell->second.find(block);
  return found == of_cell->second.end() ? nullptr : &found->second;
}

ClusterCount StoredResults::count(const std::string& cell, int block) const {
  ClusterCount most;
  if (const auto* in = places(cell, block)) {
    for (const InFile& place : *in) {
      if (place.count.trials > most.trials) most = place.count;
    }
  }
  return most;
}

bool StoredResults::is_best(const std::filesystem::path& file,
                            const std::string& cell,
                            int block) const {
  const auto* in = places(cell, block);
  if (!in) return false;
  const int most = trials(cell, block);
  const auto best = std::find_if(in->begin(), in->end(),
                                 [&](const InFile& place) { return place.count.trials == most; });
  return files_[best->file] == file;
}

void StoredResults::read_through(const StudyStore* store, const std::filesystem::path& file) {
  own_ = store;
  own_file_ = file;
}

std::vector<StoredBlock> StoredResults::read_file(int file, const BlockRange& range) const {
  const std::filesystem::path& name = files_[static_cast<std::size_t>(file)];
  return own_ && name == own_file_ ? own_->blocks(range) : read_blocks(name, range);
}

std::vector<StoredBlock> StoredResults::read(const BlockRange& range) const {
  const auto of_cell = blocks_.find(range.cell);
  if (of_cell == blocks_.end()) return {};
  std::set<int> wanted;
  const auto end = of_cell->second.lower_bound(range.end);
  for (auto at = of_cell->second.lower_bound(range.first); at != end; ++at) {
    for (const InFile& place : at->second) wanted.insert(place.file);
  }
  std::map<int, StoredBlock> found;
  const bool may_differ = is_mixture(instruction_sets());
  for (const int file : wanted) {
    for (StoredBlock& block : read_file(file, range)) {
      const auto [known, is_new] = found.try_emplace(block.block);
      StoredBlock& kept = known->second;
      if (is_new || (may_differ && block.trials.size() > kept.trials.size())) {
        kept = std::move(block);
      } else if (!may_differ) {
        kept = longer_block(std::move(kept), std::move(block), files_[file].string());
      }
    }
  }
  std::vector<StoredBlock> blocks;
  for (auto& [number, block] : found) blocks.push_back(std::move(block));
  return blocks;
}

void StoredResults::check_agreement() const {
  constexpr int at_a_time = 200;
  for (const auto& [cell, blocks] : blocks_) {
    int checked = -1;
    for (const auto& [block, in] : blocks) {
      if (in.size() < 2 || block < checked) continue;
      checked = block + at_a_time;
      read({cell, block, checked});
    }
  }
}

void StoredResults::require_all_read() const {
  if (interrupted_.empty()) return;
  throw Error(interrupted_.front().string(), "was interrupted while it was written",
              "run its part of the study again, which completes it");
}

StoredResults stored_results(const std::filesystem::path& folder) {
  StoredResults all;
  all.add_folder(folder);
  return all;
}

}  // namespace vernier::sim::internal
