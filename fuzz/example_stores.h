// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "sim/experiment.h"
#include "sim/study/study_store.h"

/// Stores of studies: seeds, and whether what was written is what was read.
namespace vernier::fuzz {

/// Those of a block: of a localiser in block 0, of another system in the others.
std::vector<sim::TrialResult> example_trials(int block);

/// A command, a part of a world ceiling and what became of calibrations.
sim::internal::StoreNotes example_notes();

/// Makes an empty database whose pages have 512 bytes, the fewest there are: the store that is then
/// opened there is small.
void make_small_pages(const std::filesystem::path& file);

/// `b` holds what `a` does, to the bit, and may hold more; or throws Finding.
void require_kept(const sim::internal::StoreContent& a, const sim::internal::StoreContent& b);

/// Equal to the bit, or throws Finding. `b` may have more notes: an empty file has none, and
/// opening it adds the first.
void require_same(const std::vector<sim::TrialResult>& a, const std::vector<sim::TrialResult>& b);
void require_same(const sim::internal::StoreContent& a, const sim::internal::StoreContent& b);

}  // namespace vernier::fuzz
