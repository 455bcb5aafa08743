// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/localisation/localised_queries.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "calib/interval.h"
#include "calib/statistics/quantile.h"
#include "cli/localisation/figures.h"
#include "cli/program/session.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "sim/study/reliability.h"

namespace vernier::cli {
namespace {

constexpr double right_within_m = 1;

double heading_deg(const Pose2D& pose) {
  return degrees * std::remainder(pose.heading_rad, 2 * std::numbers::pi);
}

Json pose_deg_json(const Pose2D& pose) { return {pose.x_m, pose.y_m, heading_deg(pose)}; }

/// Of queries whose truth is known.
struct Success {
  int queries = 0, answered = 0, right = 0, guesses_right = 0;
  std::vector<double> errors_m, turns_deg, cpu_ms;
};

Success success_of(const std::vector<LocalisedQuery>& queries) {
  Success s;
  for (const LocalisedQuery& query : queries) {
    if (!std::isnan(query.cpu_ms)) s.cpu_ms.push_back(query.cpu_ms);
    if (!query.truth) continue;
    ++s.queries;
    const bool near = query.error_m() <= right_within_m;
    s.guesses_right += near;
    if (query.answer.status != LocalisationStatus::answered) continue;
    ++s.answered;
    s.right += near;
    s.errors_m.push_back(query.error_m());
    s.turns_deg.push_back(std::abs(query.heading_error_deg()));
  }
  return s;
}

double median(const std::vector<double>& values) {
  return values.empty() ? std::numeric_limits<double>::quiet_NaN()
                        : quantile(values, 0.5, QuantileKind::linear);
}

Json query_json(const LocalisedQuery& query) {
  const LocalisationAnswer& answer = query.answer;
  Json json{{"name", query.name},
            {"status", name(answer.status)},
            {"lines", query.lines},
            {"looks", query.looks}};
  if (query.has_pose()) {
    json["pose"] = pose_deg_json(answer.pose);
    json["node"] = answer.node;
    if (answer.states_probability()) json["probability"] = answer.probability;
    json["score"] = json_number(answer.score);
    json["runner_up"] = json_number(answer.runner_up);
    Json& modes = json["modes"] = Json::array();
    for (const PoseMode& mode : answer.modes) {
      modes.push_back({{"pose", pose_deg_json(mode.pose)}, {"probability", mode.probability}});
    }
  }
  if (answer.next_turn_rad != 0) json["next_turn_deg"] = degrees * answer.next_turn_rad;
  if (!answer.failure.empty()) json["failure"] = answer.failure;
  if (query.truth) {
    json["truth"] = pose_deg_json(*query.truth);
    json["error_m"] = json_number(query.error_m());
    json["heading_error_deg"] = json_number(query.heading_error_deg());
  }
  if (!std::isnan(query.cpu_ms)) json["cpu_ms"] = query.cpu_ms;
  return json;
}

/// "no lines" and its like, for a table.
std::string status_words(LocalisationStatus status) {
  std::string words(name(status));
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string success_text(const Success& s) {
  if (s.queries == 0) return "";
  const Interval interval = wilson_interval(s.right, s.queries);
  std::string text = fmt::format(
      "within 1 m, whatever the heading: {} of {}, {:.1f} % [{:.1f}, {:.1f}]; answered: {}, right "
      "of these: {}; best guesses right: {}\n",
      s.right, s.queries, 100.0 * s.right / s.queries, 100 * interval.low, 100 * interval.high,
      s.answered, s.right, s.guesses_right);
  if (!s.errors_m.empty()) {
    const double most_deg = *std::max_element(s.turns_deg.begin(), s.turns_deg.end());
    text += fmt::format(
        "median error of answers: {:.3f} m; of their headings {:.2f} deg, at most {:.3g}\n",
        median(s.errors_m), median(s.turns_deg), most_deg);
  }
  return text;
}

}  // namespace

bool LocalisedQuery::has_pose() const {
  return answer.status == LocalisationStatus::answered ||
         answer.status == LocalisationStatus::unsure;
}

double LocalisedQuery::error_m() const {
  return truth && has_pose() ? distance_m(answer.pose, *truth)
                             : std::numeric_limits<double>::quiet_NaN();
}

double LocalisedQuery::heading_error_deg() const {
  return truth && has_pose() ? degrees * heading_difference_rad(answer.pose, *truth)
                             : std::numeric_limits<double>::quiet_NaN();
}

Json queries_json(const std::vector<LocalisedQuery>& queries) {
  Json json{{"queries", Json::array()}};
  for (const LocalisedQuery& query : queries) json["queries"].push_back(query_json(query));
  const Success s = success_of(queries);
  if (s.queries > 0) {
    const Interval interval = wilson_interval(s.right, s.queries);
    json["success"] = {{"queries", s.queries},
                       {"answered", s.answered},
                       {"right", s.right},
                       {"interval_95", {interval.low, interval.high}},
                       {"best_guesses_right", s.guesses_right},
                       {"median_error_m", json_number(median(s.errors_m))},
                       {"median_heading_error_deg", json_number(median(s.turns_deg))}};
  }
  json["cpu_ms_mean"] = json_number(mean(s.cpu_ms));
  return json;
}

namespace {

/// Close to 1 with as many places as tell it from 1.
std::string probability_text(const LocalisationAnswer& answer) {
  if (!answer.states_probability()) return "";
  return fmt::format("{:.{}f}", answer.probability, answer.probability > 0.9999 ? 6 : 4);
}

/// Which further looks would tell most, of the first queries that ask for one.
std::string next_looks_text(const std::vector<LocalisedQuery>& queries) {
  constexpr int most_shown = 3;
  std::string text;
  int asked = 0;
  for (const LocalisedQuery& query : queries) {
    const LocalisationAnswer& answer = query.answer;
    if (answer.next_turn_rad == 0) continue;
    if (++asked > most_shown) continue;
    text += fmt::format("{}{}: {:+.0f} deg", text.empty() ? "" : ", ", query.name,
                        degrees * answer.next_turn_rad);
  }
  if (asked == 0) return "";
  if (asked > most_shown) text += fmt::format(", and {} more (--json)", asked - most_shown);
  return "a further look, turned from the first (+: to the left), would tell more: " + text + "\n";
}

}  // namespace

std::string queries_table(const std::vector<LocalisedQuery>& queries) {
  constexpr std::size_t most_shown = 40;
  const Success s = success_of(queries);
  std::string text = fmt::format("{:<20} {:<14} {:>8} {:>8} {:>8} {:>11}{}\n", "query", "", "x m",
                                 "y m", "deg", "probability", s.queries > 0 ? "  error m" : "");
  for (std::size_t i = 0; i < std::min(queries.size(), most_shown); ++i) {
    const LocalisedQuery& query = queries[i];
    text += fmt::format("{:<20} {:<14}", query.name, status_words(query.answer.status));
    if (query.has_pose()) {
      const Pose2D& pose = query.answer.pose;
      text += fmt::format(" {:>8.2f} {:>8.2f} {:>8.1f} {:>11}", pose.x_m, pose.y_m,
                          heading_deg(pose), probability_text(query.answer));
      if (query.truth) text += fmt::format(" {:>8.2f}", query.error_m());
    }
    text += '\n';
  }
  if (queries.size() > most_shown) {
    text +=
        fmt::format("… and {} more: --json or -o gives them all\n", queries.size() - most_shown);
  }
  text += next_looks_text(queries);
  text += success_text(s);
  if (!s.cpu_ms.empty()) text += fmt::format("{:.1f} ms CPU a query\n", mean(s.cpu_ms));
  return text;
}

std::string queries_csv(const std::vector<LocalisedQuery>& queries) {
  std::string text = "query,status,x_m,y_m,heading_deg,probability,node,error_m\n";
  for (const LocalisedQuery& query : queries) {
    std::string safe = query.name;
    std::replace(safe.begin(), safe.end(), ',', '_');
    text += fmt::format("{},{},", safe, name(query.answer.status));
    if (query.has_pose()) {
      const Pose2D& pose = query.answer.pose;
      const std::string probability =
          query.answer.states_probability() ? fmt::format("{}", query.answer.probability) : "";
      text += fmt::format("{},{},{},{},{},", pose.x_m, pose.y_m, heading_deg(pose), probability,
                          query.answer.node);
      if (query.truth) text += fmt::format("{}", query.error_m());
    } else {
      text += ",,,,,";
    }
    text += '\n';
  }
  return text;
}

namespace {

/// Of the answers that state their probability and whose truth is known.
void check_stated_errors(const std::vector<LocalisedQuery>& queries, Session& session) {
  int answers = 0, wrong = 0;
  double stated = 0;  // sum
  for (const LocalisedQuery& query : queries) {
    const LocalisationAnswer& answer = query.answer;
    if (answer.status != LocalisationStatus::answered || !answer.states_probability()) continue;
    if (!query.truth) continue;
    ++answers;
    wrong += !(query.error_m() <= right_within_m);
    stated += 1 - answer.probability;
  }
  if (!sim::internal::understates_errors(wrong, answers, stated / std::max(answers, 1))) return;
  const std::string text = fmt::format(
      "{} of {} answers are wrong, where the localiser states {:.2g} %: the map may be of another "
      "place or of another frame of reference, or the building repeats",
      wrong, answers, 100 * stated / answers);
  2 * wrong > answers ? session.add_trust_warning(text) : session.warn(text);
}

}  // namespace

void check_answers(const std::vector<LocalisedQuery>& queries, double off_map, Session& session) {
  check_stated_errors(queries, session);
  std::size_t answered = 0, failed = 0;
  std::string why;
  for (const LocalisedQuery& query : queries) {
    answered += query.answer.status == LocalisationStatus::answered;
    if (query.answer.status != LocalisationStatus::failed) continue;
    if (failed++ == 0) why = query.answer.failure;
  }
  if (failed > 0) {
    session.add_trust_warning(fmt::format("the localiser failed in {} of {} queries; first: {}",
                                          failed, queries.size(), why));
  } else if (answered == 0) {
    const std::string none =
        queries.size() == 1 ? fmt::format("no answer: {}", status_words(queries[0].answer.status))
                            : fmt::format("none of {} queries was answered", queries.size());
    session.add_trust_warning(
        none +
        (off_map > 0 ? "; --off-map makes views of few lines unsure: try a smaller one" : ""));
  }
}

}  // namespace vernier::cli
