// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study_ranks.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <iterator>
#include <map>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "calib/base/instruction_set.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "sim/study/communicator.h"
#include "sim/study/grace.h"
#include "sim/study/host_name.h"
#include "sim/study/instruction_sets.h"
#include "sim/study/rank_messages.h"
#include "sim/study/result_recorder.h"
#include "sim/study/stored_results.h"
#include "sim/study/study.h"
#include "sim/study/study_work.h"
#include "sim/study/work_units.h"
#include "sim/study/worker_threads.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

using std::chrono::microseconds;

/// How long a rank without news sleeps before it looks again: MPI's own waiting would keep a core
/// busy. Doubled each time, so that an answer comes soon while much happens; units at hand bridge
/// the longest sleep.
class Patience {
 public:
  microseconds next(bool had_news) {
    wait_ = had_news ? shortest : std::min(2 * wait_, longest);
    return wait_;
  }

 private:
  static constexpr microseconds shortest{20}, longest{10'000};
  microseconds wait_ = shortest;
};

Message wait_for_message(Communicator& ranks) {
  Patience patience;
  for (;;) {
    if (std::optional<Message> message = ranks.receive()) return *std::move(message);
    std::this_thread::sleep_for(patience.next(false));
  }
}

[[noreturn]] void fail_unexpected(const std::string& who) {
  throw std::logic_error(who + " sent a message out of turn");
}

/// What a rank told of its failure, as an exception here.
std::exception_ptr failure_of(const Failed& failed, const std::string& who) {
  if (failed.internal) {
    return std::make_exception_ptr(std::runtime_error(who + ": " + failed.fault));
  }
  return std::make_exception_ptr(Error(who + ": " + failed.place, failed.fault, failed.remedy));
}

}  // namespace

/// Units of one call of compute().
struct RankZero::Phase {
  struct Running {
    int rank;
    WorkUnit unit;
  };
  std::deque<WorkUnit> waiting;
  std::map<std::int64_t, Running> running;
  std::vector<std::pair<WorkUnit, UnitResult>> done;  // not yet recorded

  void finish(std::int64_t number, UnitResult result) {
    auto node = running.extract(number);
    if (!node.empty()) done.emplace_back(std::move(node.mapped().unit), std::move(result));
  }
};

RankZero::RankZero(Communicator& ranks, const StudyWork& work, std::stop_token stop)
    : ranks_(ranks), stop_(std::move(stop)), fingerprint_(work_fingerprint(work)) {}

std::string RankZero::who(int rank) const {
  const auto known = others_.find(rank);
  return known == others_.end() || known->second.host.empty()
             ? fmt::format("rank {}", rank)
             : fmt::format("rank {} on {}", rank, shortened(known->second.host));
}

std::string RankZero::meet(OtherInstructionSets others) {
  const std::string here(instruction_set());
  std::string all = here;
  while (static_cast<int>(others_.size()) < ranks_.size() - 1) {
    const Message message = wait_for_message(ranks_);
    const RankMessage said = parse_rank_text(message.text);
    if (const auto* failed = std::get_if<Failed>(&said)) {
      std::rethrow_exception(failure_of(*failed, who(message.from)));
    }
    const auto* hello = std::get_if<Hello>(&said);
    if (!hello) fail_unexpected(who(message.from));
    others_[message.from].host = hello->host;
    if (hello->work != fingerprint_) {
      throw Error(who(message.from), "has read another study, world or rig than rank 0",
                  "give all ranks the same files and the same program");
    }
    all = all_instruction_sets(all, hello->instruction_set);
    if (is_mixture(all) && others == OtherInstructionSets::refused) {
      throw Error(who(message.from),
                  fmt::format("has the instruction set {}, rank 0 has {}: results would not be "
                              "identical",
                              shortened(hello->instruction_set), here),
                  "use machines of one kind, or give --allow-other-instruction-set");
    }
  }
  return all;
}

void RankZero::welcome(bool has_blocks) {
  for (const auto& [rank, other] : others_) ranks_.send(rank, rank_text(Welcome{has_blocks}));
}

void RankZero::note_failure(std::exception_ptr failure) {
  if (!failure_) failure_ = std::move(failure);
}

void RankZero::take(const Message& message, Phase& phase) {
  RankMessage said = parse_rank_text(message.text);
  Rank& rank = others_.at(message.from);
  if (const auto* ready = std::get_if<Ready>(&said)) {
    rank.threads = ready->threads;
  } else if (auto* computed = std::get_if<Computed>(&said)) {
    --rank.given;
    phase.finish(computed->number, std::move(computed->result));
  } else if (const auto* failed = std::get_if<Failed>(&said)) {
    note_failure(failure_of(*failed, who(message.from)));
    std::erase_if(phase.running, [&](const auto& one) { return one.second.rank == message.from; });
    rank.threads = 0;
  } else if (std::holds_alternative<Left>(said)) {
    for (auto& [number, one] : phase.running) {
      if (one.rank == message.from) phase.waiting.push_front(std::move(one.unit));
    }
    std::erase_if(phase.running, [&](const auto& one) { return one.second.rank == message.from; });
    others_.erase(message.from);
  } else {
    fail_unexpected(who(message.from));
  }
}

void RankZero::take_own(WorkerThreads& own, Phase& phase, microseconds patience) {
  for (FinishedUnit& unit : own.take_finished(patience)) {
    if (unit.failure) {
      note_failure(unit.failure);
      phase.running.erase(unit.number);
    } else {
      phase.finish(unit.number, std::move(unit.result));
    }
  }
}

