// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <span>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/interval.h"
#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/study/budget.h"
#include "sim/study/cell_comparison.h"
#include "sim/study/cell_tally.h"
#include "sim/study/study_difference.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_store.h"
#include "tests/support/example_study.h"

namespace vernier {

using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

class StudyRuns : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("vernier_study_" + std::to_string(::getpid()));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static Study study(int trials, const std::string& sweep = "[0.1, 10]") {
    return test::example_study(trials, sweep);
  }

  /// Everything but the timings.
  static std::string words(const StudyResults& results) {
    std::string text;
    for (const CellResult& cell : results.cells) {
      text += std::to_string(cell.ceiling ? cell.ceiling->success : -1) + "\n";
      for (TrialResult t : cell.trials) {
        char line[400];
        std::snprintf(line, sizeof line, "%u %d %a %a %a %a %a %a %a %d %a\n", t.trial,
                      static_cast<int>(t.status), t.truth.x_m, t.truth.heading_rad, t.answer.x_m,
                      t.answer.y_m, t.answer.heading_rad, t.error, t.score, t.lines, t.runner_up);
        text += line;
      }
    }
    return text;
  }

  StudyResults run(const Study& s, const std::string& name, int threads, Shard shard = {}) {
    run_study(s, {folder_ / name, threads, shard, {}, {}});
    return study_results(s, folder_ / name);
  }

  std::filesystem::path folder_;
};

std::size_t allowed_threads() {
  return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
}

TEST_F(StudyRuns, OneAndTwoThreadsGiveTheSameBits) {
  const Study s = study(48);
  const auto words_of = [&](int threads) {
    std::set<std::thread::id> seen;
    const auto look_at = [&](int, int) { seen.insert(std::this_thread::get_id()); };
    const StudyRun job{.folder = folder_ / std::to_string(threads),
                       .threads = threads,
                       .progress = look_at,
                       .ceiling_progress = look_at};
    run_study(s, job);
    EXPECT_EQ(seen.size(), static_cast<std::size_t>(threads));  // on a single core too
    return words(study_results(s, job.folder));
  };
  const std::string one = words_of(1), two = words_of(2);
  EXPECT_GT(one.size(), 1000u);
  EXPECT_EQ(one, two);
}

/// A study that stops at a width.
Study stopping(const Study& all, const std::string& width) {
  Study s = all;
  s.file = parse_study("[study]\ntrials = 900\ninterval_width = " + width +
                           "\nprotocol = \"near_path\"\n[map]\nspacing_m = 4\n"
                           "[localiser]\nmethod = \"pgh_baseline_vectorised\"\n",
                       "s.toml");
  return s;
}

// Whoever computes the blocks, a cell stops at the same one; what was computed beyond is left out.
TEST_F(StudyRuns, AWidthStopsACellAtTheSameBlockHoweverItRuns) {
  const Study s = stopping(study(6), "0.37");
  const StudyResults one = run(s, "one", 1);
  const CellResult& cell = one.cells[0];
  EXPECT_EQ(cell.budget.state, BudgetState::narrow);
  EXPECT_GT(cell.budget.wanted, 6);
  EXPECT_LT(cell.budget.wanted, 18);
  EXPECT_EQ(cell.trials.size(), 50u * static_cast<std::size_t>(cell.budget.wanted));
  EXPECT_EQ(one.blocks_done, one.blocks_total);
  const Interval i = cell.summary.success_interval_95.value();
  EXPECT_LE(i.high - i.low, 0.37);
  EXPECT_EQ(words(run(s, "two", 2)), words(one));

  // two shards, each run until none has anything left to do
  StudyResults parts;
  for (int round = 0; round < 6; ++round) {
    for (int shard = 0; shard < 2; ++shard) parts = run(s, "parts", 1, {shard, 2});
  }
  EXPECT_EQ(words(parts), words(one));

  // all blocks stored, by a study without a width
  Study all = s;
  all.file.interval_width.reset();
  EXPECT_EQ(run(all, "one", 2).cells[0].trials.size(), 900u);
  EXPECT_EQ(words(study_results(s, folder_ / "one")), words(one));
  EXPECT_NE(study_difference(all, s), "");  // the narrower wish may follow, not the wider
  EXPECT_EQ(study_difference(s, all), "");
  EXPECT_NE(study_difference(s, stopping(s, "0.5")), "");
}

