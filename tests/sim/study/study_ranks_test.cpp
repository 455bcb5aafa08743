// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study_ranks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "calib/base/instruction_set.h"
#include "calib/error.h"
#include "sim/study/communicator.h"
#include "sim/study/instruction_sets.h"
#include "sim/study/rank_messages.h"
#include "sim/study/store_rows.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_work.h"
#include "sim/study/work_units.h"
#include "tests/sim/study/stored_example.h"
#include "tests/support/example_study.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

/// Mail boxes of the ranks of a test, which are threads of one process.
struct Boxes {
  explicit Boxes(int size) : waiting(static_cast<std::size_t>(size)) {}
  std::mutex mutex;
  std::vector<std::deque<Message>> waiting;
};

class ThreadRank : public Communicator {
 public:
  ThreadRank(Boxes& boxes, int rank) : boxes_(boxes), rank_(rank) {}
  int rank() const override { return rank_; }
  int size() const override { return static_cast<int>(boxes_.waiting.size()); }
  void send(int to, const std::string& text) override {
    const std::lock_guard lock(boxes_.mutex);
    boxes_.waiting[static_cast<std::size_t>(to)].push_back({rank_, text});
  }
  std::optional<Message> receive() override {
    const std::lock_guard lock(boxes_.mutex);
    auto& box = boxes_.waiting[static_cast<std::size_t>(rank_)];
    if (box.empty()) return std::nullopt;
    Message message = std::move(box.front());
    box.pop_front();
    return message;
  }

 private:
  Boxes& boxes_;
  int rank_;
};

Study example_study(int trials = 24) { return test::example_study(trials); }

class StudyRanks : public testing::Test {
 protected:
  /// What each rank above 0 does.
  using Other = std::function<void(int rank, Communicator& ranks)>;

  static Other serving(int threads = 1) {
    return [=](int, Communicator& ranks) { serve_study(example_study(), threads, ranks, {}); };
  }

  /// Runs the study on so many ranks; the message of the Error of rank 0, or "".
  std::string run(const std::string& name, int size, const Other& other, StudyRun job = {}) {
    Boxes boxes(size);
    std::vector<std::unique_ptr<ThreadRank>> ranks;
    std::vector<std::thread> threads;
    for (int i = 0; i < size; ++i) ranks.push_back(std::make_unique<ThreadRank>(boxes, i));
    for (int i = 1; i < size; ++i) {
      threads.emplace_back([&, i] { other(i, *ranks[static_cast<std::size_t>(i)]); });
    }
    job.folder = folder_ / name;
    job.ranks = ranks[0].get();
    if (job.threads == 0) job.threads = 1;
    std::string said;
    try {
      run_study(example_study(), job);
    } catch (const Error& error) {
      said = error.what();
    }
    end_ranks(*ranks[0]);
    for (std::thread& thread : threads) thread.join();
    return said;
  }

  /// Everything but the timings.
  std::string words(const std::string& name) const {
    const StudyResults results = study_results(example_study(), folder_ / name);
    EXPECT_EQ(results.blocks_done, results.blocks_total);
    std::string text;
    for (const CellResult& cell : results.cells) {
      text += std::to_string(cell.ceiling ? cell.ceiling->success : -1) + "\n";
      for (TrialResult trial : cell.trials) {
        trial.cpu_ms = trial.wall_ms = 0;
        text += trials_text({trial}) + "\n";
      }
    }
    return text;
  }

  std::string whole() {
    run_study(example_study(), {.folder = folder_ / "whole", .threads = 2});
    return words("whole");
  }

  test::TestFolder folder_{"study_ranks"};
};

TEST_F(StudyRanks, GiveTheSameBitsAsOneProcess) {
  const std::string one = whole();
  EXPECT_EQ(run("two", 2, serving()), "");
  EXPECT_EQ(words("two"), one);
  EXPECT_EQ(run("five", 5, serving(2), {.threads = 2}), "");
  EXPECT_EQ(words("five"), one);
}

TEST_F(StudyRanks, AllTakePart) {
  std::mutex mutex;
  std::set<int> computed;
  const auto other = [&](int rank, Communicator& ranks) {
    struct Counting : Communicator {
      explicit Counting(Communicator& ranks) : inner(ranks) {}
      int rank() const override { return inner.rank(); }
      int size() const override { return inner.size(); }
      void send(int to, const std::string& text) override {
        results += std::holds_alternative<Computed>(parse_rank_text(text));
        inner.send(to, text);
      }
      std::optional<Message> receive() override { return inner.receive(); }
      Communicator& inner;
      int results = 0;
    } counting(ranks);
    serve_study(example_study(), 1, counting, {});
    const std::lock_guard lock(mutex);
    if (counting.results > 0) computed.insert(rank);
  };
  EXPECT_EQ(run("all", 3, other), "");
  EXPECT_EQ(computed, (std::set<int>{1, 2}));
}

