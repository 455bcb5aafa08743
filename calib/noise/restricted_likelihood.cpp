// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/restricted_likelihood.h"

#include <cmath>
#include <cstddef>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/error.h"
#include "calib/noise/average_information.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/frame_rows.h"
#include "calib/noise/likelihood_gradient.h"
#include "calib/noise/linear_frames.h"
#include "calib/noise/mixed_model.h"
#include "calib/noise/rig_knowledge.h"
#include "calib/noise/scaled_factor.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

NoiseParts with_motion_if_seen(NoiseParts parts, const std::vector<FrameRows>& frames) {
  if (!frames.empty() && frames[0].by_motion.cols() == 0) parts.motion = false;
  if (!parts.motion) parts.baseline_motion = false;
  return parts;
}

}  // namespace

RestrictedLikelihood::RestrictedLikelihood(const std::vector<FrameRows>& frames,
                                           const std::vector<Eigen::Vector3d>& target_m,
                                           NoiseParts parts,
                                           RigKnowledge prior,
                                           VectorXd shape_m)
    : parts_(with_motion_if_seen(parts, frames)),
      prior_(std::move(prior)),
      shape_m_(std::move(shape_m)),
      linear_(frames, target_m, parts_) {
  if (shape_m_.size() == 0) shape_m_ = VectorXd::Zero(linear_.unknowns.shape);
}

Index RestrictedLikelihood::coordinates() const {
  Index sum = 0;
  for (const PointSet& set : linear_.sets) {
    sum += set.coordinates * static_cast<Index>(set.ids.size());
  }
  return sum;
}

std::vector<double CornerNoise::*> RestrictedLikelihood::components() const {
  std::vector<double CornerNoise::*> all{&CornerNoise::white_px};
  if (parts_.field) all.insert(all.end(), {&CornerNoise::field_px, &CornerNoise::field_length_m});
  if (parts_.motion) all.insert(all.end(), {&CornerNoise::motion_rad, &CornerNoise::motion_m});
  if (parts_.baseline_motion) all.push_back(&CornerNoise::motion_baseline_m);
  if (parts_.shape) {
    all.insert(all.end(), {&CornerNoise::shape_plane_m, &CornerNoise::shape_height_m});
  }
  return all;
}

VectorXd RestrictedLikelihood::logs(const CornerNoise& noise) const {
  const auto all = components();
  VectorXd logs(static_cast<Index>(all.size()));
  for (std::size_t i = 0; i < all.size(); ++i)
    logs[static_cast<Index>(i)] = std::log(noise.*all[i]);
  return logs;
}

CornerNoise RestrictedLikelihood::noise(const VectorXd& logs) const {
  const auto all = components();
  CornerNoise noise;
  for (std::size_t i = 0; i < all.size(); ++i)
    noise.*all[i] = std::exp(logs[static_cast<Index>(i)]);
  return noise;
}

VectorXd RestrictedLikelihood::shape_variances(const CornerNoise& noise) const {
  VectorXd variances(linear_.unknowns.shape);
  for (Index i = 0; i < variances.size(); ++i) {
    const double s = i % 3 < 2 ? noise.shape_plane_m : noise.shape_height_m;
    variances[i] = s * s;
  }
  return variances;
}

VectorXd RestrictedLikelihood::motion_variances(const CornerNoise& noise) const {
  return motion_sigmas(noise, linear_.unknowns.motion).cwiseAbs2();
}

namespace {

/// Of the further cameras in a frame that another sees too. The residuals are predictions minus
/// pixels, so that a motion u adds −M u to them. Of the fixed effect β = −G⁻¹ h, with G = Mᵀ P M
/// and h = Mᵀ P r = −Σ_x⁻¹ û, the covariance is G⁻¹, and G⁻¹ − Σ_x if nothing moved in this frame.
void add_motions(const LinearFrame& linear,
                 const FrameEquations& frame,
                 const Unknowns& unknowns,
                 const ScaledFactor& S,
                 const VectorXd& z,
                 const VectorXd& variances,
                 std::vector<FrameMotion>& motions) {
  if (linear.views.size() < 2) return;
  const VectorXd predicted = frame.own(unknowns, z);
  const MatrixXd XWX =
      frame.products.block(unknowns.rig, unknowns.rig, unknowns.own(), unknowns.own());
  for (const LinearView& view : linear.views) {
    if (view.camera == 0) continue;
    const Index at = 6 * (view.camera - 1);
    const auto XWM = XWX.middleCols<6>(at);
    const MatrixXd TXWM = frame.T.solve(MatrixXd(XWM));
    const MatrixXd AQM = frame.H.middleCols<6>(at) - frame.H * TXWM;
    const MatrixXd G =
        XWX.block<6, 6>(at, at) - XWM.transpose() * TXWM - AQM.transpose() * S.solve(AQM);
    const Eigen::Matrix<double, 6, 1> s = variances.segment<6>(at);
    FrameMotion& motion = motions.emplace_back();
    motion.frame = linear.frame;
    motion.camera = view.camera;
    motion.predicted = predicted.segment<6>(at);
    MatrixXd C = solve_symmetric(G, MatrixXd(MatrixXd::Identity(6, 6)));
    const VectorXd beta = C * motion.predicted.cwiseQuotient(s);
    C.diagonal() -= s;
    motion.chi2 = beta.dot(solve_symmetric(C, beta));
    motion.predicted.tail<3>().applyOnTheLeft(
        linear.motion_axes[static_cast<std::size_t>(view.camera - 1)]);
  }
}

}  // namespace

