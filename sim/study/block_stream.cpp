// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/block_stream.h"

#include <algorithm>
#include <string>
#include <utility>

#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_store.h"

namespace vernier::sim::internal {

namespace {

/// Calls visit(cell, key, block, wanted trials) for every block that the study asks for.
template <class Visit>
void for_each_wanted(const Study& study, Visit visit) {
  const int size = study.file.trials_per_block, all = study.file.trials;
  for (std::size_t cell = 0; cell < study.file.cells.size(); ++cell) {
    const std::string key = cell_key(study, study.file.cells[cell]);
    for (int first = 0, block = 0; first < all; first += size, ++block) {
      visit(cell, key, block, std::min(size, all - first));
    }
  }
}

}  // namespace

BlockStream::BlockStream(const Study& study, const std::filesystem::path& folder) : study_(study) {
  for (const std::filesystem::path& file : store_files(folder)) stores_.emplace_back(file);
}

std::size_t BlockStream::trials() const {
  std::size_t trials = 0;
  for_each_wanted(study_, [&](std::size_t, const std::string& key, int block, int wanted) {
    const bool is_done = std::any_of(stores_.begin(), stores_.end(), [&](const StoreReader& store) {
      return store.trials(key, block) >= wanted;
    });
    if (is_done) trials += static_cast<std::size_t>(wanted);
  });
  return trials;
}

std::size_t BlockStream::wanted() const {
  std::size_t trials = 0;
  for_each_wanted(study_, [&](std::size_t, const std::string&, int, int wanted) {
    trials += static_cast<std::size_t>(wanted);
  });
  return trials;
}

void BlockStream::for_each(const Visit& visit) const {
  for_each_wanted(study_, [&](std::size_t cell, const std::string& key, int block, int wanted) {
    StoredBlock found{key, block, {}};
    for (const StoreReader& store : stores_) {
      found = longer_block(store.block(key, block), std::move(found), store.file().string());
    }
    if (static_cast<int>(found.trials.size()) < wanted) return;
    found.trials.resize(static_cast<std::size_t>(wanted));
    visit(cell, block, found.trials);
  });
  for (const StoreReader& store : stores_) store.check_unchanged();
}

}  // namespace vernier::sim::internal
