// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/restricted_likelihood.h"

#include <cmath>
#include <string>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/error.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/field_spectrum.h"
#include "calib/noise/frame_rows.h"
#include "calib/noise/rig_knowledge.h"
#include "calib/noise/rotated_frame.h"
#include "calib/noise/scaled_factor.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

RestrictedLikelihood::RestrictedLikelihood(std::vector<FrameRows> frames,
                                           const std::vector<Eigen::Vector3d>& target_m,
                                           NoiseParts parts,
                                           RigKnowledge prior,
                                           Eigen::VectorXd shape_m)
    : parts_(parts), prior_(std::move(prior)), shape_m_(std::move(shape_m)) {
  std::map<std::vector<int>, std::size_t> sets;
  for (FrameRows& rows : frames) {
    if (rows.views.empty()) throw Error("corner noise", "a frame without views", "leave it out");
    Frame frame{std::move(rows), {}};
    for (const ViewRows& view : frame.rows.views) {
      const auto [at, is_new] = sets.try_emplace(view.ids, point_sets_.size());
      if (is_new) {
        auto& points = point_sets_.emplace_back();
        for (const int id : view.ids) points.push_back(target_m[static_cast<std::size_t>(id)]);
      }
      frame.spectra.push_back(at->second);
    }
    frames_.push_back(std::move(frame));
  }
  if (frames_.empty()) throw Error("corner noise", "no frames", "give views of a board");
  rig_ = frames_[0].rows.by_rig.cols();
  if (frames_[0].rows.by_motion.cols() == 0) parts_.motion = false;
  if (parts_.shape) shape_ = 3 * static_cast<Index>(target_m.size());
  if (shape_m_.size() == 0) shape_m_ = VectorXd::Zero(shape_);
}

Index RestrictedLikelihood::coordinates() const {
  Index sum = 0;
  for (const Frame& frame : frames_) sum += frame.rows.residual_px.size();
  return sum;
}

