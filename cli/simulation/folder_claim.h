// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/program/namespaces.h"
#include "cli/simulation/study_inputs.h"
#include "sim/study/study.h"

namespace vernier::cli {

/// The folder in which a study is about to run: new or empty, or with the same study, which the
/// wanted one may extend by trials or cells.
class FolderClaim {
 public:
  /// Makes the folder with the inputs if there is none. Throws Error, and changes nothing, if it
  /// holds another study (naming a setting that differs) or other files.
  FolderClaim(const Study& wanted, StudyInputs inputs, std::filesystem::path folder);

  /// Replaces the inputs by those of the wanted study if it extends the one of the folder, or has
  /// other limits of success. Only for who may write the store, or has nothing to add to it.
  void extend() const;

  /// Removes what the constructor and a run of the shard made, as long as no result is stored.
  void withdraw(const Shard& shard) const noexcept;

 private:
  /// `other_limits`: the same trials, of which others count as successes.
  enum class Found { nothing, same, less, other_limits };

  Found find_study(const Study& wanted) const;
  void refuse_other_files() const;
  void remove_empty_store(const std::filesystem::path& store) const;

  StudyInputs inputs_;
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> missing_folders_;  // innermost first
  std::vector<std::filesystem::path> stores_before_;
  Found found_;
};

}  // namespace vernier::cli
