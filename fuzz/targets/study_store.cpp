// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_target.h"
#include "fuzz/same_values.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/study/store_rows.h"
#include "sim/study/study_store.h"

namespace vernier::fuzz {
namespace {

using localise::LocalisationStatus;
using sim::TrialResult;
using sim::internal::parse_trials;
using sim::internal::read_store;
using sim::internal::StoreContent;
using sim::internal::StoredBlock;
using sim::internal::StudyStore;
using sim::internal::trials_text;

void require_same_trials(const std::vector<TrialResult>& a, const std::vector<TrialResult>& b) {
  require(a.size() == b.size(), "the number of trials is kept");
  const auto same_pose = [](const localise::Pose2D& p, const localise::Pose2D& q) {
    return same(p.x_m, q.x_m) && same(p.y_m, q.y_m) && same(p.heading_rad, q.heading_rad);
  };
  for (std::size_t i = 0; i < a.size(); ++i) {
    const TrialResult &s = a[i], &t = b[i];
    require(s.trial == t.trial && s.status == t.status && s.lines == t.lines &&
                s.corners == t.corners && s.corner_mismatches == t.corner_mismatches &&
                s.looks == t.looks,
            "the counts of trials are kept");
    require(
        same_pose(s.truth, t.truth) && same_pose(s.answer, t.answer) && same_pose(s.node, t.node),
        "the poses of trials are kept");
    require(same(s.error, t.error) && same(s.node_error_m, t.node_error_m) &&
                same(s.heading_error_rad, t.heading_error_rad) && same(s.score, t.score) &&
                same(s.runner_up, t.runner_up) && same(s.cpu_ms, t.cpu_ms) &&
                same(s.wall_ms, t.wall_ms) && same(s.probability, t.probability) &&
                same(s.limit, t.limit),
            "the figures of trials are kept");
    require(s.failure == t.failure && s.measured.has_value() == t.measured.has_value() &&
                (!s.measured ||
                 std::equal(s.measured->begin(), s.measured->end(), t.measured->begin(),
                            t.measured->end(), [](double p, double q) { return same(p, q); })),
            "what trials of other systems say is kept");
  }
}

void require_same_content(const StoreContent& a, const StoreContent& b) {
  for (const auto& [key, value] : a.notes) {  // an empty file has none; opening it adds the first
    require(b.notes.count(key) == 1 && b.notes.at(key) == value, "notes are kept");
  }
  require(a.blocks.size() == b.blocks.size(), "the number of blocks is kept");
  for (std::size_t i = 0; i < a.blocks.size(); ++i) {
    require(a.blocks[i].cell == b.blocks[i].cell && a.blocks[i].block == b.blocks[i].block,
            "blocks are kept");
    require_same_trials(a.blocks[i].trials, b.blocks[i].trials);
  }
}

void run_study_store(std::string_view bytes) {
  clear_input_folder();
  const std::filesystem::path file = input_file(bytes, "study.sqlite");
  const auto content = accepted([&] { return read_store(file); });
  require(file_bytes(file) == bytes, "reading a store changes nothing");
  const auto files = std::filesystem::directory_iterator(input_folder());
  require(std::distance(begin(files), end(files)) == 1, "reading a store leaves no file");
  const auto opened = accepted([&] { return StudyStore(file).content(); });
  if (!content || content->interrupted || !opened) return;
  require_same_content(*content, *opened);
  const std::filesystem::path other = input_folder() / "copy.sqlite";
  {
    StudyStore copy(other);
    for (const StoredBlock& block : content->blocks) copy.put(block);
    for (const auto& [key, value] : content->notes) copy.set_note(key, value);
  }
  require_same_content(*content, read_store(other));
}

std::vector<TrialResult> example_trials(int block) {
  std::vector<TrialResult> trials(2);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    TrialResult& trial = trials[i];
    trial.trial = static_cast<std::uint32_t>(2 * block) + static_cast<std::uint32_t>(i);
    trial.truth = {1.0 / 3, -2.0 / 7, 0.1};
    trial.status = i == 0 ? LocalisationStatus::answered : LocalisationStatus::tie;
    trial.error = trial.node_error_m = trial.heading_error_rad = i == 0 ? 0.125 : std::nan("");
    trial.lines = 12;
    trial.score = 4.5;
    if (block == 0) continue;  // one of another system than a localiser
    trial.limit = 0.05;
    trial.measured = {0.5, std::nan("")};
    trial.failure = "says why";
  }
  return trials;
}

std::vector<std::string> study_store_seeds() {
  std::vector<std::string> seeds;
  for (int blocks = 0; blocks < 3; ++blocks) {
    const std::filesystem::path file = input_folder() / "seed.sqlite";
    std::filesystem::remove(file);
    {
      StudyStore store(file);
      for (int block = 0; block < blocks; ++block) {
        store.put({"cell", block, example_trials(block)});
      }
      if (blocks > 0) store.set_note("command", "vernier study run");
    }
    seeds.push_back(file_bytes(file));
  }
  return seeds;
}

void run_stored_trials(std::string_view bytes) {
  const auto trials = accepted([&] { return parse_trials(std::string(bytes), "block 1"); });
  if (trials) require_same_trials(*trials, parse_trials(trials_text(*trials), "written"));
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