/// S, without priors, with the frames' own unknowns eliminated.
ReducedNormalEquations RestrictedLikelihood::sum_of(
    const std::vector<FieldCovariance>& fields, const std::vector<FrameEquations>& frames) const {
  const Unknowns& n = linear_.unknowns;
  const auto count = static_cast<Index>(frames.size());
  ReducedNormalEquations sum;
  MatrixXd& S = sum.information;
  S = MatrixXd::Zero(n.common(), n.common());
  sum.scores.resize(n.common(), count);
  MatrixXd HL(n.common(), n.own() * count);
  VectorXd by_motion = VectorXd::Zero(n.common());
  for (Index f = 0; f < count; ++f) {
    const FrameEquations& frame = frames[static_cast<std::size_t>(f)];
    S.topLeftCorner(n.rig, n.rig) += frame.products.topLeftCorner(n.rig, n.rig);
    S.topRightCorner(n.rig, n.shape) += frame.by_shape.topRows(n.rig);
    HL.middleCols(n.own() * f, n.own()) = frame.HL;
    by_motion += frame.HL.leftCols(n.motion).rowwise().squaredNorm();
    sum.scores.col(f) = frame.score;
    sum.frame_chi2.push_back(frame.chi2);
    sum.chi2 += frame.chi2;
  }
  S.bottomLeftCorner(n.shape, n.rig) = S.topRightCorner(n.rig, n.shape).transpose();
  for (std::size_t k = 0; n.shape > 0 && k < fields.size(); ++k) {
    const PointSet& set = linear_.sets[k];
    add_shape_block(set.ids, set.shape_products, fields[k].inverse, n.rig, S);
  }
  sum.held_poses_diagonal = S.diagonal() - by_motion;
  S.selfadjointView<Eigen::Lower>().rankUpdate(HL, -1);
  S.triangularView<Eigen::StrictlyUpper>() = S.transpose();
  sum.residuals = static_cast<int>(coordinates());
  return sum;
}

std::vector<MatrixXd> RestrictedLikelihood::frame_information(
    const std::vector<FieldCovariance>& fields, const std::vector<FrameEquations>& frames) const {
  const Unknowns& n = linear_.unknowns;
  std::vector<MatrixXd> all;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    MatrixXd S = MatrixXd::Zero(n.common(), n.common());
    S.topLeftCorner(n.rig, n.rig) = frames[f].products.topLeftCorner(n.rig, n.rig);
    S.topRightCorner(n.rig, n.shape) = frames[f].by_shape.topRows(n.rig);
    S.bottomLeftCorner(n.shape, n.rig) = frames[f].by_shape.topRows(n.rig).transpose();
    for (const LinearView& view : linear_.frames[f].views) {
      if (n.shape == 0) break;
      add_shape_block(linear_.sets[view.set].ids, shape_products(view.by_point),
                      fields[view.set].inverse, n.rig, S);
    }
    all.push_back(S - frames[f].HL * frames[f].HL.transpose());
  }
  return all;
}

/// Adds the terms of rig and shape: their prior, and what a shape at which the frames are
/// linearised pulls.
void RestrictedLikelihood::add_priors(const VectorXd& shape_variances,
                                      ReducedNormalEquations& sum,
                                      VectorXd& score) const {
  const Index common = linear_.unknowns.common(), shape = linear_.unknowns.shape;
  sum.prior_information = MatrixXd::Zero(common, common);
  if (prior_.information.size() > 0) {
    const Index n = prior_.information.rows();
    sum.prior_information.topLeftCorner(n, n) = prior_.information;
    score.head(n) += prior_.score;
  }
  sum.prior_information.diagonal().tail(shape) = shape_variances.cwiseInverse();
  sum.information += sum.prior_information;
  score.tail(shape) += shape_m_.cwiseQuotient(shape_variances);
}

