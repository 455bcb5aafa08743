// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/methods/line_localiser.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "localise/localiser.h"
#include "localise/methods/line_query.h"
#include "localise/place.h"
#include "localise/place/repeated_lines.h"
#include "localise/place/space_lines.h"
#include "localise/posterior/pose_posterior.h"
#include "localise/ranking/node_ranker.h"
#include "localise/topological_map.h"
#include "localise/verification/floor_plan_votes.h"
#include "localise/verification/image_lines.h"
#include "localise/verification/view_agreement.h"

namespace vernier::localise::internal {

namespace {

/// Views with fewer lines have many rivals: more of them are compared in full.
constexpr std::size_t sparse_lines = 60;
constexpr int few_finalists = 3, many_finalists = 20;
constexpr int first_candidates = 16;      ///< the others follow where these leave doubts
constexpr double sure_error_rate = 0.01;  ///< unless a smaller one is asked for
/// Where even the best pose scores below minus so many nats an observation, a view is far from what
/// the map recorded anywhere, its own place included, and the first look at each candidate may have
/// given that up (0.8 and 1.3 did no better on offices of seeds 1 to 20).
constexpr double poor_misfit = 1;

}  // namespace

LineLocaliser::LineLocaliser(const TopologicalMap& map, const LocaliserOptions& options)
    : map_(map),
      options_(options),
      ranker_(make_ranker(options.ranker, map, options.histograms)),
      grid_(map) {
  const double least = least_error_rate(map.nodes.size());
  if (options.stages.compare && look_error_rate() < least) {
    throw Error(
        options.look_error_rate ? "look_error_rate" : "max_error_rate",
        fmt::format("{:g} is below {:.2g}, the least that can be stated in a map of {} nodes",
                    look_error_rate(), least, map.nodes.size()),
        "use a larger one");
  }
}

LocalisationAnswer LineLocaliser::localise(const PlaceView& query) const {
  const Look look{query, 0};
  return localise_looks({&look, 1});
}

LocalisationAnswer LineLocaliser::localise_looks(std::span<const Look> looks) const {
  if (looks.empty()) throw Error("looks", "there are none", "give at least one");
  if (std::any_of(looks.begin(), looks.end(), [](const Look& l) { return has_repeats(l.view); })) {
    std::vector<Look> once(looks.begin(), looks.end());
    for (Look& look : once) drop_repeats(look.view);
    return localise_looks(once);
  }
  Query query;
  std::size_t lines = 0;
  for (const Look& look : looks) {
    query.looks.push_back(
        {&look.view, compared_view(look.view), plan_uprights(look.view.lines), look.turn_rad});
    lines += look.view.lines.size();
  }
  const bool few = static_cast<int>(lines) < options_.min_lines;
  LocalisationAnswer result;
  result.status = few ? LocalisationStatus::too_few_lines : LocalisationStatus::no_match;
  if (map_.nodes.empty()) return result;

  std::vector<std::vector<RankedNode>> ranked;
  for (const Look& look : looks) ranked.push_back(ranker_->rank(look.view, options_.candidates));
  if (!few) result = search(ranked, query);
  if (result.status != LocalisationStatus::answered || 1 - result.probability > look_error_rate()) {
    result.next_turn_rad = telling_turn(result.modes, ranked[0], query);
  }
  return result;
}

/// Tries more of everything as long as the answer is not sure. `ranked` is of each look.
LocalisationAnswer LineLocaliser::search(std::span<const std::vector<RankedNode>> ranked,
                                         Query& query) const {
  struct Round {
    int candidates, finalists;
    bool wide = false;
  };
  const int first = std::min(options_.candidates, first_candidates);
  const int few = is_plain(query) ? few_finalists : many_finalists;
  std::vector<Round> rounds{{first, few}};
  if (options_.stages.deepen) {
    if (few < many_finalists) rounds.push_back({first, many_finalists - few});
    rounds.push_back({options_.candidates, many_finalists});
    if (options_.stages.align) rounds.push_back({options_.candidates, many_finalists, true});
  }
  const double sure = 1 - std::max(std::min(look_error_rate(), sure_error_rate),
                                   least_error_rate(map_.nodes.size()));
  LocalisationAnswer result;
  result.status = LocalisationStatus::no_match;
  int tried = 0;
  const auto try_to = [&](int end) {
    for (std::size_t i = 0; i < query.looks.size(); ++i) {
      candidates(query.looks[i], ranked[i], tried, end, Starts::best, query);
    }
    tried = std::max(tried, end);
  };
  const bool deepens = options_.stages.deepen && options_.stages.align;
  bool is_first = deepens && options_.stages.refine && options_.stages.compare;
  for (const Round& round : rounds) {
    try_to(round.candidates);
    for (std::size_t i = 0; round.wide && i < query.looks.size(); ++i) {
      wide_candidates(query.looks[i], ranked[i], query);
    }
    compare_best(round.finalists, query);
    if (query.compared.empty()) continue;
    result = answer(query, 0);
    if (std::exchange(is_first, false) && fits_poorly(query)) {
      search_from_all_starts(ranked, tried, query);
      result = answer(query, 0);
    }
    // A sure answer is compared with what may be the true place as well.
    while (deepens && result.probability >= sure) {
      if (const int alike = ranked_alike(result.pose, ranked, query); alike > tried) {
        try_to(alike);
        compare_best(many_finalists, query);
      } else if (query.doubted.add(result.pose)) {
        compare_rivals(result.pose, query);
      } else {
        break;
      }
      result = answer(query, 0);
    }
    if (result.probability >= sure) break;
  }
  // More candidates do not help against a place that the map does not hold.
  if (options_.off_map > 0 && !query.compared.empty()) result = answer(query, options_.off_map);
  return result;
}

/// Whether no pose that was compared explains the looks.
bool LineLocaliser::fits_poorly(const Query& query) const {
  const double least = -poor_misfit * size_of(query).observations;
  return std::none_of(query.compared.begin(), query.compared.end(),
                      [least](const Hypothesis& h) { return h.score > least; });
}

/// Tries the first candidates again, from each peak of the votes, and compares the best in full.
void LineLocaliser::search_from_all_starts(std::span<const std::vector<RankedNode>> ranked,
                                           int end,
                                           Query& query) const {
  query.started.clear();
  for (std::size_t i = 0; i < query.looks.size(); ++i) {
    candidates(query.looks[i], ranked[i], 0, end, Starts::all, query);
  }
  compare_best(many_finalists, query);
}

/// How many candidates rank nearly as well as that of a pose, of the look with the most; all, if it
/// is none of them. A view of a building whose stretches resemble each other may fit one of the
/// first well, and its own place, a little further down the list, better (16 of 19 wrong answers at
/// a stated 1 % in corridors of doors at uneven gaps).
int LineLocaliser::ranked_alike(const Pose2D& pose,
                                std::span<const std::vector<RankedNode>> ranked,
                                const Query& query) const {
  constexpr double near_m = 1, near_rad = 0.4;  // votes and steps move a candidate by less
  std::ptrdiff_t most = 0;
  for (std::size_t i = 0; i < query.looks.size(); ++i) {
    const Pose2D here = turned(pose, query.looks[i].turn_rad);
    const auto own = std::find_if(ranked[i].begin(), ranked[i].end(), [&](const RankedNode& r) {
      return is_close_to(compose(map_.nodes[r.node].pose, r.query_in_node), here, near_m, near_rad);
    });
    const auto is_alike = [&](const RankedNode& r) {
      return own == ranked[i].end() || r.score >= own->score - ranker_->alike_within();
    };
    most = std::max(most, std::count_if(ranked[i].begin(), ranked[i].end(), is_alike));
  }
  return static_cast<int>(most);
}

ViewSize LineLocaliser::size_of(const Query& query) {
  ViewSize sum;
  for (const Seen& look : query.looks) {
    sum.observations += look.view.observations;
    sum.lines += look.view.lines.size();
  }
  return sum;
}

bool LineLocaliser::is_plain(const Query& query) const {
  // A candidate of one look was not compared with the others yet.
  return query.looks.size() == 1 && query.looks[0].view.lines.size() >= sparse_lines;
}

}  // namespace vernier::localise::internal
