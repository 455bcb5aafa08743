// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace vernier::internal {

/// Degrees of freedom ν of the scale of a covariance from the scatter of so many clusters (frames,
/// image pairs): 4 a cluster but one, chosen on simulated sets between smooth errors within a
/// cluster (3) and white noise (6).
inline double scatter_dof(double clusters) { return 4 * (clusters - 1); }

/// The variance of Student's t with ν degrees of freedom, which an error over an estimated standard
/// deviation has.
inline double student_variance(double dof) { return dof / (dof - 2); }

}  // namespace vernier::internal
