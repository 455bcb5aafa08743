// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/odometry/step_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/odometry/pair_projection.h"

namespace vernier::localise::internal {

namespace {

using vernier::internal::Cholesky;
using vernier::internal::solve_symmetric;

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Vector8d = Eigen::Matrix<double, 8, 1>;

/// Whitened residuals of one corner, measured less predicted, and derivatives of the prediction.
struct LinearisedCorner {
  Vector8d residual;
  Eigen::Matrix<double, 8, 6> by_motion;
  Eigen::Matrix<double, 8, 3> by_point;

  double chi2() const { return residual.squaredNorm(); }
};

/// One for each moment.
struct StepProjectors {
  PairProjector from, to;

  explicit StepProjectors(const StepRigs& rigs) : from(rigs.from), to(rigs.to) {}
};

/// With y = T⁻¹ x and T -> (exp(ω) R, t + τ): δy = Rᵀ [x − t]x ω − Rᵀ τ + Rᵀ δx.
bool linearise(StepProjectors& projectors,
               const LinkedCorner& corner,
               const Pose& T_from_to,
               const Vector3d& x_from_m,
               LinearisedCorner& out) {
  PairPixels pixels;
  PairByPoint by_point;
  if (!projectors.from.project(x_from_m, pixels, by_point)) return false;
  out.residual.head<4>() = corner.from_whitening * (corner.from_px - pixels);
  out.by_point.topRows<4>() = corner.from_whitening * by_point;
  out.by_motion.topRows<4>().setZero();
  const Matrix3d Rt = T_from_to.R.transpose();
  const Vector3d from_t = x_from_m - T_from_to.t;
  if (!projectors.to.project(Rt * from_t, pixels, by_point)) return false;
  out.residual.tail<4>() = corner.to_whitening * (corner.to_px - pixels);
  const PairByPoint by_x = corner.to_whitening * by_point * Rt;
  out.by_point.bottomRows<4>() = by_x;
  out.by_motion.bottomRows<4>().leftCols<3>() = by_x * hat(from_t);
  out.by_motion.bottomRows<4>().rightCols<3>() = -by_x;
  return true;
}

/// The part of a corner in the normal equations of the motion, its point eliminated.
struct EliminatedPoint {
  Eigen::LLT<Matrix3d> V;         ///< Bᵀ B, damped
  Eigen::Matrix<double, 6, 3> W;  ///< Aᵀ B
  Vector3d gradient;              ///< Bᵀ r

  EliminatedPoint(const LinearisedCorner& c, double damping) {
    Matrix3d v = c.by_point.transpose() * c.by_point;
    v.diagonal() *= 1 + damping;
    V.compute(v);
    W.noalias() = c.by_motion.transpose() * c.by_point;
    gradient.noalias() = c.by_point.transpose() * c.residual;
  }
};

/// Aᵀ Q y: of what a corner measures, the part in the motion's equations, its point eliminated.
template <class Measured>
Eigen::Matrix<double, 6, Measured::ColsAtCompileTime> in_motion(const LinearisedCorner& c,
                                                                const Measured& y) {
  const EliminatedPoint p(c, 0);
  return c.by_motion.transpose() * y - p.W * p.V.solve(c.by_point.transpose() * y);
}

/// State of the minimisation.
struct StepState {
  Pose T_from_to;
  std::vector<Vector3d> x_from_m;
  std::vector<LinearisedCorner> corners;
  double chi2 = 0;

  bool relinearise(StepProjectors& projectors, const std::vector<LinkedCorner>& measured) {
    corners.resize(measured.size());
    chi2 = 0;
    for (std::size_t i = 0; i < measured.size(); ++i) {
      if (!linearise(projectors, measured[i], T_from_to, x_from_m[i], corners[i])) return false;
      chi2 += corners[i].chi2();
    }
    return std::isfinite(chi2);
  }
};

struct CornerSystem {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  std::vector<EliminatedPoint> points;

