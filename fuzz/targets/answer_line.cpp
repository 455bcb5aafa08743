// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/answering_program.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

using vernier::internal::numbered_answer;
using vernier::internal::says_ready;
using Json = nlohmann::ordered_json;

constexpr std::uint64_t asked = 12;

/// What every program that answers questions says, before its reader sees it.
void run_answer_line(std::string_view bytes) {
  says_ready(bytes);
  const auto answer = accepted([&] { return numbered_answer(bytes, asked); });
  if (!answer) return;
  require(answer->is_object() && !answer->contains("question"), "an answer has lost its number");
  for (const std::uint64_t other : {asked - 1, asked + 1}) {
    require(!accepted([&] { return numbered_answer(bytes, other); }),
            "an answer is that to one question");
  }
  Json again = *answer;
  again["question"] = asked;
  require(numbered_answer(again.dump(), asked) == *answer, "what is written is read as the same");
}

/// A line as the documents have it, with its number.
std::string numbered(Json answer, std::uint64_t number) {
  answer["question"] = number;
  return answer.dump();
}

std::vector<std::string> answer_line_seeds() {
  const Json drive{{"speed_mps", 0.3}, {"turn_radps", 0.1}, {"duration_s", 0.5}};
  return {Json{{"ready", true}}.dump(),
          numbered(drive, asked),
          numbered({{"answered", false}, {"error", nullptr}}, asked),
          numbered({{"edges", {{{"id", 0}, {"left_px", {100, 50, 100, 250}}}}}}, asked),
          numbered(drive, asked - 1),
          numbered(Json::object(), asked)};
}

const Registered registered_answer_line{
    {"answer_line", 500, "answers", run_answer_line, answer_line_seeds}};

}  // namespace
}  // namespace vernier::fuzz