// A lower limit for the whole process would slow down whoever uses the library beside its own
// threads; without a higher one TBB gives no more threads than there are cores, and says so.
TEST_F(StudyRuns, TheProcessKeepsItsThreads) {
  const std::size_t before = allowed_threads();
  for (const std::size_t threads : {std::size_t{1}, before + 3}) {
    int calls = 0;
    const auto look_at = [&](int, int) {
      ++calls;
      EXPECT_EQ(allowed_threads(), std::max(before, threads));
    };
    const auto look_within = [&](int done, int total) {
      look_at(done, total);
      if (done == 0) return;  // said before the arena is entered
      EXPECT_EQ(tbb::this_task_arena::max_concurrency(), static_cast<int>(threads));
    };
    testing::internal::CaptureStderr();
    run_study(study(6), {.folder = folder_ / ("threads" + std::to_string(threads)),
                         .threads = static_cast<int>(threads),
                         .progress = look_within,
                         .ceiling_progress = look_within});
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_GT(calls, 12);
    EXPECT_EQ(allowed_threads(), before);
  }
}

TEST_F(StudyRuns, ALimitOfTheCallersOwnStays) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  std::set<std::thread::id> seen;
  testing::internal::CaptureStderr();
  run_study(study(6), {.folder = folder_ / "limited", .threads = 3, .progress = [&](int, int) {
                         EXPECT_EQ(allowed_threads(), 1u);
                         seen.insert(std::this_thread::get_id());
                       }});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(seen.size(), 1u);
}

TEST_F(StudyRuns, CeilingsReportHowFarTheyAre) {
  Study s = study(7, "[0.1]");
  std::vector<int> reported;
  s.file.cells.push_back(s.file.cells[0]);  // shares the first one's ceiling
  StudyRun job{.folder = folder_ / "ceilings", .threads = 2};
  job.ceiling_progress = [&](int done, int total) {
    EXPECT_EQ(total, 14);  // of both cells together
    reported.push_back(done);
  };
  run_study(s, job);
  EXPECT_EQ(reported.size(), 15u);
  EXPECT_TRUE(std::is_sorted(reported.begin(), reported.end()));
  job.ceiling_progress = [](int, int) { FAIL() << "it is in the store"; };
  run_study(s, job);
  EXPECT_GT(study_results(s, folder_ / "ceilings").cells[0].ceiling.value().success, 0);
}

TEST_F(StudyRuns, ShardsAndResumedRunsGiveTheSameBits) {
  Study s = study(48), half = study(24);
  s.file.trials_per_block = half.file.trials_per_block = 20;
  const std::string whole = words(run(s, "whole", 2));
  run(s, "sharded", 1, {0, 3});
  run(s, "sharded", 1, {2, 3});
  EXPECT_LT(study_results(s, folder_ / "sharded").blocks_done, 6);
  EXPECT_EQ(words(run(s, "sharded", 1, {1, 3})), whole);

  // half the trials first, then all of them in the same folder
  run(half, "resumed", 2);
  int blocks_run = 0;
  run_study(s, {.folder = folder_ / "resumed", .threads = 2, .progress = [&](int done, int) {
                  blocks_run = done;
                }});
  EXPECT_EQ(blocks_run, 4);  // the first block of each cell was whole already
  EXPECT_EQ(words(study_results(s, folder_ / "resumed")), whole);
  run_study(s, {.folder = folder_ / "resumed", .threads = 2, .progress = [&](int, int total) {
                  EXPECT_EQ(total, 0);
                }});
}

