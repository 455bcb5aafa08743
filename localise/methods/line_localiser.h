// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "localise/localiser.h"
#include "localise/map/node_grid.h"
#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/posterior/pose_posterior.h"
#include "localise/ranking/node_ranker.h"
#include "localise/topological_map.h"
#include "localise/verification/floor_plan_votes.h"
#include "localise/verification/place_evidence.h"
#include "localise/verification/view_agreement.h"

namespace vernier::localise::internal {

/// Ranks nodes, finds poses by votes of vertical lines, compares the recorded lines with the view
/// in its image, and forms a posterior. See make_localiser.
class LineLocaliser : public Localiser {
 public:
  LineLocaliser(const TopologicalMap& map, const LocaliserOptions& options);

  LocalisationAnswer localise(const PlaceView& query) const override;
  LocalisationAnswer localise_looks(std::span<const Look> looks) const override;

 private:
  /// A look as it is compared.
  struct Seen {
    const PlaceView* taken;
    ComparedView view;
    std::vector<PlanUpright> uprights;
    double turn_rad = 0;
  };
  /// Of all looks together.
  struct JointAgreement {
    double score = 0;
    Eigen::Matrix3f information = Eigen::Matrix3f::Zero();
    Eigen::Vector3f gradient = Eigen::Vector3f::Zero();
    int node = -1;  ///< with which the first look was compared
  };
  /// What the map holds around a pose, and that in its frame.
  struct MapPart {
    int node;
    const SpaceLines* lines;
    Pose2D pose_in_node;
  };
  /// From which peaks of the votes the pose of a candidate is looked for.
  enum class Starts {
    best,  ///< the best, unless it is far behind other candidates'
    all,
  };
  struct JudgedPose;
  struct RecordedView;
  /// Memory and intermediate results of one query.
  struct Query;

  LocalisationAnswer search(std::span<const std::vector<RankedNode>> ranked, Query& query) const;
  bool fits_poorly(const Query& query) const;
  void search_from_all_starts(std::span<const std::vector<RankedNode>> ranked,
                              int end,
                              Query& query) const;
  int ranked_alike(const Pose2D& pose,
                   std::span<const std::vector<RankedNode>> ranked,
                   const Query& query) const;
  void candidates(const Seen& seen,
                  std::span<const RankedNode> ranked,
                  int from,
                  int to,
                  Starts starts,
                  Query& query) const;
  void wide_candidates(const Seen& seen,
                       std::span<const RankedNode> ranked_before,
                       Query& query) const;
  void compare_rivals(const Pose2D& pose, Query& query) const;
  void near_pose(const Pose2D& pose, const Seen& look, Starts starts, Query& query) const;
  static ViewSize size_of(const Query& query);
  /// Where an error is more probable, a further look is wanted.
  double look_error_rate() const {
    return options_.look_error_rate.value_or(options_.max_error_rate);
  }
  const SpaceLines& lines_around(int node, Query& query) const;
  const std::vector<PlanUpright>& uprights_around(int node, Query& query) const;
  JointAgreement joint_agreement(const Pose2D& first,
                                 const AgreementOptions& options,
                                 Query& query) const;
  void compare(Hypothesis& hypothesis, Query& query) const;
  void compare_best(int most, Query& query) const;
  bool is_plain(const Query& query) const;
  MapPart map_part(const Pose2D& pose, Query& query) const;
  JudgedPose& judged(const Pose2D& pose, Query& query) const;
  std::optional<PlaceEvidence> evidence_without(int left_out,
                                                const ComparedView& view,
                                                const Pose2D& pose,
                                                Query& query) const;
  std::set<int> nodes_of_place(const Pose2D& pose, const Query& query) const;
  RecordedDifference recorded_difference(const Pose2D& here,
                                         const Pose2D& there,
                                         Query& query) const;
  Evidence evidence(const Hypothesis& a, const Hypothesis& b, Query& query) const;
  LocalisationAnswer answer(Query& query, double off_map) const;
  double telling_turn(std::span<const PoseMode> modes,
                      std::span<const RankedNode> ranked,
                      Query& query) const;

  const TopologicalMap& map_;
  LocaliserOptions options_;
  std::unique_ptr<NodeRanker> ranker_;
  NodeGrid grid_;
};

}  // namespace vernier::localise::internal