TEST_F(StudyRanks, AUnitIsAtHandWhileManyWait) {
  const Study study = test::example_study(200);
  Boxes boxes(2);
  ThreadRank zero(boxes, 0), one(boxes, 1);
  int most = 0;
  // computes nothing before two units are there
  std::thread other([&] {
    const StudyWork work = study_work(study);
    UnitComputer computer(study, work);
    computer.prepare_maps();
    const std::string set(instruction_set());
    one.send(0, rank_text(Hello{work_fingerprint(work), set, "node7"}));
    std::deque<Assigned> given;
    int answers = 0;
    while (true) {
      if (const std::optional<Message> message = one.receive()) {
        const RankMessage said = parse_rank_text(message->text);
        if (std::holds_alternative<End>(said)) return;
        if (std::holds_alternative<Welcome>(said)) one.send(0, rank_text(Ready{1}));
        if (const auto* assigned = std::get_if<Assigned>(&said)) given.push_back(*assigned);
        most = std::max(most, static_cast<int>(given.size()));
      } else if (given.size() >= (answers == 0 ? 2 : 1)) {
        const Assigned next = given.front();
        given.pop_front();
        one.send(0, rank_text(Computed{next.number, computer.compute(next.unit, {})}));
        ++answers;
      } else {
        std::this_thread::yield();
      }
    }
  });
  StudyRun job{.folder = folder_ / "at_hand", .threads = 1};
  job.ranks = &zero;
  run_study(study, job);
  end_ranks(zero);
  other.join();
  EXPECT_EQ(most, 2);
}

TEST_F(StudyRanks, NothingMissingIsNothingToDo) {
  const std::string one = whole();
  EXPECT_EQ(run("whole", 3, serving()), "");
  EXPECT_EQ(words("whole"), one);
}

TEST_F(StudyRanks, AnotherStudyIsRefusedBeforeAnythingIsWritten) {
  const auto other = [](int rank, Communicator& ranks) {
    serve_study(example_study(rank == 2 ? 25 : 24), 1, ranks, {});
  };
  const std::string said = run("refused", 4, other);
  EXPECT_NE(said.find("rank 2 on "), std::string::npos) << said;
  EXPECT_NE(said.find("has read another study, world or rig"), std::string::npos) << said;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "refused"));
}

TEST_F(StudyRanks, AnErrorOfOneEndsAll) {
  const auto other = [](int rank, Communicator& ranks) {
    Study study = example_study();
    if (rank == 1) study.world.route.clear();
    serve_study(study, 1, ranks, {});
  };
  const std::string said = run("failed", 3, other);
  EXPECT_EQ(said.rfind("rank 1 on ", 0), 0u) << said;
  EXPECT_NE(said.find("route"), std::string::npos) << said;
  const std::string one = whole();
  EXPECT_EQ(run("failed", 3, serving()), "");
  EXPECT_EQ(words("failed"), one);
}

TEST_F(StudyRanks, OneThatCannotStartIsNamed) {
  const auto other = [](int rank, Communicator& ranks) {
    if (rank == 1)
      return tell_failure({"s.toml", "cannot be read", "check the name", false}, ranks);
    serve_study(example_study(), 1, ranks, {});
  };
  EXPECT_EQ(run("none", 3, other), "rank 1: s.toml: cannot be read; check the name");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none"));
}

TEST_F(StudyRanks, OneThatLeavesLosesNothing) {
  std::stop_source stop;
  const auto other = [&](int rank, Communicator& ranks) {
    serve_study(example_study(), 1, ranks, rank == 1 ? stop.get_token() : std::stop_token());
  };
  StudyRun job;
  job.progress = [&](int done, int) {
    if (done == 2) stop.request_stop();
  };
  EXPECT_EQ(run("left", 3, other, job), "");
  EXPECT_EQ(words("left"), whole());
}

TEST_F(StudyRanks, AskedToStopTheyKeepWhatIsDoneAndGoOn) {
  for (int attempt = 0; attempt < 3; ++attempt) {
    std::stop_source stop;
    StudyRun job;
    job.stop = stop.get_token();
    job.ceiling_progress = job.progress = [&](int done, int) {
      if (done >= 2) stop.request_stop();
    };
    EXPECT_EQ(run("stopped", 3, serving(), job), "");
  }
  EXPECT_EQ(run("stopped", 2, serving()), "");
  EXPECT_EQ(words("stopped"), whole());
}

