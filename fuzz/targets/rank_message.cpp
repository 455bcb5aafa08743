// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/rank_messages.h"

#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_target.h"
#include "sim/experiment.h"
#include "sim/study/store_rows.h"

namespace vernier::fuzz {
namespace {

using namespace sim::internal;

/// What ranks of a study tell each other.
void run_rank_message(std::string_view bytes) {
  const auto message = accepted([&] { return parse_rank_text(std::string(bytes)); });
  if (!message) return;
  const std::string written = rank_text(*message);
  require(rank_text(parse_rank_text(written)) == written, "what is written is read as the same");
}

std::vector<std::string> rank_message_seeds() {
  sim::TrialResult trial;
  trial.trial = 7;
  Computed block{3, {}}, queries{4, {}};
  block.result.row = block_row("a cell", 1, {trial});
  queries.result.ceilings = {{5, {}}};
  std::vector<std::string> seeds;
  for (const RankMessage& message : std::vector<RankMessage>{
           Hello{"a0b1", "AVX2", "host"}, Welcome{false}, Ready{2}, Assigned{1, {.block = 2}},
           Assigned{2, {.ceiling = 0, .queries = {1, 2}}}, block, queries,
           Failed{"file:3", "is bad", "mend it"}, Left{}, End{}}) {
    seeds.push_back(rank_text(message));
  }
  return seeds;
}

const Registered registered_rank_message{
    {"rank_message", 2000, "json", run_rank_message, rank_message_seeds}};

}  // namespace
}  // namespace vernier::fuzz