TEST_F(StudyRuns, AskedToStopTheyKeepWhatIsDoneAndGoOn) {
  Study s = study(24);
  s.file.trials_per_block = 6;
  const std::string whole = words(run(s, "whole", 2));
  // before the first query, among the queries, and after each of two blocks
  for (const int after : {0, 3}) {
    std::stop_source stop;
    StudyRun job{.folder = folder_ / "stopped", .threads = 1, .stop = stop.get_token()};
    job.ceiling_progress = [&](int done, int) {
      if (done >= after) stop.request_stop();
    };
    run_study(s, job);
    EXPECT_EQ(study_results(s, folder_ / "stopped").blocks_done, 0);
  }
  for (int blocks = 1; blocks <= 2; ++blocks) {
    std::stop_source stop;
    StudyRun job{.folder = folder_ / "stopped", .threads = 1, .stop = stop.get_token()};
    job.progress = [&](int done, int) {
      if (done == 1) stop.request_stop();
    };
    run_study(s, job);
    EXPECT_EQ(study_results(s, folder_ / "stopped").blocks_done, blocks);
  }
  EXPECT_EQ(words(run(s, "stopped", 2)), whole);
}

// In folders of their own, as on machines that share no disk, and in one.
TEST_F(StudyRuns, ShardsShareTheCeiling) {
  Study s = study(7);
  s.file = parse_study("[study]\ntrials = 7\nprotocol = \"near_path\"\n[map]\nspacing_m = 4\n",
                       "s.toml");
  const auto queries_of = [&](const std::string& name, Shard shard) {
    int queries = 0;
    StudyRun job{.folder = folder_ / name, .threads = 2, .shard = shard};
    job.ceiling_progress = [&](int done, int total) {
      queries = total;
      EXPECT_LE(done, total);
    };
    run_study(s, job);
    return queries;
  };
  const auto ceiling_in = [&](const std::string& name) {
    const auto ceiling = study_results(s, folder_ / name).cells[0].ceiling;
    return ceiling ? ceiling->success : std::nan("");
  };
  const int parts[] = {3, 2, 2};
  std::filesystem::create_directories(folder_ / "merged");
  for (int i = 0; i < 3; ++i) {
    const std::string own = "own" + std::to_string(i);
    EXPECT_EQ(queries_of(own, {i, 3}), parts[i]);
    EXPECT_TRUE(std::isnan(ceiling_in(own)));
    const std::string store = "results-" + std::to_string(i) + "-of-3.sqlite";
    std::filesystem::copy_file(folder_ / own / store, folder_ / "merged" / store);
  }
  for (const Shard& shard : {Shard{1, 2}, Shard{}}) {  // in stores of other shards
    EXPECT_EQ(queries_of("merged", shard), 0);
  }
  EXPECT_EQ(queries_of("halves", {0, 2}), 4);
  EXPECT_EQ(queries_of("halves", {1, 2}), 3);
  EXPECT_EQ(queries_of("begun", {0, 2}), 4);
  EXPECT_EQ(queries_of("begun", {}), 3);
  EXPECT_EQ(queries_of("whole", {}), 7);
  EXPECT_GT(ceiling_in("whole"), 0);
  for (const char* name : {"merged", "halves", "begun"}) {
    EXPECT_EQ(ceiling_in(name), ceiling_in("whole")) << name;
  }
}

// Parts of a ceiling in any order and of any run make one: the best guess for query i is right with
// 1 / (1 + i), the last view determines nothing.
TEST_F(StudyRuns, ACeilingIsMadeOfItsParts) {
  Study s = study(7);
  s.file = parse_study("[study]\ntrials = 7\n[map]\nspacing_m = 4\n", "s.toml");
  const std::string key = ceiling_key(s, s.file.cells[0]);
  QueryCeilings even(7), odd(7), other(7);
  for (int query = 0; query < 6; ++query) {
    (query % 2 == 0 ? even : odd)[query] = QueryCeiling{1.0 / (1 + query), query == 0};
  }
  even[6] = QueryCeiling{};
  StoreNotes notes{ceiling_part(key, even)};
  EXPECT_FALSE(noted_ceiling(s, notes, key));
  EXPECT_EQ(noted_queries(s, notes, key), even);
  notes.insert(ceiling_part(key, odd));
  const auto ceiling = noted_ceiling(s, notes, key);
  ASSERT_TRUE(ceiling);
  EXPECT_EQ(ceiling->success, (1 + 1 / 2. + 1 / 3. + 1 / 4. + 1 / 5. + 1 / 6.) / 7);
  EXPECT_EQ(ceiling->unaliased, 1 / 7.);
  EXPECT_EQ(ceiling->queries, 7);
  EXPECT_LT(ceiling->success_interval_95.low, ceiling->success);
  EXPECT_GT(ceiling->success_interval_95.high, ceiling->success);
  other[3] = QueryCeiling{0.5, false};
  notes.insert(ceiling_part(key, other));
  EXPECT_THROW(noted_ceiling(s, notes, key), Error);
}

