// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <vector>

#include "calib/noise/corner_noise.h"
#include "calib/noise/field_spectrum.h"
#include "calib/noise/frame_rows.h"
#include "calib/noise/rig_knowledge.h"
#include "calib/noise/rotated_frame.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {

/// Motion of the board before the exposure of the second camera, in one frame, relative to the
/// first exposure; the first three of each are a rotation about the centre of the corners (rad),
/// the others a translation (m), along the axes of the first camera.
struct FrameMotion {
  int frame = 0;
  Eigen::Matrix<double, 6, 1> predicted;  ///< best linear prediction: shrunk by its prior
  double chi2 = 0;                        ///< against none in this frame; 6 degrees of freedom
};

/// Generalised least squares at given components: A and S of the rig, then the board's shape.
struct NoiseSolution {
  double minus_two_log = 0;          ///< of the restricted likelihood, up to a constant
  Eigen::VectorXd gradient;          ///< of that, by the logarithms of the components
  Eigen::VectorXd step;              ///< of the rig's free directions, then of the shape
  Eigen::MatrixXd pose_steps;        ///< 6 x frames
  ReducedNormalEquations equations;  ///< whitened, poses and motion eliminated; prior included
  std::vector<FrameMotion> motions;  ///< of the second camera
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
/// of A with the prior variances of calib/noise/corner_noise.h. In the eigenvectors of the field
/// (calib/noise/field_spectrum.h) each V_f is diagonal but for six columns for each further camera,
/// and P_ff = diag − Z Zᵀ; nothing larger than corners x corners is formed.
class RestrictedLikelihood {
 public:
  /// `target_m`: the points of the board. `shape_m`: the shape at which the frames are linearised,
  /// x, y and z of each point (empty: flat). Throws Error for frames without views, or of one
  /// camera alone if there are motions.
  RestrictedLikelihood(std::vector<FrameRows> frames,
                       const std::vector<Eigen::Vector3d>& target_m,
                       NoiseParts parts,
                       RigKnowledge prior = {},
                       Eigen::VectorXd shape_m = {});

  const NoiseParts& parts() const { return parts_; }
  Eigen::Index rig_directions() const { return rig_; }
  std::size_t frames() const { return frames_.size(); }
  Eigen::Index coordinates() const;

  /// Logarithms of the components that are there, in the order of CornerNoise, and back.
  Eigen::VectorXd logs(const CornerNoise& noise) const;
  CornerNoise noise(const Eigen::VectorXd& logs) const;

  enum class Want {
    gradient,  ///< no pose steps
    step,      ///< no gradient and no motions
    solution   ///< everything
  };
  /// Throws Error if poses or rig are not determined.
  NoiseSolution at(const CornerNoise& noise, Want want) const;

 private:
  struct Frame {
    FrameRows rows;
    std::vector<std::size_t> spectra;  // one per view
  };

  std::vector<double CornerNoise::*> components() const;
  std::vector<FieldSpectrum> spectra_at(const CornerNoise& noise) const;
  std::vector<const FieldSpectrum*> of_views(const Frame& frame,
                                             const std::vector<FieldSpectrum>& spectra) const;
  Eigen::VectorXd shape_variances(const CornerNoise& noise) const;
  Eigen::VectorXd add_priors(const Eigen::VectorXd& shape_variances,
                             ReducedNormalEquations& sum) const;
  void add_gradient(const Frame& frame,
                    RotatedFrame f,
                    const Eigen::MatrixXd& rig_columns,
                    const Eigen::VectorXd& solution,
                    const std::vector<FieldSpectrum>& spectra,
                    const CornerNoise& noise,
                    NoiseSolution& result) const;

  std::vector<Frame> frames_;
  std::vector<std::vector<Eigen::Vector3d>> point_sets_;  // of the corners that a view shows
  NoiseParts parts_;
  RigKnowledge prior_;
  Eigen::VectorXd shape_m_;
  Eigen::Index rig_ = 0, shape_ = 0;
};

}  // namespace vernier::internal
