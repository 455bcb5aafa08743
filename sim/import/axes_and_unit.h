// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

/// How the coordinates of a file become metres with z up, and why it is thought so.
struct AxesAndUnit {
  int up_axis = 2;  ///< 0 to 2: x, y, z
  double unit_m = 1;
  std::string up_because, unit_because;
};

/// What is given, else what the file says, else what the mesh looks like. Up is the only axis along
/// which walls end at floors within the building (inner_floors()); of sheets only if the signs of
/// its storeys, all folded into one where even_storeys() finds several, speak for it. Else it is
/// the axis for which two of three signs of the whole speak, which are walls that begin and end at
/// common heights, level surface at few heights, and the smallest height: if those of its storeys
/// speak for it too and walls do not end at floors along another, or it is low and wide. The
/// unit is that with which its storeys are 2.2 to 6 m high or, of a building of one, its height is
/// 2.2 to 22 m (1.8 to 60 m in metres, 2.2 to 60 m in millimetres), and 3 to 500 m its length.
/// Throws Error, asking, where that does not decide.
AxesAndUnit axes_and_unit(const Mesh& mesh,
                          std::optional<int> given_up,
                          std::optional<double> given_unit_m,
                          const std::string& place);

/// The mesh in metres, z up.
Mesh upright(Mesh mesh, const AxesAndUnit& axes);

}  // namespace vernier::sim::internal
