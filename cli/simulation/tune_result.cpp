// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/tune_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>

#include "calib/interval.h"
#include "cli/program/session.h"
#include "cli/program/text_table.h"
#include "cli/simulation/study_folder.h"
#include "sim/tuning/confirmation.h"
#include "sim/tuning/objective.h"
#include "sim/tuning/race_search.h"
#include "sim/tuning/tune_settings.h"

namespace vernier::cli {
namespace {

const Candidate& candidate_of(const TuneResult& result, int number) {
  return result.candidates[static_cast<std::size_t>(number)];
}

Json optional_interval(const std::optional<Interval>& interval) {
  return interval ? Json{interval->low, interval->high} : Json();
}

Json tuned_settings(const Candidate& candidate) {
  Json json = Json::object();
  for (const auto& [key, value] : candidate.values) json[key] = setting_json(value);
  return json;
}

Json figures_json(const CandidateFigures& f) {
  return {{"trials", f.trials},
          {"maps", f.maps},
          {"worlds", f.worlds},
          {"score", f.score},
          {"success", f.success},
          {"success_interval_95", optional_interval(f.success_interval_95)},
          {"interval_over", f.over_worlds ? "worlds" : "maps"},
          {"cpu_ms_mean", f.trials > 0 ? Json(1000 * f.cpu_s / f.trials) : Json()}};
}

Json confirmed_json(const TuneResult& result, const ConfirmedCandidate& one) {
  return {{"candidate", one.candidate + 1},
          {"settings", tuned_settings(candidate_of(result, one.candidate))},
          {"folder", confirmation_folder(one.candidate)},
          {"searched", figures_json(result.searched[static_cast<std::size_t>(one.candidate)])},
          {"confirmed", figures_json(one.figures)}};
}

std::string two_digit_percent(double share) { return fmt::format("{:.2f}", 100 * share); }

std::string interval_in_percent(const std::optional<Interval>& interval) {
  return interval ? fmt::format(" [{:.2f}, {:.2f}]", 100 * interval->low, 100 * interval->high)
                  : std::string(" (too few maps for an interval)");
}

/// The candidates from best to worst, up to 20.
std::string candidates_table(const TuneResult& result) {
  constexpr std::size_t most = 20;
  const std::size_t shown = std::min(most, result.order.size());
  const bool has_other_score = result.settings.objective != Objective::success;
  std::vector<TextColumn> columns{{"candidate", {}, true}};
  for (const auto& [key, value] : result.candidates[0].values) columns.push_back({key, {}, true});
  const std::size_t keys = columns.size();
  for (const char* head : {"trials", "success %", "fate"}) columns.push_back({head, {}});
  if (has_other_score)
    columns.push_back({fmt::format("{} %", name(result.settings.objective)), {}});
  for (std::size_t i = 0; i < shown; ++i) {
    const auto number = static_cast<std::size_t>(result.order[i]);
    const CandidateFigures& f = result.searched[number];
    columns[0].cells.push_back(fmt::format("{}", number + 1));
    for (std::size_t k = 1; k < keys; ++k) {
      columns[k].cells.push_back(result.candidates[number].values[k - 1].second);
    }
    columns[keys].cells.push_back(fmt::format("{}", f.trials));
    columns[keys + 1].cells.push_back(two_digit_percent(f.success));
    columns[keys + 2].cells.emplace_back(name(result.race.racers[number].fate));
    if (has_other_score) columns[keys + 3].cells.push_back(two_digit_percent(f.score));
  }
  std::string text = text_table(std::move(columns));
  if (shown < result.order.size()) {
    text += fmt::format("and {} more, in tune.json\n", result.order.size() - shown);
  }
  return text;
}

std::string figures_text(const TuneResult& result, const CandidateFigures& f) {
  std::string text = fmt::format("success {} %{}, {} trials", two_digit_percent(f.success),
                                 interval_in_percent(f.success_interval_95), f.trials);
  if (result.settings.objective != Objective::success) {
    text += fmt::format(", {} {} %", name(result.settings.objective), two_digit_percent(f.score));
  }
  return text;
}

std::string confirmed_text(const TuneResult& result,
                           const char* what,
                           const ConfirmedCandidate& one) {
  return fmt::format("{} {}: {}\n  searched: {}\n  not searched: {}\n", what, one.candidate + 1,
                     candidate_of(result, one.candidate).label,
                     figures_text(result, result.searched[static_cast<std::size_t>(one.candidate)]),
                     figures_text(result, one.figures));
}

std::string difference_text(const TuneResult& result) {
  const ConfirmedDifference& d = result.difference;
  std::string text =
      fmt::format("difference where not searched: {:+.2f} points", 100 * d.difference);
  if (d.interval_95) {
    text += fmt::format(" [{:+.2f}, {:+.2f}], p {:.2g}", 100 * d.interval_95->low,
                        100 * d.interval_95->high, *d.p_value);
    if (d.interval_95->low < 0 && d.interval_95->high > 0) text += ": not distinguished";
  }
  return text + "\n";
}

/// The first names of a list.
std::string first_of(const std::vector<std::string>& names) {
  constexpr std::size_t most = 3;
  const std::size_t shown = std::min(most, names.size());
  const std::string text = fmt::format(
      "{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  return shown < names.size() ? fmt::format("{} and {} more", text, names.size() - shown) : text;
}

std::string shortfall_text(const TuneResult& result) {
  const double confidence = 100 * (1 - result.settings.race.error_rate);
  if (result.shortfall_limit >= 1) {
    return "too few rounds to say how much better another may be where searched\n";
  }
  return fmt::format(
      "none is better than the winner by more than {:.1f} points where searched ({:g} %)\n",
      100 * result.shortfall_limit, confidence);
}

std::string cost_text(const TuneResult& result) {
  const RaceCost& cost = result.cost;
  const int confirmed = result.winner.figures.trials + result.reference.figures.trials;
  return fmt::format(
      "cost: {} trials of the {} of a full grid ({:.0f} %); CPU of localising {:.1f} s of "
      "about {:.1f};\n"
      "  confirmation {} trials, {:.1f} s\n",
      cost.trials, cost.grid_trials,
      100 * static_cast<double>(cost.trials) / static_cast<double>(cost.grid_trials), cost.cpu_s,
      cost.grid_cpu_s, confirmed, result.winner.figures.cpu_s + result.reference.figures.cpu_s);
}

}  // namespace

std::string confirmation_folder(int candidate) { return fmt::format("confirm-{}", candidate + 1); }

Json tune_json(const TuneResult& result) {
  const TuneSettings& s = result.settings;
  Json candidates = Json::array();
  for (const int number : result.order) {
    const auto i = static_cast<std::size_t>(number);
    Json one{{"candidate", number + 1},
             {"settings", tuned_settings(result.candidates[i])},
             {"fate", name(result.race.racers[i].fate)},
             {"rounds", result.race.racers[i].rounds}};
    one.update(figures_json(result.searched[i]));
    candidates.push_back(std::move(one));
  }
  const ConfirmedDifference& d = result.difference;
  const RaceCost& cost = result.cost;
  return {{"format", "vernier/tune"},
          {"version", 1},
          {"objective", name(s.objective)},
          {"indifference", s.race.indifference},
          {"error_rate", s.race.error_rate},
          {"conditions", s.conditions},
          {"searched", {{"worlds", result.worlds}, {"seeds", result.seeds}}},
          {"confirmed",
           {{"worlds", s.confirm_worlds}, {"seed", s.confirm_seed}, {"trials", s.confirm_trials}}},
          {"winner", confirmed_json(result, result.winner)},
          {"reference", confirmed_json(result, result.reference)},
          {"confirmed_difference", d.difference},
          {"confirmed_difference_interval_95", optional_interval(d.interval_95)},
          {"confirmed_difference_p", d.p_value ? Json(*d.p_value) : Json()},
          {"none_better_by_more_than", result.shortfall_limit},
          {"rounds", result.rounds},
          {"trials", cost.trials},
          {"grid_trials", cost.grid_trials},
          {"cpu_ms", 1000 * cost.cpu_s},
          {"grid_cpu_ms", 1000 * cost.grid_cpu_s},
          {"confirm_trials", result.winner.figures.trials + result.reference.figures.trials},
          {"confirm_cpu_ms", 1000 * (result.winner.figures.cpu_s + result.reference.figures.cpu_s)},
          {"candidates", candidates}};
}

std::string tune_text(const TuneResult& result) {
  return candidates_table(result) + "\n" + confirmed_text(result, "winner", result.winner) +
         confirmed_text(result, "reference", result.reference) + difference_text(result) +
         shortfall_text(result) + cost_text(result) +
         fmt::format(
             "searched: {}\nnot searched: {}, seed {}\n"
             "the winner of a search looks better where it was searched than it is\n",
             first_of(result.worlds), first_of(result.settings.confirm_worlds),
             result.settings.confirm_seed);
}

std::string doubt_of(const TuneResult& result) {
  const ConfirmedDifference& d = result.difference;
  if (!d.p_value && result.winner.candidate != result.reference.candidate) {
    return "too few maps where it was not searched to tell the winner from others: give at least 6 "
           "confirm_trials";
  }
  if (!d.p_value || *d.p_value > 0.05 || d.difference >= 0) return {};
  return fmt::format(
      "the winner of the search is worse than candidate {} where it was not searched, by {:.2f} "
      "points (p {:.2g})",
      result.reference.candidate + 1, -100 * d.difference, *d.p_value);
}

}  // namespace vernier::cli
