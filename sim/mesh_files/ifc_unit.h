// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace vernier::sim::internal {

/// The unit of length of an IFC file (ISO 16739, in the text of ISO 10303-21) by the
/// IfcUnitAssignment of its project.
struct IfcLengthUnit {
  double metres = 1;
  bool is_si = true;  ///< metres with or without a prefix, not a unit by conversion such as a foot
};

/// Nothing where the file assigns no unit of length. Throws Error(place) where it assigns two, or
/// one that is not understood.
std::optional<IfcLengthUnit> ifc_length_unit(std::string_view text, const std::string& place);

}  // namespace vernier::sim::internal
