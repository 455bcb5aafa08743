// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/study/store_database.h"
#include "sim/study/store_rows.h"
#include "sim/study/study_store.h"

namespace vernier::sim::internal {

/// Version of the tables: 0 for an empty file, 1 without checksums, 2 with a checksum per row.
/// Throws Error if the tables are not exactly those of a version, or of a later version.
int store_version(const Database& database);

/// Makes the tables of version 2, in an empty file or of those of version 1.
void make_store(const Database& database);

/// Everything in the tables, every row checked. Throws Error at the first that is damaged.
StoreContent stored_content(const Database& database);

/// Which blocks the tables hold, and all notes. Checks the pages and every row's checksum, not what
/// the trials say.
StoreIndex stored_index(const Database& database);

/// The blocks of a range, ascending, every row checked.
std::vector<StoredBlock> stored_blocks(const Database& database, const BlockRange& range);

/// Calls visit with every row, checked as those of stored_content.
void visit_rows(const Database& database, const std::function<void(const BlockRow&)>& visit);

void store_row(const Database& database, const BlockRow& row);
void store_block(const Database& database, const StoredBlock& block);
void store_note(const Database& database, const std::string& key, const std::string& value);

}  // namespace vernier::sim::internal
