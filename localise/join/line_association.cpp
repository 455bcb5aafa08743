// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/join/line_association.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "localise/join/line_fit.h"
#include "localise/join/line_grid.h"
#include "localise/join/line_reach.h"

namespace vernier::localise::internal {

namespace {

/// Stations of a sighting's ends, ascending.
std::pair<double, double> span_of(const WorldSighting& sighting, const LineFrame& frame) {
  return std::minmax({frame.station(sighting.a_m), frame.station(sighting.b_m)});
}

/// Whether two stretches of one line overlap by more than the error of their ends.
bool overlap(const std::pair<double, double>& a, const std::pair<double, double>& b) {
  constexpr double least_m = 0.02, share = 0.1;
  const double common = std::min(a.second, b.second) - std::max(a.first, b.first);
  const double shorter = std::min(a.second - a.first, b.second - b.first);
  return common > std::max(std::min(least_m, 0.5 * shorter), share * shorter);
}

std::vector<const WorldSighting*> members_of(const GrowingLine& line,
                                             std::span<const WorldSighting> sightings) {
  std::vector<const WorldSighting*> members;
  for (const int i : line.members) members.push_back(&sightings[i]);
  return members;
}

/// A fitted line as a measurement at its ends.
LineMeasurement measured(const GrowingLine& line, const LineFrame& frame) {
  const LineFrame& own = line.fit.frame;
  const Eigen::Vector3d z = own.axes.col(2);
  WorldSighting ends;
  ends.a_m = own.origin_m + line.low_m * z;
  ends.b_m = own.origin_m + line.high_m * z;
  ends.covariance_m2 = covariance_of_ends(line.fit, line.low_m, line.high_m, {0, 0});
  return measured(ends, frame);
}

}  // namespace

bool LineAssociation::Candidate::operator<(const Candidate& other) const {
  return std::tie(cost, sighting, line) < std::tie(other.cost, other.sighting, other.line);
}

std::optional<LineDistance> LineAssociation::gated(const LineMeasurement& m,
                                                   const GrowingLine& line,
                                                   double gate) const {
  const auto [low, high] = std::minmax(m.station_m[0], m.station_m[1]);
  if (low > line.high_m + options_.max_gap_m || high < line.low_m - options_.max_gap_m) {
    return {};
  }
  const Eigen::Vector2d a = m.across_m.head<2>(), b = m.across_m.tail<2>();
  if ((0.5 * (a + b)).norm() > options_.max_offset_m) return {};
  if ((b - a).norm() > std::tan(options_.max_turn_rad) * (high - low)) return {};
  const LineDistance d = distance(m, line.fit);
  if (d.mahalanobis2 > gate) return {};
  return d;
}

bool LineAssociation::has_rival(int sighting, const GrowingLine& line) const {
  const WorldSighting& s = sightings_[sighting];
  const auto span = span_of(s, line.fit.frame);
  return std::any_of(line.members.begin(), line.members.end(), [&](int i) {
    return i != sighting && sightings_[i].view == s.view &&
           overlap(span, span_of(sightings_[i], line.fit.frame));
  });
}

bool LineAssociation::are_rivals(const GrowingLine& a, const GrowingLine& b) const {
  const bool a_is_smaller = a.members.size() < b.members.size();
  const GrowingLine& smaller = a_is_smaller ? a : b;
  const GrowingLine& larger = a_is_smaller ? b : a;
  const auto rivals = std::count_if(smaller.members.begin(), smaller.members.end(),
                                    [&](int i) { return has_rival(i, larger); });
  // a few may have been associated wrongly, which associate_anew() mends
  constexpr double most_share = 0.25;
  return static_cast<double>(rivals) > most_share * static_cast<double>(smaller.members.size());
}

std::vector<LineAssociation::Candidate> LineAssociation::candidates(int sighting) {
  const WorldSighting& s = sightings_[sighting];
  const Eigen::Vector3d along = (s.b_m - s.a_m).normalized();
  const Eigen::Vector3d middle_m = 0.5 * (s.a_m + s.b_m);
  const double least_cosine = std::cos(options_.max_turn_rad);
  std::vector<Candidate> found;
  for (const int i : grid_.near(s.a_m, s.b_m)) {
    const GrowingLine& line = lines_[i];
    const LineFrame& frame = line.fit.frame;
    if (std::abs(along.dot(frame.axes.col(2))) < least_cosine) continue;
    // what gated() would refuse, before a covariance is computed
    if (frame.across(middle_m).norm() > options_.max_offset_m) continue;
    if (const auto d = gated(measured(s, frame), line)) {
      found.push_back({d->cost, sighting, i, d->mahalanobis2});
    }
  }
  return found;
}

void LineAssociation::keep_in_grid(int number) {
  GrowingLine& line = lines_[number];
  const Eigen::Vector3d z = line.fit.frame.axes.col(2);
  const Eigen::Vector3d a = line.fit.frame.origin_m + line.low_m * z;
  const Eigen::Vector3d b = line.fit.frame.origin_m + line.high_m * z;
  const double slack_m = 0.5 * options_.max_offset_m;
  const auto is_covered = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d d = line.in_grid_b_m - line.in_grid_a_m;
    const double t = std::clamp(d.dot(p - line.in_grid_a_m) / d.squaredNorm(), 0.0, 1.0);
    return (line.in_grid_a_m + t * d - p).norm() < slack_m;
  };
  if (line.is_in_grid && is_covered(a) && is_covered(b)) return;
  grid_.add(a, b, number);
  line.is_in_grid = true;
  line.in_grid_a_m = a;
  line.in_grid_b_m = b;
}