std::vector<double CornerNoise::*> RestrictedLikelihood::components() const {
  std::vector<double CornerNoise::*> all{&CornerNoise::white_px};
  if (parts_.field) all.insert(all.end(), {&CornerNoise::field_px, &CornerNoise::field_length_m});
  if (parts_.motion) all.insert(all.end(), {&CornerNoise::motion_rad, &CornerNoise::motion_m});
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

std::vector<FieldSpectrum> RestrictedLikelihood::spectra_at(const CornerNoise& noise) const {
  std::vector<FieldSpectrum> spectra;
  for (std::size_t s = 0; parts_.field && s < point_sets_.size(); ++s) {
    spectra.push_back(field_spectrum(point_sets_[s], noise.field_length_m));
  }
  return spectra;
}

VectorXd RestrictedLikelihood::shape_variances(const CornerNoise& noise) const {
  VectorXd variances(shape_);
  for (Index i = 0; i < shape_; ++i) {
    const double s = i % 3 < 2 ? noise.shape_plane_m : noise.shape_height_m;
    variances[i] = s * s;
  }
  return variances;
}

namespace {

/// tr(Uᵀ K' U P_ff) − eᵀ Uᵀ K' U e over the views: the derivative by ln ℓ over g².
double by_log_length(const FrameRows& rows,
                     const RotatedFrame& f,
                     const VectorXd& e,
                     const std::vector<const FieldSpectrum*>& spectra) {
  double sum = 0;
  for (std::size_t v = 0; v < rows.views.size(); ++v) {
    const MatrixXd& by = spectra[v]->by_log_length;
    const Index n = by.rows();
    for (int uv = 0; uv < 2; ++uv) {
      const Index first = rows.views[v].first + uv * n;
      const MatrixXd Z = f.Z.middleRows(first, n);
      const VectorXd part = e.segment(first, n);
      sum += f.weights.segment(first, n).dot(by.diagonal()) - (by * Z).cwiseProduct(Z).sum() -
             part.dot(by * part);
    }
  }
  return sum;
}

/// The motion of one frame by G = Mᵀ P M and h = Mᵀ P r. The residuals are predictions minus
/// pixels, so that a motion u adds −M u to them. Of the fixed effect β = −G⁻¹ h the covariance is
/// G⁻¹, and G⁻¹ − S if nothing moved in this frame.
FrameMotion motion_of(int frame, const MatrixXd& G, const VectorXd& h, const CornerNoise& noise) {
  FrameMotion motion;
  motion.frame = frame;
  Eigen::Matrix<double, 6, 1> S;
  S << Eigen::Vector3d::Constant(noise.motion_rad * noise.motion_rad),
      Eigen::Vector3d::Constant(noise.motion_m * noise.motion_m);
  motion.predicted = -S.cwiseProduct(h.head<6>());
  MatrixXd C =
      solve_symmetric(MatrixXd(G.topLeftCorner<6, 6>()), MatrixXd(MatrixXd::Identity(6, 6)));
  const VectorXd beta = C * h.head<6>();
  C.diagonal() -= S;
  motion.chi2 = beta.dot(solve_symmetric(C, beta));
  return motion;
}

}  // namespace

void RestrictedLikelihood::add_gradient(const Frame& frame,
                                        RotatedFrame f,
                                        const MatrixXd& rig_columns,
                                        const VectorXd& solution,
                                        const std::vector<FieldSpectrum>& spectra,
                                        const CornerNoise& noise,
                                        NoiseSolution& result) const {
  f.project_out(rig_columns);
  const VectorXd e = f.Qr + f.QA * solution;  // (P r)_f
  const VectorXd excess = f.weights - f.Z.rowwise().squaredNorm() - e.cwiseAbs2();
  Index k = 0;
  result.gradient[k++] += 2 * noise.white_px * noise.white_px * excess.sum();
  if (parts_.field) {
    result.gradient[k++] += 2 * f.field.dot(excess);
    result.gradient[k++] +=
        noise.field_px * noise.field_px * by_log_length(frame.rows, f, e, of_views(frame, spectra));
  }
  if (!parts_.motion) return;
  const MatrixXd G = f.M.transpose() * f.times(f.M);
  const VectorXd h = f.M.transpose() * e;
  for (Index m = 0; m < h.size(); ++m) {
    const bool turns = m % 6 < 3;
    const double s = turns ? noise.motion_rad : noise.motion_m;
    result.gradient[k + (turns ? 0 : 1)] += 2 * s * s * (G(m, m) - h[m] * h[m]);
  }
  result.motions.push_back(motion_of(frame.rows.frame, G, h, noise));
}

std::vector<const FieldSpectrum*> RestrictedLikelihood::of_views(
    const Frame& frame, const std::vector<FieldSpectrum>& spectra) const {
  std::vector<const FieldSpectrum*> of_views;
  for (const std::size_t s : frame.spectra)
    of_views.push_back(parts_.field ? &spectra[s] : nullptr);
  return of_views;
}

/// Adds the terms of rig and shape: their prior, and what a shape at which the frames are
/// linearised pulls.
VectorXd RestrictedLikelihood::add_priors(const VectorXd& shape_variances,
                                          ReducedNormalEquations& sum) const {
  VectorXd score = sum.scores.rowwise().sum();
  sum.prior_information = MatrixXd::Zero(rig_ + shape_, rig_ + shape_);
  if (prior_.information.size() > 0) {
    const Index n = prior_.information.rows();
    sum.prior_information.topLeftCorner(n, n) = prior_.information;
    score.head(n) += prior_.score;
  }
  sum.prior_information.diagonal().tail(shape_) = shape_variances.cwiseInverse();
  sum.information += sum.prior_information;
  score.tail(shape_) += shape_m_.cwiseQuotient(shape_variances);
  return score;
}

NoiseSolution RestrictedLikelihood::at(const CornerNoise& noise, Want want) const {
  const std::vector<FieldSpectrum> spectra = spectra_at(noise);
  NoiseSolution result;
  ReducedNormalEquations& sum = result.equations;
  sum.information = MatrixXd::Zero(rig_ + shape_, rig_ + shape_);
  sum.held_poses_diagonal = VectorXd::Zero(rig_ + shape_);
  sum.scores = MatrixXd::Zero(rig_ + shape_, static_cast<Index>(frames_.size()));
  std::vector<RotatedFrame> rows;
  for (const Frame& frame : frames_) {
    const RotatedFrame& f = rows.emplace_back(
        rotated_frame(frame.rows, noise, of_views(frame, spectra), parts_.motion, shape_));
    sum.frame_information.emplace_back(f.A.transpose() * f.QA);
    sum.information += sum.frame_information.back();
    sum.held_poses_diagonal +=
        sum.frame_information.back().diagonal() +
        (f.Z.rightCols<6>().transpose() * f.A).colwise().squaredNorm().transpose();
    sum.scores.col(static_cast<Index>(rows.size()) - 1) = f.A.transpose() * f.Qr;
    sum.frame_chi2.push_back(f.r.dot(f.Qr));
    sum.chi2 += sum.frame_chi2.back();
    sum.residuals += static_cast<int>(f.r.size());
    result.minus_two_log += f.log_determinants;
  }
  const VectorXd variances = shape_variances(noise);
  const VectorXd score = add_priors(variances, sum);
  const ScaledFactor S(sum.information, "the rig");
  result.step = -S.solve(score);
  result.minus_two_log += S.log_determinant() + variances.array().log().sum() + sum.chi2 +
                          shape_m_.cwiseAbs2().cwiseQuotient(variances).sum() +
                          score.dot(result.step);
  result.gradient = VectorXd::Zero(static_cast<Index>(components().size()));
  for (std::size_t i = 0; want != Want::step && i < frames_.size(); ++i) {
    add_gradient(frames_[i], rows[i], S.times_inverse_upper(rows[i].QA), result.step, spectra,
                 noise, result);
  }
  if (parts_.shape && want != Want::step) {
    const VectorXd spread =
        S.inverse().diagonal().tail(shape_) + (shape_m_ + result.step.tail(shape_)).cwiseAbs2();
    const Index at = result.gradient.size() - 2;
    for (Index i = 0; i < shape_; ++i) {
      result.gradient[at + (i % 3 < 2 ? 0 : 1)] += 2 * (1 - spread[i] / variances[i]);
    }
  }
  if (want == Want::gradient) return result;
  result.pose_steps.resize(6, static_cast<Index>(frames_.size()));
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const RotatedFrame& f = rows[i];
    const VectorXd pull = f.ViB.transpose() * (f.r + f.A * result.step);
    result.pose_steps.col(static_cast<Index>(i)) =
        -f.pose_inverse_root * (f.pose_inverse_root.transpose() * pull);
  }
  return result;
}

}  // namespace vernier::internal
