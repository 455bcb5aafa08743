// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

/// Eigen's kernels for products of dense matrices of doubles, compiled once (eigen_kernels.cpp)
/// instead of in every source that multiplies two matrices. It stands in the precompiled header of
/// the libraries and of the tests; without it everything compiles as well, only more slowly. The
/// names are those of Eigen 3.4.
#if EIGEN_VERSION_AT_LEAST(3, 4, 0) && !EIGEN_VERSION_AT_LEAST(3, 4, 90)
#define VERNIER_EIGEN_KERNELS(KIND)                                                                \
  KIND struct gebp_kernel<double, double, Index, VernierOut, VernierKernel::mr, VernierKernel::nr, \
                          false, false>;                                                           \
  KIND struct gemm_pack_lhs<double, Index, VernierIn<ColMajor>, VernierKernel::mr,                 \
                            VernierKernel::LhsProgress, VernierKernel::LhsPacket4Packing,          \
                            ColMajor, false, false>;                                               \
  KIND struct gemm_pack_lhs<double, Index, VernierIn<RowMajor>, VernierKernel::mr,                 \
                            VernierKernel::LhsProgress, VernierKernel::LhsPacket4Packing,          \
                            RowMajor, false, false>;                                               \
  KIND struct gemm_pack_rhs<double, Index, VernierIn<ColMajor>, VernierKernel::nr, ColMajor,       \
                            false, false>;                                                         \
  KIND struct gemm_pack_rhs<double, Index, VernierIn<RowMajor>, VernierKernel::nr, RowMajor,       \
                            false, false>;                                                         \
  KIND struct general_matrix_vector_product<Index, double, VernierIn<ColMajor>, ColMajor, false,   \
                                            double, VernierIn<RowMajor>, false, 0>;                \
  KIND struct general_matrix_vector_product<Index, double, VernierIn<ColMajor>, ColMajor, false,   \
                                            double, VernierIn<ColMajor>, false, 0>;                \
  KIND struct general_matrix_vector_product<Index, double, VernierIn<RowMajor>, RowMajor, false,   \
                                            double, VernierIn<ColMajor>, false, 0>;                \
  KIND struct general_matrix_vector_product<Index, double, VernierIn<RowMajor>, RowMajor, false,   \
                                            double, VernierIn<RowMajor>, false, 0>

namespace Eigen::internal {

using VernierKernel = gebp_traits<double, double>;
template <int order>
using VernierIn = const_blas_data_mapper<double, Index, order>;
using VernierOut = blas_data_mapper<double, Index, ColMajor, Unaligned, 1>;

VERNIER_EIGEN_KERNELS(extern template);

}  // namespace Eigen::internal
#endif