  CornerSystem(const std::vector<LinearisedCorner>& corners, double damping) {
    points.reserve(corners.size());
    for (const LinearisedCorner& c : corners) {
      points.emplace_back(c, damping);
      const EliminatedPoint& p = points.back();
      Matrix6d U = c.by_motion.transpose() * c.by_motion;
      U.diagonal() *= 1 + damping;
      H += U - p.W * p.V.solve(p.W.transpose());
      g += c.by_motion.transpose() * c.residual - p.W * p.V.solve(p.gradient);
    }
  }
};

/// The change of the motion that minimises the linearised system; false if there is none.
bool change_of(const CornerSystem& system, const FloorBasis* within, Vector6d& delta) {
  const auto solved = [](const Cholesky& H, const Eigen::VectorXd& g) {
    return H.is_positive_definite() ? std::optional<Eigen::VectorXd>(H.solve(g)) : std::nullopt;
  };
  const std::optional<Eigen::VectorXd> found =
      within ? solved(Cholesky(within->transpose() * system.H * *within),
                      within->transpose() * system.g)
             : solved(Cholesky(system.H), system.g);
  if (!found) return false;
  delta = within ? Vector6d(*within * *found) : Vector6d(*found);
  return delta.allFinite();
}

/// The state after a step of the system; false if it has none.
bool advance(const CornerSystem& system,
             const FloorBasis* within,
             const StepState& from,
             StepState& to,
             double& largest) {
  Vector6d delta;
  if (!change_of(system, within, delta)) return false;
  largest = delta.cwiseAbs().maxCoeff();
  to.T_from_to = retract(from.T_from_to, delta);
  to.x_from_m.resize(from.x_from_m.size());
  for (std::size_t i = 0; i < from.x_from_m.size(); ++i) {
    const EliminatedPoint& p = system.points[i];
    to.x_from_m[i] = from.x_from_m[i] + p.V.solve(p.gradient - p.W.transpose() * delta);
  }
  return true;
}

}  // namespace

double RefinedStep::total_chi2() const { return std::accumulate(chi2.begin(), chi2.end(), 0.0); }

std::optional<RefinedStep> refine_step(const StepRigs& rigs,
                                       const std::vector<LinkedCorner>& corners,
                                       const Pose& T_from_to,
                                       int max_iterations,
                                       const FloorBasis* within) {
  StepProjectors projectors(rigs);
  StepState state;
  state.T_from_to = T_from_to;
  for (const LinkedCorner& corner : corners) state.x_from_m.push_back(corner.x_from_m);
  if (!state.relinearise(projectors, corners)) return std::nullopt;
  constexpr double first_damping = 1e-6, least = 1e-12, most = 1e6, factor = 10;
  constexpr double converged = 1e-10;       // rad and m
  constexpr double converged_chi2 = 1e-12;  // relative
  double damping = first_damping;
  StepState next;
  for (int i = 0; i < max_iterations; ++i) {
    const CornerSystem system(state.corners, damping);
    double largest = 0;
    const bool better = advance(system, within, state, next, largest) &&
                        next.relinearise(projectors, corners) && next.chi2 <= state.chi2;
    if (!better) {
      damping *= factor;
      if (damping > most || largest < converged) break;
      continue;
    }
    const bool done = largest < converged || state.chi2 - next.chi2 <= converged_chi2 * state.chi2;
    std::swap(state, next);
    if (done) break;
    damping = std::max(least, damping / factor);
  }
  RefinedStep refined;
  refined.T_from_to = state.T_from_to;
  refined.information = CornerSystem(state.corners, 0).H;
  for (const LinearisedCorner& corner : state.corners) refined.chi2.push_back(corner.chi2());
  refined.x_from_m = std::move(state.x_from_m);
  return refined;
}

std::vector<CornerInfluence> corner_influences(const Rig& rig,
                                               const std::vector<LinkedCorner>& corners,
                                               const RefinedStep& step) {
  constexpr double prior_corners = 20;            // n₀
  constexpr double least_variance_factor = 1e-6;  // of exact corners, whose residuals are rounding
  const auto n = static_cast<double>(corners.size());
  const double factor = std::max(step.total_chi2() / (5 * n - 6), least_variance_factor);
  const double as_stated = prior_corners / (prior_corners + n), as_seen = 1 - as_stated;
  const Matrix6d inverse = solve_symmetric(step.information, Eigen::MatrixXd(Matrix6d::Identity()));
  std::vector<CornerInfluence> influences;
  influences.reserve(corners.size());
  StepProjectors projectors({rig, rig});
  for (std::size_t i = 0; i < corners.size(); ++i) {
    CornerInfluence& of = influences.emplace_back();
    of.from.setZero();
    of.to.setZero();
    of.residual.setZero();
    LinearisedCorner c;
    if (!linearise(projectors, corners[i], step.T_from_to, step.x_from_m[i], c)) continue;
    const Eigen::Matrix<double, 6, 8> by_measured =
        in_motion(c, Eigen::Matrix<double, 8, 8>(Eigen::Matrix<double, 8, 8>::Identity()));  // AᵀQ
    const Matrix6d M = by_measured * c.by_motion;
    const Matrix6d others = Matrix6d::Identity() - M * inverse;
    const Vector6d g = others.partialPivLu().solve(by_measured * c.residual);
    // A corner without which the motion is not determined has no residual to judge it by.
    const bool judged = g.allFinite();
    if (judged) of.residual = std::sqrt(as_seen) * inverse * g;
    const Eigen::Matrix<double, 6, 8> by_noise = inverse * by_measured;
    const double sd = std::sqrt((judged ? as_stated : 1) * factor);
    of.from = sd * by_noise.leftCols<4>();
    of.to = sd * by_noise.rightCols<4>();
  }
  return influences;
}

Eigen::Matrix<double, 6, Eigen::Dynamic> step_by_rig(const Rig& rig,
                                                     const std::vector<LinkedCorner>& corners,
                                                     const RefinedStep& step) {
  StepProjectors projectors({rig, rig});
  PairProjector& projector = projectors.from;
  Eigen::Matrix<double, 6, Eigen::Dynamic> gradient =
      Eigen::MatrixXd::Zero(6, parameter_count(rig));
  Eigen::Matrix<double, 8, Eigen::Dynamic> by_rig(8, parameter_count(rig));
  const Pose T_to_from = step.T_from_to.inverse();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    LinearisedCorner c;
    if (!linearise(projectors, corners[i], step.T_from_to, step.x_from_m[i], c)) continue;
    PairPixels pixels;
    PairByPoint by_point;
    projector.project(step.x_from_m[i], pixels, by_point);
    by_rig.topRows<4>() = corners[i].from_whitening * projector.by_rig();
    projector.project(T_to_from * step.x_from_m[i], pixels, by_point);
    by_rig.bottomRows<4>() = corners[i].to_whitening * projector.by_rig();
    gradient += in_motion(c, by_rig);
  }
  return -solve_symmetric(step.information, Eigen::MatrixXd(gradient));
}

}  // namespace vernier::localise::internal