// As many as the trials of the cells that share it, 5,000 at most; another protocol has its own.
TEST_F(StudyRuns, ACeilingHasTheQueriesOfAllCellsThatShareIt) {
  const auto queries = [](const std::string& trials, const std::string& sweep) {
    Study s = study(7);
    s.file = parse_study("[study]\ntrials = " + trials + "\n[sweep]\n" + sweep, "s.toml");
    return ceiling_queries(s, ceiling_key(s, s.file.cells[0]));
  };
  EXPECT_EQ(queries("300", "\"sources.calibration\" = [0.1, 1, 10]"), 900);
  EXPECT_EQ(queries("300", "\"study.protocol\" = [\"path\", \"free\"]"), 300);
  EXPECT_EQ(queries("10000", "\"sources.calibration\" = [0.1, 1]"), 5000);
}

TEST_F(StudyRuns, CellsAreComparedOnTheSameTrials) {
  const StudyResults results = run(study(100, "[0.1, 1, 10]"), "paired", 2);
  const CellResult &a = results.cells[0], &b = results.cells[2];
  for (std::size_t i = 0; i < a.trials.size(); ++i) {
    EXPECT_EQ(a.trials[i].truth.x_m, b.trials[i].truth.x_m);
  }
  const PairedComparison c = compare(a, b);
  EXPECT_EQ(c.both + c.only_a + c.only_b + c.neither, 100);
  const CellSummary small = a.summary, large = b.summary;
  const double middle = results.cells[1].summary.median_error;
  EXPECT_LT(small.median_error, middle);  // psi_c 0.1, 1, 10
  EXPECT_LT(middle, large.median_error);
  ASSERT_TRUE(small.success_interval_95);
  EXPECT_GE(small.success_interval_95->high, small.success);
  EXPECT_LE(small.success_interval_95->low, small.success_interval_binomial_95.low + 1e-12);
  EXPECT_EQ(small.trials, 100);
  EXPECT_GT(small.cpu_ms_mean, 0);
}

// A block of another size records its map for other trials, so that its results are others too.
TEST_F(StudyRuns, BlocksOfAnotherSizeAreNotTakenOver) {
  Study pairs = study(12, "[10]"), whole = study(12, "[10]");
  EXPECT_EQ(pairs.file.trials_per_block, 2);
  whole.file.trials_per_block = 12;
  const std::string alone = words(run(whole, "alone", 2));
  const StudyResults in_pairs = run(pairs, "shared", 2);
  EXPECT_EQ(in_pairs.blocks_done, 6);
  EXPECT_EQ(study_results(whole, folder_ / "shared").blocks_done, 0);
  EXPECT_EQ(words(run(whole, "shared", 2)), alone);
  EXPECT_EQ(words(study_results(pairs, folder_ / "shared")), words(in_pairs));
  EXPECT_NE(words(in_pairs), alone);
}