int RankZero::all_threads(const WorkerThreads& own) const {
  int all = own.threads();
  for (const auto& [rank, other] : others_) all += other.threads;
  return all;
}

void RankZero::hand_out(Phase& phase, WorkerThreads& own) {
  if (failure_ || stop_.stop_requested()) return;
  const auto give = [&](int rank, auto start) {
    const std::int64_t number = next_number_++;
    auto& given = phase.running[number];
    given = {rank, std::move(phase.waiting.front())};
    phase.waiting.pop_front();
    start(number, given.unit);
  };
  while (!phase.waiting.empty() && own.unfinished() < own.threads()) {
    give(0, [&](std::int64_t number, const WorkUnit& unit) { own.start(number, unit); });
  }
  // Towards the end a unit at hand would wait while threads elsewhere have none.
  const std::size_t many = 2 * static_cast<std::size_t>(all_threads(own));
  for (auto& [rank, other] : others_) {
    const auto has_room = [&, &other = other] {
      const int at_hand = phase.waiting.size() >= many ? other.threads : 0;
      return !phase.waiting.empty() && other.given < other.threads + at_hand;
    };
    while (has_room()) {
      ++other.given;
      give(rank, [&, to = rank](std::int64_t number, const WorkUnit& unit) {
        ranks_.send(to, rank_text(Assigned{number, unit}));
      });
    }
  }
}

void RankZero::compute(std::vector<WorkUnit> units, WorkerThreads& own, ResultRecorder& recorder) {
  constexpr std::size_t most_at_once = 64;  // results committed together
  Phase phase;
  phase.waiting.assign(std::make_move_iterator(units.begin()),
                       std::make_move_iterator(units.end()));
  Patience patience;
  Grace grace;
  bool had_news = true;
  for (;;) {
    hand_out(phase, own);
    const bool may_end = phase.waiting.empty() || failure_ || stop_.stop_requested();
    if ((may_end && phase.running.empty()) || grace.is_over(stop_.stop_requested())) break;
    take_own(own, phase, patience.next(had_news));
    std::optional<Message> message;
    while (phase.done.size() < most_at_once && (message = ranks_.receive())) take(*message, phase);
    had_news = !phase.done.empty();
    recorder.add(std::exchange(phase.done, {}));
  }
  recorder.flush();
  if (failure_) std::rethrow_exception(failure_);
}

void end_ranks(Communicator& ranks) noexcept {
  for (int rank = 1; rank < ranks.size(); ++rank) {
    try {
      ranks.send(rank, rank_text(End{}));
    } catch (...) {
    }
  }
}

namespace {

void wait_for_end(Communicator& ranks) {
  while (!std::holds_alternative<End>(parse_rank_text(wait_for_message(ranks).text))) {
  }
}

/// The loop of a rank that computes: units in, results out.
void serve_units(WorkerThreads& own, Communicator& ranks, const std::stop_token& stop) {
  Patience patience;
  Grace grace;
  bool had_news = true;
  for (;;) {
    std::vector<FinishedUnit> finished = own.take_finished(patience.next(had_news));
    had_news = !finished.empty();
    for (FinishedUnit& unit : finished) {
      if (unit.failure) std::rethrow_exception(unit.failure);
      ranks.send(0, rank_text(Computed{unit.number, std::move(unit.result)}));
    }
    while (const std::optional<Message> message = ranks.receive()) {
      had_news = true;
      const RankMessage said = parse_rank_text(message->text);
      if (std::holds_alternative<End>(said)) return;
      const auto* assigned = std::get_if<Assigned>(&said);
      if (!assigned) fail_unexpected("rank 0");
      if (!stop.stop_requested()) own.start(assigned->number, assigned->unit);
    }
    if (stop.stop_requested()) own.drop_waiting();
    if (grace.is_over(stop.stop_requested()) || (stop.stop_requested() && own.unfinished() == 0)) {
      ranks.send(0, rank_text(Left{}));
      wait_for_end(ranks);
      return;
    }
  }
}

/// Everything between Hello and End.
void take_part(const Study& study, int threads, Communicator& ranks, const std::stop_token& stop) {
  const StudyWork work = study_work(study);
  ranks.send(0,
             rank_text(Hello{work_fingerprint(work), std::string(instruction_set()), host_name()}));
  const RankMessage answer = parse_rank_text(wait_for_message(ranks).text);
  if (std::holds_alternative<End>(answer)) return;
  const auto* welcome = std::get_if<Welcome>(&answer);
  if (!welcome) fail_unexpected("rank 0");
  UnitComputer computer(study, work, stop);
  if (welcome->has_blocks) computer.prepare_maps();
  WorkerThreads own(computer, threads, stop);
  ranks.send(0, rank_text(Ready{own.threads()}));
  serve_units(own, ranks, stop);
}

}  // namespace

void tell_failure(const Failed& failure, Communicator& ranks) {
  ranks.send(0, rank_text(failure));
  wait_for_end(ranks);
}

void serve_study(const Study& study,
                 int threads,
                 Communicator& ranks,
                 const std::stop_token& stop) {
  std::optional<Failed> failure;
  try {
    take_part(study, threads, ranks, stop);
  } catch (...) {
    failure = current_failure();
  }
  if (failure) tell_failure(*failure, ranks);
}

}  // namespace vernier::sim::internal
