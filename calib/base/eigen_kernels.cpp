// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/eigen_kernels.h"

#ifdef VERNIER_EIGEN_KERNELS
namespace Eigen::internal {

VERNIER_EIGEN_KERNELS(template);

}  // namespace Eigen::internal
#endif