TEST_F(StudyRuns, ASweptEndpointErrorIsToldOnlyWhereAskedFor) {
  const auto lines = [&](const std::string& sources, const std::string& knows) {
    Study s = study(6);
    s.file = parse_study("[study]\ntrials = 6\n[map]\nspacing_m = 4\n[sources]\n" + sources +
                             "[localiser]\nknows_endpoint_sigma = " + knows + "\n",
                         "s.toml");
    const StudyResults results = run(s, (sources.empty() ? "default_" : "swept_") + knows, 2);
    int sum = 0;
    for (const TrialResult& trial : results.cells[0].trials) sum += trial.lines;
    return std::pair(sum, words(results));
  };
  EXPECT_EQ(lines("", "false").second, lines("", "true").second);
  // told 2 px, the estimator finds depths worse than 0.45 m and leaves more lines out
  EXPECT_GT(lines("endpoint_sigma_px = 2\n", "false").first,
            lines("endpoint_sigma_px = 2\n", "true").first);
}

/// A cell of trials, so many on each map.
CellResult cell_of(const std::vector<TrialResult>& trials, int trials_per_map) {
  CellResult cell;
  cell.trials_per_block = trials_per_map;
  CellTally tally(cell);
  const auto step = static_cast<std::size_t>(trials_per_map);
  for (std::size_t at = 0; at < trials.size(); at += step) {
    const auto block = std::span(trials).subspan(at, step);
    tally.add(block);
    cell.maps.push_back({.successes = static_cast<int>(std::count_if(
                             block.begin(), block.end(), [](auto& t) { return t.success(); })),
                         .trials = trials_per_map});
  }
  tally.finish();
  return cell;
}

std::vector<TrialResult> right_trials(int number) {
  std::vector<TrialResult> trials(static_cast<std::size_t>(number));
  for (std::size_t i = 0; i < trials.size(); ++i) {
    trials[i].trial = static_cast<std::uint32_t>(i);
    trials[i].status = LocalisationStatus::answered;
  }
  return trials;
}

CellResult one_cell(int maps, int trials_per_map) {
  return cell_of(right_trials(maps * trials_per_map), trials_per_map);
}

