// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/odometry/step_consensus.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "calib/triangulation.h"
#include "localise/odometry.h"
#include "localise/odometry/pair_projection.h"
#include "localise/odometry/step_refinement.h"
#include "localise/place.h"

namespace vernier::localise::internal {

using namespace vernier::internal;

namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

PairPixels pixels_of(const StereoCorner& corner) {
  return {corner.left_px.x(), corner.left_px.y(), corner.right_px.x(), corner.right_px.y()};
}

Matrix4d whitening(const StereoCorner& corner) {
  return corner.covariance_px2.llt().matrixL().solve(Matrix4d::Identity());
}

/// Squared Mahalanobis distances of the later pixels from those that a motion predicts.
class MotionDistance {
 public:
  MotionDistance(const Rig& rig, const Pose& T_from_to)
      : projector_(rig), T_to_from_(T_from_to.inverse()) {}

  double operator()(const TriangulatedLink& link) {
    PairPixels pixels;
    PairByPoint by_point;
    if (!projector_.project(T_to_from_ * link.corner.x_from_m, pixels, by_point)) {
      return std::numeric_limits<double>::infinity();
    }
    const PairByPoint J = by_point * T_to_from_.R;
    Matrix4d S = J * link.covariance_from_m2 * J.transpose();
    S += link.to_covariance_px2;
    const PairPixels r = link.corner.to_px - pixels;
    return r.dot(S.llt().solve(r));
  }

 private:
  PairProjector projector_;
  Pose T_to_from_;
};

constexpr std::size_t drawn = 3;
constexpr int pixel_dof = 4;

/// Rigid transform between three points at both moments (Umeyama 1991), refined on their pixels.
std::optional<Pose> motion_of(const Rig& rig,
                              const std::vector<TriangulatedLink>& links,
                              std::span<const std::size_t> chosen) {
  Matrix3d from, to;
  std::vector<LinkedCorner> corners;
  for (std::size_t k = 0; k < drawn; ++k) {
    const TriangulatedLink& link = links[chosen[k]];
    from.col(static_cast<Eigen::Index>(k)) = link.corner.x_from_m;
    to.col(static_cast<Eigen::Index>(k)) = link.x_to_m;
    corners.push_back(link.corner);
  }
  const Matrix4d T = Eigen::umeyama(to, from, false);
  if (!T.allFinite()) return std::nullopt;
  constexpr int iterations = 5;
  const Pose start{T.topLeftCorner<3, 3>(), T.topRightCorner<3, 1>()};
  const auto refined = refine_step({rig, rig}, corners, start, iterations);
  if (!refined) return start;
  return refined->T_from_to;
}

/// Draws needed for right links only with the wanted confidence, of which each is by `share`.
double draws_needed(double share, std::size_t drawn_links, double confidence) {
  const double all_right = std::pow(share, static_cast<int>(drawn_links));
  if (all_right >= 1) return 1;
  if (all_right <= 0) return std::numeric_limits<double>::infinity();
  return std::log1p(-confidence) / std::log1p(-all_right);
}

constexpr int cells = 12;  // along each side of the image, as corners are spread

std::size_t cell_of(const Rig& rig, const Eigen::Vector2d& left_px) {
  const Eigen::Array2d at =
      cells * (left_px.array() + 0.5) / rig.cameras[0].size_px.array().cast<double>();
  const Eigen::Array2i index = at.max(0).min(cells - 1).cast<int>();
  return static_cast<std::size_t>(index.y() * cells + index.x());
}

/// Draws links with probabilities as their weights.
class LinkDraws {
 public:
  LinkDraws(std::size_t links, const std::vector<double>& weights) : links_(links) {
    for (const double weight : weights) {
      sums_.push_back(weight + (sums_.empty() ? 0 : sums_.back()));
    }
  }

  double total() const { return sums_.empty() ? static_cast<double>(links_) : sums_.back(); }

  /// Different ones.
  void draw(RandomStream& draws, std::vector<std::size_t>& chosen) const {
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const auto end = chosen.begin() + static_cast<std::ptrdiff_t>(k);
      do {
        chosen[k] = one(draws);
      } while (std::find(chosen.begin(), end, chosen[k]) != end);
    }
  }

 private:
  std::size_t one(RandomStream& draws) const {
    if (sums_.empty()) return draws.below(static_cast<std::uint32_t>(links_));
    const auto at = std::upper_bound(sums_.begin(), sums_.end(), draws.uniform(0, sums_.back()));
    return std::min(static_cast<std::size_t>(at - sums_.begin()), links_ - 1);
  }

  std::size_t links_;
  std::vector<double> sums_;  ///< of the weights up to each link; empty: equal weights
};

}  // namespace

