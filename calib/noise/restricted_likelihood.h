// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calib/noise/corner_noise.h"
#include "calib/noise/frame_rows.h"
#include "calib/noise/linear_frames.h"
#include "calib/noise/mixed_model.h"
#include "calib/noise/rig_knowledge.h"
#include "calib/noise/scaled_factor.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {

/// Motion of the board before the exposure of a further camera, in one frame, relative to that of
/// the first camera; the first three of each are a rotation about the centre of the corners (rad),
/// the others a translation (m), along the axes of the first camera.
struct FrameMotion {
  int frame = 0;
  int camera = 1;
  Eigen::Matrix<double, 6, 1> predicted;  ///< best linear prediction: shrunk by its prior
  double chi2 = 0;                        ///< against none in this frame; 6 degrees of freedom
};

/// Generalised least squares at given components: A and S of the rig, then the board's shape.
struct NoiseSolution {
  double minus_two_log = 0;          ///< of the restricted likelihood, up to a constant
  Eigen::VectorXd gradient;          ///< of that, by the logarithms of the components
  Eigen::MatrixXd information;       ///< in these (calib/noise/average_information.h)
  Eigen::VectorXd step;              ///< of the rig's free directions, then of the shape
  Eigen::MatrixXd pose_steps;        ///< 6 x frames
  ReducedNormalEquations equations;  ///< whitened, poses and motion eliminated; prior included
  /// Of every further camera in every frame that it sees and another sees too.
  std::vector<FrameMotion> motions;
};

/// The restricted likelihood (Patterson and Thompson 1971; Harville 1977) of the corner noise of a
/// linearised calibration r ~ N(A z + B_f b_f, V), with the rig z and a pose b_f in each frame
/// projected out:
///
///     −2 l = Σ ln|V_f| + Σ ln|B_fᵀ V_f⁻¹ B_f| + ln|S| + rᵀ P r
///     S = Σ A_fᵀ Q_f A_f,   Q = V⁻¹ − V⁻¹ B (Bᵀ V⁻¹ B)⁻¹ Bᵀ V⁻¹,   P = Q − Q A S⁻¹ Aᵀ Q
///     ∂(−2 l)/∂θ = tr(P ∂V/∂θ) − rᵀ P ∂V/∂θ P r
///
/// Priors of the rig add to S, and so does that of a shape, which is a random effect: columns D_f
/// of A with the prior variances of calib/noise/corner_noise.h. It is evaluated by the mixed model
/// equations, in which the motion is a random effect too (Graser, Smith and Tier 1987): with
/// R = w² I + g² K of each view and coordinate and T_f of calib/noise/mixed_model.h,
///
///     ln|V_f| + ln|B_fᵀ V_f⁻¹ B_f| = ln|R_f| + ln|T_f| + Σ ln(s_r², s_t²)
///
/// so that nothing larger than S is formed.
class RestrictedLikelihood {
 public:
  /// `target_m`: the points of the board. `shape_m`: the shape at which the frames are linearised,
  /// x, y and z of each point (empty: flat). Throws Error for frames without views, or of one
  /// camera alone if there are motions.
  RestrictedLikelihood(const std::vector<FrameRows>& frames,
                       const std::vector<Eigen::Vector3d>& target_m,
                       NoiseParts parts,
                       RigKnowledge prior = {},
                       Eigen::VectorXd shape_m = {});

  const NoiseParts& parts() const { return parts_; }
  Eigen::Index rig_directions() const { return linear_.unknowns.rig; }
  std::size_t frames() const { return linear_.frames.size(); }
  Eigen::Index coordinates() const;

  /// Logarithms of the components that are there, in the order of CornerNoise, and back.
  Eigen::VectorXd logs(const CornerNoise& noise) const;
  CornerNoise noise(const Eigen::VectorXd& logs) const;

  enum class Want {
    gradient,  ///< no pose steps, no motions, no information of each frame
    step,      ///< pose steps; no gradient, no motions, no information of each frame
    solution   ///< everything
  };
  /// All components that are there must be above 0. Throws Error if poses or rig are not
  /// determined.
  NoiseSolution at(const CornerNoise& noise, Want want) const;

 private:
  std::vector<double CornerNoise::*> components() const;
  Eigen::VectorXd shape_variances(const CornerNoise& noise) const;
  Eigen::VectorXd motion_variances(const CornerNoise& noise) const;
  void add_priors(const Eigen::VectorXd& shape_variances,
                  ReducedNormalEquations& sum,
                  Eigen::VectorXd& score) const;
  ReducedNormalEquations sum_of(const std::vector<FieldCovariance>& fields,
                                const std::vector<FrameEquations>& frames) const;
  std::vector<Eigen::MatrixXd> frame_information(const std::vector<FieldCovariance>& fields,
                                                 const std::vector<FrameEquations>& frames) const;
  Eigen::VectorXd gradient(const std::vector<FieldCovariance>& fields,
                           const std::vector<FrameEquations>& frames,
                           const Eigen::MatrixXd& S_inverse,
                           const Eigen::VectorXd& z,
                           const CornerNoise& noise) const;
  Eigen::MatrixXd information(const std::vector<FieldCovariance>& fields,
                              const std::vector<FrameEquations>& frames,
                              const ScaledFactor& S,
                              const Eigen::VectorXd& z,
                              const CornerNoise& noise) const;

  NoiseParts parts_;
  RigKnowledge prior_;
  Eigen::VectorXd shape_m_;
  LinearFrames linear_;
};

}  // namespace vernier::internal