TEST_F(StudyRuns, FiguresDoNotNeedTheTrials) {
  const Study s = study(30, "[1, 10]");
  const StudyResults all = run(s, "kept", 2);
  for (const std::size_t kept : {0u, 7u, 30u, 1000u}) {
    const StudyResults some = study_results(s, folder_ / "kept", kept);
    for (std::size_t i = 0; i < 2; ++i) {
      const CellResult &a = all.cells[i], &b = some.cells[i];
      ASSERT_EQ(b.trials.size(), std::min<std::size_t>(kept, 30));
      for (std::size_t k = 0; k < b.trials.size(); ++k) EXPECT_EQ(b.trials[k].trial, k);
      EXPECT_EQ(a.summary.success, b.summary.success);
      EXPECT_EQ(a.summary.median_error, b.summary.median_error);
      EXPECT_EQ(a.summary.cpu_ms_p95, b.summary.cpu_ms_p95);
      EXPECT_EQ(a.stated.thresholds().size(), b.stated.thresholds().size());
    }
    EXPECT_EQ(compare(all.cells[0], all.cells[1]).p_value,
              compare(some.cells[0], some.cells[1]).p_value);
  }
  const CellResult& cell = all.cells[0];
  std::vector<double> errors;
  int right = 0;
  for (const TrialResult& t : cell.trials) {
    right += t.success();
    if (t.answered()) errors.push_back(t.error);
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_EQ(cell.summary.trials, 30);
  EXPECT_EQ(cell.summary.success, right / 30.0);
  ASSERT_FALSE(errors.empty());
  const std::size_t half = errors.size() / 2;
  EXPECT_NEAR(cell.summary.median_error,
              errors.size() % 2 ? errors[half] : (errors[half - 1] + errors[half]) / 2, 1e-15);
}

TEST(Summary, SaysWhyThereIsNoInterval) {
  const CellSummary one = one_cell(1, 50).summary, six = one_cell(6, 3).summary;
  EXPECT_FALSE(one.success_interval_95);
  EXPECT_EQ(one.why_no_interval, "needs 6 maps, has 1");
  EXPECT_TRUE(six.success_interval_95);
  EXPECT_EQ(six.why_no_interval, "");
  EXPECT_EQ(six.maps, 6);
}

// The seed and the protocol decide where queries stand; a sweep over psi_c does not.
TEST_F(StudyRuns, CellsWithOtherQueriesAreNotCompared) {
  Study s = study(6, "[0.1, 10]");
  s.file = parse_study(
      "[study]\ntrials = 6\n[map]\nspacing_m = 4\n[sweep]\n"
      "\"sources.calibration\" = [0.1, 10]\n\"study.protocol\" = [\"near_path\", \"path\"]\n",
      "s.toml");
  const StudyResults results = run(s, "protocols", 2);
  ASSERT_EQ(results.cells.size(), 4u);
  EXPECT_FALSE(share_queries(results.cells[0], results.cells[1]));
  EXPECT_TRUE(share_queries(results.cells[0], results.cells[2]));
  EXPECT_THROW(compare(results.cells[0], results.cells[1]), Error);
  const std::vector<std::pair<std::size_t, std::size_t>> expected{{0, 2}, {1, 3}};
  EXPECT_EQ(comparable_pairs(results.cells), expected);

  s.file = parse_study(
      "[study]\ntrials = 2\n[map]\nspacing_m = 4\n[sweep]\n\"study.seed\" = [1, 2]\n", "s.toml");
  EXPECT_TRUE(comparable_pairs(run(s, "seeds", 2).cells).empty());
}

TEST(Comparison, CountsMapsAndNotTrials) {
  // all of four maps in favour of a, all of two in favour of b: 80 trials against 40
  std::vector<TrialResult> in_a = right_trials(120), in_b = in_a;
  for (std::size_t i = 0; i < 120; ++i) {
    (i < 80 ? in_b : in_a)[i].status = LocalisationStatus::no_match;
  }
  const PairedComparison c = compare(cell_of(in_a, 20), cell_of(in_b, 20));
  EXPECT_EQ(c.only_a, 80);
  EXPECT_EQ(c.maps, 6);
  EXPECT_LT(c.mcnemar_p, 1e-3);
  EXPECT_GT(c.p_value, 0.3);
  // the same trials on fewer maps have no p-value
  const PairedComparison few = compare(cell_of(in_a, 40), cell_of(in_b, 40));
  EXPECT_TRUE(std::isnan(few.p_value));
  EXPECT_TRUE(std::isnan(few.mcnemar_p));
  EXPECT_EQ(few.only_a, 80);
}

// Cells that were stopped at other blocks are compared on those that both have.
TEST(Comparison, TakesTheBlocksThatBothHave) {
  std::vector<TrialResult> trials = right_trials(120);
  const CellResult all = cell_of(trials, 10);
  for (TrialResult& trial : trials) trial.status = LocalisationStatus::no_match;
  trials.resize(70);
  const CellResult first = cell_of(trials, 10);
  EXPECT_TRUE(share_queries(all, first));
  EXPECT_EQ(compare(all, first).only_a, 70);
  EXPECT_EQ(compare(first, all).only_b, 70);
  EXPECT_EQ(compare(all, first).maps, 7);
  trials[33].truth.x_m += 1e-12;
  EXPECT_FALSE(share_queries(all, cell_of(trials, 10)));
  EXPECT_FALSE(share_queries(all, CellResult{}));
}

TEST(McNemar, IsTheExactBinomialTail) {
  std::vector<TrialResult> in_a(10), in_b;
  for (std::uint32_t i = 0; i < 10; ++i) {
    in_a[i].trial = i;
    in_a[i].status = LocalisationStatus::answered;
    in_a[i].error = 0.1;
    in_b.push_back(in_a[i]);
    if (i >= 2) in_b[i].error = 3;
  }
  const PairedComparison c = compare(cell_of(in_a, 1), cell_of(in_b, 1));
  EXPECT_EQ(c.only_a, 8);
  EXPECT_EQ(c.only_b, 0);
  EXPECT_NEAR(c.mcnemar_p, 2.0 / 256, 1e-12);
}

}  // namespace
}  // namespace vernier