std::optional<TriangulatedCorner> triangulated(PairProjector& projector,
                                               const StereoCorner& corner,
                                               const MatrixXd& calibration,
                                               double gate) {
  const auto point =
      triangulate_point_with_jacobian(projector.rig(), {corner.left_px, corner.right_px});
  if (!point) return std::nullopt;
  PairPixels pixels;
  PairByPoint by_point;
  if (!projector.project(point->x_m, pixels, by_point)) return std::nullopt;
  Matrix4d calibration_px2 = Matrix4d::Zero();
  if (calibration.size() > 0) {
    const Eigen::Matrix<double, 4, Eigen::Dynamic> by_rig =
        projector.by_rig() + by_point * point->by_rig;
    calibration_px2 = by_rig * calibration * by_rig.transpose();
  }
  const PairPixels misfit = pixels_of(corner) - pixels;
  const Matrix4d S = corner.covariance_px2 + calibration_px2;
  if (misfit.dot(S.llt().solve(misfit)) > gate) return std::nullopt;
  const Matrix3d covariance =
      point->by_pixels * corner.covariance_px2 * point->by_pixels.transpose();
  if (!covariance.allFinite()) return std::nullopt;
  return TriangulatedCorner{point->x_m, covariance, calibration_px2};
}

TriangulatedLink triangulated_link(const CornerLink& link,
                                   const StereoCorner& from,
                                   const TriangulatedCorner& earlier,
                                   const StereoCorner& to,
                                   const TriangulatedCorner& later) {
  return {link,
          {pixels_of(from), pixels_of(to), whitening(from), whitening(to), earlier.x_m},
          later.x_m,
          earlier.covariance_m2,
          to.covariance_px2 + later.calibration_px2,
          later.covariance_m2};
}

std::vector<TriangulatedLink> triangulated_links(const Rig& rig,
                                                 std::span<const StereoCorner> from,
                                                 std::span<const StereoCorner> to,
                                                 std::span<const CornerLink> links,
                                                 const StepOptions& options) {
  const double gate = chi_squared_quantile(options.gate_probability, 1);
  PairProjector projector(rig);
  std::vector<TriangulatedLink> found;
  for (const CornerLink& link : links) {
    const StereoCorner& a = from[static_cast<std::size_t>(link.from)];
    const StereoCorner& b = to[static_cast<std::size_t>(link.to)];
    const auto earlier = triangulated(projector, a, options.calibration, gate);
    const auto later = triangulated(projector, b, options.calibration, gate);
    if (!earlier || !later) continue;
    found.push_back(triangulated_link(link, a, *earlier, b, *later));
  }
  return found;
}

std::vector<double> weights_by_cell(const Rig& rig, const std::vector<TriangulatedLink>& links) {
  std::array<int, cells * cells> in_cell{};
  for (const TriangulatedLink& link : links) ++in_cell[cell_of(rig, link.corner.from_px.head<2>())];
  std::vector<double> weights;
  weights.reserve(links.size());
  for (const TriangulatedLink& link : links) {
    weights.push_back(1.0 / in_cell[cell_of(rig, link.corner.from_px.head<2>())]);
  }
  return weights;
}

std::optional<AgreedMotion> consensus(const Rig& to_rig,
                                      const std::vector<TriangulatedLink>& links,
                                      const StepOptions& options,
                                      const MinimalMotion& minimal) {
  if (links.size() < minimal.links) return std::nullopt;
  const double gate = link_gate(options.gate_probability);
  std::optional<AgreedMotion> best;
  double least = std::numeric_limits<double>::infinity(), needed = options.max_draws;
  std::vector<std::size_t> chosen(minimal.links);
  const LinkDraws links_drawn(links.size(), minimal.weights);
  const auto weight = [&](std::size_t link) {
    return minimal.weights.empty() ? 1 : minimal.weights[link];
  };
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(options.max_draws) && i < needed; ++i) {
    RandomStream draws({.seed = options.seed,
                        .trial = options.step,
                        .feature = i,
                        .source = static_cast<std::uint32_t>(minimal.source)});
    links_drawn.draw(draws, chosen);
    const auto motion = minimal.solve(chosen);
    if (!motion) continue;
    MotionDistance distance(to_rig, *motion);
    double sum = 0, agreeing = 0;
    for (std::size_t k = 0; k < links.size(); ++k) {
      const double d2 = distance(links[k]);
      if (d2 <= gate) agreeing += weight(k);
      sum += weight(k) * std::min(d2, gate);
      if (sum >= least) break;
    }
    if (sum >= least) continue;
    least = sum;
    best = AgreedMotion{*motion, sum};
    needed = draws_needed(agreeing / links_drawn.total(), minimal.links, options.confidence);
  }
  return best;
}

