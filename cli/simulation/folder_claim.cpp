// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/folder_claim.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include "calib/base/atomic_file.h"
#include "calib/base/output_files.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "cli/program/session.h"
#include "cli/simulation/study_inputs.h"
#include "sim/study/study.h"
#include "sim/study/study_difference.h"
#include "sim/study/study_store.h"

namespace vernier::cli {

namespace {

namespace fs = std::filesystem;

/// The folder and its parents as far as they do not exist, innermost first.
std::vector<fs::path> missing_folders(const fs::path& folder) {
  std::vector<fs::path> missing;
  std::error_code unknown;
  for (fs::path at = folder; !at.empty() && !fs::exists(at, unknown); at = at.parent_path()) {
    if (!at.filename().empty()) missing.push_back(at);
  }
  return missing;
}

void write_inputs(const fs::path& folder, const StudyInputs& inputs) {
  OutputFiles files;
  files.add_folder(folder);
  for (const auto& [name, content] : inputs) files.add(folder / name, content);
  files.commit();
}

}  // namespace

FolderClaim::FolderClaim(const Study& wanted, StudyInputs inputs, fs::path folder)
    : inputs_(std::move(inputs)),
      folder_(std::move(folder)),
      missing_folders_(missing_folders(folder_)),
      found_(find_study(wanted)) {
  stores_before_ = store_files(folder_);
  if (found_ == Found::nothing) write_inputs(folder_, inputs_);
}

FolderClaim::Found FolderClaim::find_study(const Study& wanted) const {
  std::error_code unknown;
  if (!missing_folders_.empty()) return Found::nothing;
  if (!fs::is_directory(folder_, unknown)) {
    throw Error(folder_.string(), "exists and is not a folder", "give another -o DIR");
  }
  if (!fs::exists(folder_ / study_copy, unknown)) {
    refuse_other_files();
    return Found::nothing;
  }
  Session silent;
  silent.quiet = true;
  const Study stored = [&] {
    try {
      return open_folder(folder_, silent);
    } catch (const Error& error) {
      throw Error(
          folder_.string(),
          fmt::format("holds a study that cannot be read ({}: {})", error.place(), error.fault()),
          "give another -o DIR");
    }
  }();
  if (const std::string why = study_difference(stored, wanted); !why.empty()) {
    throw Error(folder_.string(), "holds another study: " + why,
                "give another -o DIR, or go on with the study file of that folder");
  }
  if (!study_difference(wanted, stored).empty()) return Found::less;
  const bool same_limits =
      limit_difference(stored, wanted).empty() && limit_difference(wanted, stored).empty();
  return same_limits ? Found::same : Found::other_limits;
}

/// Inputs that another shard has just written, or a killed one, are no obstacle; neither are hidden
/// files.
void FolderClaim::refuse_other_files() const {
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    const auto is_same = [&](const auto& input) {
      std::error_code unknown;
      return input.first == name && entry.is_regular_file(unknown) &&
             read_whole(entry.path()) == input.second;
    };
    if (name[0] == '.' || std::any_of(inputs_.begin(), inputs_.end(), is_same)) continue;
    throw Error(folder_.string(),
                fmt::format("holds other files ({}) and no study", in_quotes(name)),
                "give a new or an empty folder as -o DIR");
  }
}

void FolderClaim::extend() const {
  const bool differs = found_ == Found::less || found_ == Found::other_limits;
  if (differs) write_inputs(folder_, inputs_);
}

void FolderClaim::remove_empty_store(const fs::path& store) const {
  const bool was_there =
      std::find(stores_before_.begin(), stores_before_.end(), store) != stores_before_.end();
  if (was_there || (fs::is_regular_file(store) && holds_results(read_index(store)))) return;
  for (const char* end : {"", "-wal", "-shm", "-journal"}) {
    const fs::path one = store.string() + end;
    if (fs::is_regular_file(one)) fs::remove(one);
  }
}

void FolderClaim::withdraw(const Shard& shard) const noexcept {
  try {
    remove_empty_store(store_file(folder_, shard));
    if (found_ != Found::nothing) return;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const fs::path ending = entry.path().extension();
      if (ending == ".sqlite" || ending == ".lock") return;  // of other shards
    }
    for (const auto& input : inputs_) fs::remove(folder_ / input.first);
    for (const fs::path& made : missing_folders_) fs::remove(made);
  } catch (...) {  // what it cannot remove stays, and the reason of the withdrawal is told
  }
}

}  // namespace vernier::cli
