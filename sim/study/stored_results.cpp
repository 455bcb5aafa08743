// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/stored_results.h"

#include <string>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "sim/study/study_store.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

void StoredResults::add(StoreContent content, const std::filesystem::path& file) {
  if (content.interrupted) {
    interrupted.push_back(file);
    return;
  }
  for (auto& [key, value] : content.notes) {
    const auto [known, is_new] = notes.emplace(key, value);
    if (is_new || known->second == value) continue;
    throw Error(file.string(),
                key == "instruction_set" ? "was written with instruction set " + shortened(value) +
                                               ", another store with " + shortened(known->second) +
                                               ": results are not comparable to the bit"
                                         : "disagrees with another store on a world ceiling",
                "the stores come from different builds or processors; run one again");
  }
  for (StoredBlock& block : content.blocks) {
    auto& kept = blocks[{block.cell, block.block}];
    kept = longer_block(std::move(block), std::move(kept), file.string());
  }
}

void StoredResults::require_all_read() const {
  if (interrupted.empty()) return;
  throw Error(interrupted.front().string(), "was interrupted while it was written",
              "run its part of the study again, which completes it");
}

StoredResults stored_results(const std::filesystem::path& folder) {
  StoredResults all;
  for (const auto& file : store_files(folder)) all.add(read_store(file), file);
  return all;
}

}  // namespace vernier::sim::internal
