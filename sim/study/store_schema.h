// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/study/store_database.h"
#include "sim/study/study_store.h"

namespace vernier::sim::internal {

/// Version of the tables: 0 for an empty file, 1 without checksums, 2 with a checksum per row.
/// Throws Error if the tables are not exactly those of a version, or of a later version.
int store_version(const Database& database);

/// Makes the tables of version 2, in an empty file or of those of version 1.
void make_store(const Database& database);

/// Everything in the tables, every row checked. Throws Error at the first that is damaged.
StoreContent stored_content(const Database& database);

/// Checks the pages and the tables, not the rows. Throws Error as stored_content() does.
void check_store(const Database& database);

/// Number of trials in a block, 0 if there is none; and the block, checked, without trials if there
/// is none.
int stored_trials(const Database& database, const std::string& cell, int block);
StoredBlock stored_block(const Database& database, const std::string& cell, int block);

void store_block(const Database& database, const StoredBlock& block);
void store_note(const Database& database, const std::string& key, const std::string& value);

}  // namespace vernier::sim::internal