VectorXd RestrictedLikelihood::gradient(const std::vector<FieldCovariance>& fields,
                                        const std::vector<FrameEquations>& frames,
                                        const MatrixXd& S_inverse,
                                        const VectorXd& z,
                                        const CornerNoise& noise) const {
  const LikelihoodGradient by = likelihood_gradient(linear_, fields, frames, S_inverse, z, noise);
  VectorXd gradient(static_cast<Index>(components().size()));
  Index k = 0;
  gradient[k++] = by.field[0];
  if (parts_.field) {
    gradient[k++] = by.field[1];
    gradient[k++] = by.field[2];
  }
  if (parts_.motion) {
    gradient[k++] = by.motion[0];
    gradient[k++] = parts_.baseline_motion ? by.motion[1] : by.motion[1] + by.motion[2];
    if (parts_.baseline_motion) gradient[k++] = by.motion[2];
  }
  if (!parts_.shape) return gradient;
  gradient.tail<2>().setZero();
  const Index shape = linear_.unknowns.shape;
  const VectorXd variances = shape_variances(noise);
  const VectorXd moments =
      S_inverse.diagonal().tail(shape) + (shape_m_ + z.tail(shape)).cwiseAbs2();
  for (Index i = 0; i < shape; ++i) {
    gradient[k + (i % 3 < 2 ? 0 : 1)] += 2 * (1 - moments[i] / variances[i]);
  }
  return gradient;
}

/// Of the components that are there.
MatrixXd RestrictedLikelihood::information(const std::vector<FieldCovariance>& fields,
                                           const std::vector<FrameEquations>& frames,
                                           const ScaledFactor& S,
                                           const VectorXd& z,
                                           const CornerNoise& noise) const {
  std::vector<Index> there{0};
  if (parts_.field) there.insert(there.end(), {1, 2});
  if (parts_.motion) there.insert(there.end(), {3, 4});
  if (parts_.baseline_motion) there.push_back(5);
  if (parts_.shape) there.insert(there.end(), {6, 7});
  const VectorXd shape_m = shape_m_ + z.tail(linear_.unknowns.shape);
  MatrixXd all = average_information(linear_, fields, frames, S, z, shape_m, noise);
  if (parts_.motion && !parts_.baseline_motion) {  // s_t is that of both
    all.row(4) += all.row(5);
    all.col(4) += all.col(5);
  }
  return all(there, there);
}

NoiseSolution RestrictedLikelihood::at(const CornerNoise& noise, Want want) const {
  const Unknowns& unknowns = linear_.unknowns;
  const VectorXd variances = shape_variances(noise), of_motion = motion_variances(noise);
  VectorXd own_information = VectorXd::Zero(unknowns.own());
  own_information.head(unknowns.motion) = of_motion.cwiseInverse();
  const std::vector<FieldCovariance> fields = field_covariances(linear_.sets, noise, parts_.field);
  std::vector<FrameEquations> frames;
  NoiseSolution result;
  for (const LinearFrame& frame : linear_.frames) {
    frames.push_back(frame_equations(frame, unknowns, linear_.sets, fields, own_information));
    result.minus_two_log += frames.back().T.log_determinant() + of_motion.array().log().sum();
  }
  for (std::size_t k = 0; k < fields.size(); ++k) {
    result.minus_two_log += linear_.sets[k].coordinates * fields[k].log_determinant;
  }
  ReducedNormalEquations& sum = result.equations;
  sum = sum_of(fields, frames);
  VectorXd score = sum.scores.rowwise().sum();
  add_priors(variances, sum, score);
  const ScaledFactor S(sum.information, "the rig");
  result.step = -S.solve(score);
  result.minus_two_log += S.log_determinant() + variances.array().log().sum() + sum.chi2 +
                          shape_m_.cwiseAbs2().cwiseQuotient(variances).sum() +
                          score.dot(result.step);
  if (want != Want::step) {
    result.gradient = gradient(fields, frames, S.inverse(), result.step, noise);
    result.information = information(fields, frames, S, result.step, noise);
  }
  if (want == Want::gradient) return result;
  result.pose_steps.resize(6, static_cast<Index>(frames.size()));
  for (std::size_t f = 0; f < frames.size(); ++f) {
    result.pose_steps.col(static_cast<Index>(f)) = frames[f].own(unknowns, result.step).tail<6>();
  }
  if (want == Want::step) return result;
  sum.frame_information = frame_information(fields, frames);
  for (std::size_t f = 0; parts_.motion && f < frames.size(); ++f) {
    add_motions(linear_.frames[f], frames[f], unknowns, S, result.step, of_motion, result.motions);
  }
  return result;
}

}  // namespace vernier::internal