void LineAssociation::refit(int number) {
  GrowingLine& line = lines_[number];
  const std::vector<const WorldSighting*> members = members_of(line, sightings_);
  line.fit = fitted(members);
  const LineReach reached = reach(members, line.fit.frame);
  line.low_m = reached.low_m;
  line.high_m = reached.high_m;
  keep_in_grid(number);
}

void LineAssociation::associate_view(int first, int last, bool refits) {
  std::vector<Candidate> all;
  for (int i = first; i < last; ++i) {
    const std::vector<Candidate> of_one = candidates(i);
    all.insert(all.end(), of_one.begin(), of_one.end());
  }
  std::sort(all.begin(), all.end());
  std::vector<bool> is_placed(last - first, false);
  std::vector<int> grown;
  for (const Candidate& c : all) {
    if (is_placed[c.sighting - first] || has_rival(c.sighting, lines_[c.line])) continue;
    is_placed[c.sighting - first] = true;
    lines_[c.line].members.push_back(c.sighting);
    grown.push_back(c.line);
  }
  std::sort(grown.begin(), grown.end());
  grown.erase(std::unique(grown.begin(), grown.end()), grown.end());
  if (refits) {
    for (const int line : grown) refit(line);
  }
  for (int i = first; i < last; ++i) {
    if (is_placed[i - first]) continue;
    lines_.emplace_back().members = {i};
    refit(static_cast<int>(lines_.size()) - 1);
  }
}

void LineAssociation::associate_views(bool refits) {
  const int count = static_cast<int>(sightings_.size());
  for (int first = 0, last = 0; first < count; first = last) {
    while (last < count && sightings_[last].view == sightings_[first].view) ++last;
    associate_view(first, last, refits);
  }
}

int LineAssociation::best_partner(int number) {
  const GrowingLine& line = lines_[number];
  const LineFrame& own = line.fit.frame;
  const Eigen::Vector3d z = own.axes.col(2);
  const Eigen::Vector3d a = own.origin_m + line.low_m * z, b = own.origin_m + line.high_m * z;
  int best = -1;
  double least = 0;
  for (const int i : grid_.near(a, b)) {
    const GrowingLine& other = lines_[i];
    if (i == number || other.members.empty()) continue;
    // the shorter one is measured against the longer
    if (std::pair(other.high_m - other.low_m, -i) < std::pair(line.high_m - line.low_m, -number)) {
      continue;
    }
    const LineFrame& frame = other.fit.frame;
    if (std::abs(z.dot(frame.axes.col(2))) < std::cos(options_.max_turn_rad)) continue;
    // Sightings of one line that were divided at their middle, each to the nearer half, look like
    // two: this takes 2 / π of their variance away in one direction.
    const double n = static_cast<double>(line.members.size() + other.members.size());
    const double gate = options_.gate + (n > 2 ? 2 / std::numbers::pi * n : 0);
    const auto d = gated(measured(line, other.fit.frame), other, gate);
    if (d && (best < 0 || d->cost < least) && !are_rivals(line, other)) {
      least = d->cost;
      best = i;
    }
  }
  return best;
}

int LineAssociation::merge() {
  int merged = 0;
  for (int i = 0; i < static_cast<int>(lines_.size()); ++i) {
    if (lines_[i].members.empty()) continue;
    const int partner = best_partner(i);
    if (partner < 0) continue;
    std::vector<int>& into = lines_[partner].members;
    into.insert(into.end(), lines_[i].members.begin(), lines_[i].members.end());
    std::sort(into.begin(), into.end());
    lines_[i].members.clear();
    refit(partner);
    ++merged;
  }
  return merged;
}

bool LineAssociation::dissolve(int number) {
  GrowingLine& line = lines_[number];
  std::vector<std::pair<int, int>> moves;  // sighting, line
  double increase = 0;
  for (const int member : line.members) {
    increase -= residual2(measured(sightings_[member], line.fit.frame));
    std::vector<Candidate> others = candidates(member);
    std::sort(others.begin(), others.end());
    const auto best = std::find_if(others.begin(), others.end(), [&](const Candidate& c) {
      return c.line != number && !lines_[c.line].members.empty() &&
             !has_rival(member, lines_[c.line]);
    });
    if (best == others.end()) return false;
    increase += best->mahalanobis2;
    moves.emplace_back(member, best->line);
  }
  if (increase > options_.gate) return false;
  line.members.clear();
  for (const auto& [sighting, into] : moves) lines_[into].members.push_back(sighting);
  for (const auto& [sighting, into] : moves) refit(into);
  return true;
}

void LineAssociation::dissolve() {
  std::vector<int> order(lines_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return lines_[a].members.size() < lines_[b].members.size();
  });
  for (const int i : order) {
    if (!lines_[i].members.empty()) dissolve(i);
  }
}

void LineAssociation::drop_empty() {
  std::erase_if(lines_, [](const GrowingLine& line) { return line.members.empty(); });
  grid_ = LineGrid(cell_m(options_));
  for (int i = 0; i < static_cast<int>(lines_.size()); ++i) {
    lines_[i].is_in_grid = false;
    keep_in_grid(i);
  }
}

void LineAssociation::associate_anew() {
  for (GrowingLine& line : lines_) line.members.clear();
  associate_views(false);
  drop_empty();
  for (int i = 0; i < static_cast<int>(lines_.size()); ++i) refit(i);
}

std::vector<GrowingLine> LineAssociation::associate() {
  constexpr int rounds = 3, most_merges = 3;
  associate_views(true);
  for (int round = 0; round < rounds; ++round) {
    for (int i = 0; i < most_merges && merge() > 0; ++i) continue;
    dissolve();
    drop_empty();
    associate_anew();
  }
  for (GrowingLine& line : lines_) std::sort(line.members.begin(), line.members.end());
  return std::move(lines_);
}

}  // namespace vernier::localise::internal