TEST_F(StudyRanks, AnotherInstructionSetIsRefusedOrNoted) {
  const auto other = [](int rank, Communicator& ranks) {
    if (rank == 2) return serve_study(example_study(), 1, ranks, {});
    // a rank of another kind, which never has a thread free
    const Study study = example_study();
    ranks.send(0, rank_text(Hello{work_fingerprint(study_work(study)), "ABACUS", "node7"}));
    while (true) {
      if (const auto message = ranks.receive()) {
        if (std::holds_alternative<End>(parse_rank_text(message->text))) return;
      }
      std::this_thread::yield();
    }
  };
  const std::string said = run("refused", 3, other);
  EXPECT_NE(said.find("rank 1 on node7: has the instruction set ABACUS"), std::string::npos)
      << said;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "refused"));
  StudyRun job;
  job.other_instruction_sets = OtherInstructionSets::allowed;
  EXPECT_EQ(run("mixed", 3, other, job), "");
  EXPECT_EQ(study_results(example_study(), folder_ / "mixed").instruction_sets,
            all_instruction_sets("ABACUS", std::string(instruction_set())));
  EXPECT_EQ(words("mixed"), whole());
}

TEST(RankMessages, RoundTrip) {
  const Computed computed{
      7, {{"cell", 3, {2, 1, 0}, "[[1],[2]]"}, {{5, {1.0 / 3, false}}, {6, {1, true}}}}};
  const auto again = std::get<Computed>(parse_rank_text(rank_text(computed)));
  EXPECT_EQ(again.number, 7);
  EXPECT_EQ(again.result.row.cell, "cell");
  EXPECT_EQ(again.result.row.block, 3);
  EXPECT_EQ(again.result.row.counted, computed.result.row.counted);
  EXPECT_EQ(again.result.row.results, "[[1],[2]]");
  EXPECT_EQ(again.result.ceilings, computed.result.ceilings);
  const auto unit = std::get<Assigned>(parse_rank_text(rank_text(Assigned{9, {-1, 4, {1, 2, 3}}})));
  EXPECT_EQ(unit.number, 9);
  EXPECT_EQ(unit.unit.ceiling, 4);
  EXPECT_EQ(unit.unit.queries, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(std::get<Ready>(parse_rank_text(rank_text(Ready{12}))).threads, 12);
  EXPECT_FALSE(std::get<Welcome>(parse_rank_text(rank_text(Welcome{false}))).has_blocks);
  for (const RankMessage& bare : {RankMessage(Left{}), RankMessage(End{})}) {
    EXPECT_EQ(parse_rank_text(rank_text(bare)).index(), bare.index());
  }
  for (const char* text :
       {"", "[", "{}", "[]", "[\"ready\"]", "[\"ready\", \"many\"]", "[\"ready\", 1e300]",
        "[\"ready\", 3000000000]", "[\"ready\", 18446744073709551615]",
        "[\"assigned\", 1, 2, 0, 7]", "[\"assigned\", 1, 2, 0, null]", "[\"dance\"]"}) {
    EXPECT_THROW(parse_rank_text(text), Error) << text;
  }
}

TEST(ShardOfStore, IsWhatTheNameSays) {
  const auto text = [](const char* name) {
    const Shard shard = shard_of_store(std::string("some/folder/") + name);
    return std::to_string(shard.index) + "/" + std::to_string(shard.count);
  };
  EXPECT_EQ(text("results-2-of-4.sqlite"), "2/4");
  for (const char* other : {"results.sqlite", "results-4-of-4.sqlite", "results-01-of-4.sqlite",
                            "results-1-of-4.sqlite.bak", "results--1-of-4.sqlite", "a.sqlite"}) {
    EXPECT_EQ(text(other), "0/1") << other;
  }
}

TEST(InstructionSets, AreJoinedAndCompared) {
  EXPECT_EQ(all_instruction_sets("B, A", "C, A"), "A, B, C");
  EXPECT_EQ(all_instruction_sets("", "A"), "A");
  EXPECT_TRUE(are_compatible_sets("A", "A, B"));
  EXPECT_FALSE(are_compatible_sets("A, C", "A, B"));
  EXPECT_TRUE(is_mixture("A, B"));
  EXPECT_FALSE(is_mixture("A"));
}

}  // namespace
}  // namespace vernier