std::optional<Pose> consensus(const Rig& rig,
                              const std::vector<TriangulatedLink>& links,
                              const StepOptions& options) {
  const auto agreed =
      consensus(rig, links, options,
                {drawn, DrawSource::odometry_links,
                 [&](std::span<const std::size_t> chosen) { return motion_of(rig, links, chosen); },
                 weights_by_cell(rig, links)});
  if (!agreed) return std::nullopt;
  return agreed->T_from_to;
}

double link_gate(double gate_probability) {
  return chi_squared_quantile(gate_probability, pixel_dof);
}

std::vector<int> agreeing_links(const Rig& to_rig,
                                const std::vector<TriangulatedLink>& links,
                                const Pose& T_from_to,
                                double gate_probability) {
  const double gate = link_gate(gate_probability);
  MotionDistance distance(to_rig, T_from_to);
  std::vector<int> agreeing;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (distance(links[i]) <= gate) agreeing.push_back(static_cast<int>(i));
  }
  return agreeing;
}

std::vector<TriangulatedLink> links_beyond(const Rig& to_rig,
                                           const std::vector<TriangulatedLink>& links,
                                           const Pose& T_from_to,
                                           double least) {
  MotionDistance distance(to_rig, T_from_to);
  std::vector<TriangulatedLink> beyond;
  for (const TriangulatedLink& link : links) {
    if (distance(link) > least) beyond.push_back(link);
  }
  return beyond;
}

double support_of(const Rig& to_rig,
                  const std::vector<TriangulatedLink>& links,
                  const Pose& T_from_to,
                  double gate_probability) {
  const double gate = link_gate(gate_probability);
  MotionDistance distance(to_rig, T_from_to);
  double support = 0;
  for (const TriangulatedLink& link : links) support += std::max(0.0, 1 - distance(link) / gate);
  return support;
}

std::optional<SettledStep> settled_step(const StepRigs& rigs,
                                        const std::vector<TriangulatedLink>& links,
                                        const Pose& start,
                                        const StepOptions& options,
                                        const FloorBasis* within) {
  constexpr int max_rounds = 10, max_iterations = 50;
  const auto fewest = static_cast<std::size_t>(options.min_inliers);
  std::vector<int> chosen = agreeing_links(rigs.to, links, start, options.gate_probability);
  std::optional<RefinedStep> refined;
  for (int round = 0; round < max_rounds; ++round) {
    if (chosen.size() < fewest) return std::nullopt;
    refined = refine_step(rigs, corners_at(links, chosen), refined ? refined->T_from_to : start,
                          max_iterations, within);
    if (!refined) return std::nullopt;
    std::vector<int> again =
        agreeing_links(rigs.to, links, refined->T_from_to, options.gate_probability);
    if (again == chosen || round + 1 == max_rounds) break;
    chosen = std::move(again);
  }
  return SettledStep{std::move(*refined), std::move(chosen)};
}

double other_motion(const Rig& rig,
                    std::span<const StereoCorner> from,
                    std::span<const StereoCorner> to,
                    std::span<const CornerLink> links,
                    const MotionStep& step,
                    const StepOptions& options) {
  constexpr double apart = 9;  // times the gate: three times as far off as a right link may be
  constexpr std::size_t fewest = 10;  // fewer may agree by chance
  const std::vector<TriangulatedLink> rest =
      links_beyond(rig, triangulated_links(rig, from, to, links, options), step.T_from_to,
                   apart * link_gate(options.gate_probability));
  if (rest.size() < fewest) return 0;
  const std::optional<Pose> agreed = consensus(rig, rest, options);
  if (!agreed) return 0;
  const auto other = settled_step({rig, rig}, rest, *agreed, options);
  if (!other || other->agreeing.size() < fewest) return 0;
  std::set<std::size_t> others, own;
  for (const int i : other->agreeing) {
    others.insert(cell_of(rig, rest[static_cast<std::size_t>(i)].corner.from_px.head<2>()));
  }
  for (const CornerLink& link : step.inliers) {
    own.insert(cell_of(rig, from[static_cast<std::size_t>(link.from)].left_px));
  }
  return static_cast<double>(others.size()) /
         static_cast<double>(std::max<std::size_t>(1, own.size()));
}

std::vector<LinkedCorner> corners_at(const std::vector<TriangulatedLink>& links,
                                     const std::vector<int>& chosen) {
  std::vector<LinkedCorner> corners;
  corners.reserve(chosen.size());
  for (const int i : chosen) corners.push_back(links[static_cast<std::size_t>(i)].corner);
  return corners;
}

}  // namespace vernier::localise::internal
