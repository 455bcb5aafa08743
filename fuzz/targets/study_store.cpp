// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/example_stores.h"
#include "fuzz/fuzz_target.h"
#include "sim/study/store_rows.h"
#include "sim/study/study_store.h"

namespace vernier::fuzz {
namespace {

using sim::internal::parse_trials;
using sim::internal::read_store;
using sim::internal::StoredBlock;
using sim::internal::StudyStore;
using sim::internal::trials_text;

void run_study_store(std::string_view bytes) {
  clear_input_folder();
  const std::filesystem::path file = input_file(bytes, "study.sqlite");
  const auto content = accepted([&] { return read_store(file); });
  require(file_bytes(file) == bytes, "reading a store changes nothing");
  const auto files = std::filesystem::directory_iterator(input_folder());
  require(std::distance(begin(files), end(files)) == 1, "reading a store leaves no file");
  const auto opened = accepted([&] { return StudyStore(file).content(); });
  if (!content || content->interrupted || !opened) return;
  require_same(*content, *opened);
  const std::filesystem::path other = input_folder() / "copy.sqlite";
  {
    StudyStore copy(other);
    for (const StoredBlock& block : content->blocks) copy.put(block);
    for (const auto& [key, value] : content->notes) copy.set_note(key, value);
  }
  require_same(*content, read_store(other));
}

std::string store_with(int blocks, bool small_pages) {
  const std::filesystem::path file = input_folder() / "seed.sqlite";
  std::filesystem::remove(file);
  if (small_pages) make_small_pages(file);
  {
    StudyStore store(file);
    for (int block = 0; block < blocks; ++block) store.put({"cell", block, example_trials(block)});
    for (const auto& [key, value] : example_notes()) {
      if (blocks > 0) store.set_note(key, value);
    }
  }
  return file_bytes(file);
}

std::vector<std::string> study_store_seeds() {
  return {store_with(0, false), store_with(1, false), store_with(2, false), store_with(0, true),
          store_with(2, true)};
}

void run_stored_trials(std::string_view bytes) {
  const auto trials = accepted([&] { return parse_trials(std::string(bytes), "block 1"); });
  if (trials) require_same(*trials, parse_trials(trials_text(*trials), "written"));
}

std::vector<std::string> stored_trials_seeds() {
  return {trials_text(example_trials(0)), trials_text(example_trials(3))};
}

const Registered registered_study_store{
    {"study_store", 40'000, "sqlite", run_study_store, study_store_seeds}};
const Registered registered_stored_trials{
    {"stored_trials", 2000, "json", run_stored_trials, stored_trials_seeds}};

}  // namespace
}  // namespace vernier::fuzz
