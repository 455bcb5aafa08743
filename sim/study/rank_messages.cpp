// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/rank_messages.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "calib/base/json_whole.h"
#include "calib/error.h"
#include "sim/study/ceiling.h"
#include "sim/study/store_rows.h"
#include "sim/study/work_units.h"

namespace vernier::sim::internal {

namespace {

using RankJson = nlohmann::json;

struct RankTexts {
  RankJson operator()(const Hello& m) const { return {"hello", m.work, m.instruction_set, m.host}; }
  RankJson operator()(const Welcome& m) const { return {"welcome", m.has_blocks}; }
  RankJson operator()(const Ready& m) const { return {"ready", m.threads}; }
  RankJson operator()(const Assigned& m) const {
    return {"assigned", m.number, m.unit.block, m.unit.ceiling, m.unit.queries};
  }
  RankJson operator()(const Computed& m) const {
    const BlockRow& row = m.result.row;
    RankJson ceilings = RankJson::array();
    for (const auto& [query, found] : m.result.ceilings) {
      ceilings.push_back({query, found.right, found.unaliased});
    }
    return {"computed", m.number, row.cell, row.block, row.counted, std::move(ceilings)};
  }
  RankJson operator()(const Failed& m) const {
    return {"failed", m.place, m.fault, m.remedy, m.internal};
  }
  RankJson operator()(const Left&) const { return RankJson::array({"left"}); }
  RankJson operator()(const End&) const { return RankJson::array({"end"}); }
};

[[noreturn]] void throw_unreadable() {
  throw Error("a message between ranks", "cannot be read", "run the same build everywhere");
}

template <typename Whole>
Whole whole(const RankJson& json) {
  const auto number = vernier::internal::json_whole<Whole>(json);
  if (!number) throw_unreadable();
  return *number;
}

std::vector<int> whole_numbers(const RankJson& json) {
  if (!json.is_array()) throw_unreadable();  // of other values a loop has one turn, or none
  std::vector<int> numbers;
  for (const RankJson& number : json) numbers.push_back(whole<int>(number));
  return numbers;
}

std::array<int, 3> counts(const RankJson& json) {
  return {whole<int>(json.at(0)), whole<int>(json.at(1)), whole<int>(json.at(2))};
}

RankMessage parsed(const RankJson& json, const std::string& tail) {
  const auto kind = json.at(0).get<std::string>();
  if (kind == "hello") return Hello{json.at(1), json.at(2), json.at(3)};
  if (kind == "welcome") return Welcome{json.at(1).get<bool>()};
  if (kind == "ready") return Ready{whole<int>(json.at(1))};
  if (kind == "assigned") {
    return Assigned{whole<std::int64_t>(json.at(1)),
                    {whole<int>(json.at(2)), whole<int>(json.at(3)), whole_numbers(json.at(4))}};
  }
  if (kind == "computed") {
    UnitResult result{{json.at(2), whole<int>(json.at(3)), counts(json.at(4)), tail}, {}};
    for (const RankJson& of_query : json.at(5)) {
      result.ceilings.emplace_back(
          whole<int>(of_query.at(0)),
          QueryCeiling{of_query.at(1).get<double>(), of_query.at(2).get<bool>()});
    }
    return Computed{whole<std::int64_t>(json.at(1)), std::move(result)};
  }
  if (kind == "failed") {
    return Failed{json.at(1), json.at(2), json.at(3), json.at(4).get<bool>()};
  }
  if (kind == "left") return Left{};
  if (kind == "end") return End{};
  throw Error("a message between ranks", "is not known", "run the same build everywhere");
}

}  // namespace

std::string rank_text(const RankMessage& message) {
  // a place may be a file name with invalid UTF-8
  std::string text =
      std::visit(RankTexts{}, message).dump(-1, ' ', false, RankJson::error_handler_t::replace);
  if (const auto* computed = std::get_if<Computed>(&message)) {
    text += '\n' + computed->result.row.results;  // long, so that it is not parsed twice
  }
  return text;
}

RankMessage parse_rank_text(const std::string& text) {
  const std::size_t head = std::min(text.find('\n'), text.size());
  try {
    return parsed(RankJson::parse(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(head)),
                  text.substr(std::min(head + 1, text.size())));
  } catch (const RankJson::exception&) {
    throw_unreadable();
  }
}

Failed current_failure() {
  try {
    throw;
  } catch (const Error& error) {
    return {error.place(), error.fault(), error.remedy(), false};
  } catch (const std::exception& error) {
    return {"", error.what(), "", true};
  } catch (...) {
    return {"", "an unknown exception", "", true};
  }
}

}  // namespace vernier::sim::internal
