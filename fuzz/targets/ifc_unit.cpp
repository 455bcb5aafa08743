// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/mesh_files/ifc_unit.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

using sim::internal::ifc_length_unit;
using sim::internal::IfcLengthUnit;

void run_ifc_unit(std::string_view bytes) {
  const std::string text(bytes);
  const auto unit = accepted([&] { return ifc_length_unit(text, "building.ifc"); });
  if (!unit) return;
  require(!*unit || ((*unit)->metres >= 1e-18 && (*unit)->metres <= 1e18), "a unit is a length");
  // What a comment hides at the start of a file says nothing of its units.
  const auto commented = accepted(
      [&] { return ifc_length_unit("/* #1=IFCUNITASSIGNMENT((#2)); '*/" + text, "building.ifc"); });
  require(commented.has_value(), "a comment is never a fault");
  require(commented->has_value() == unit->has_value(), "a comment changes nothing");
  if (!*unit) return;
  require((*commented)->metres == (*unit)->metres && (*commented)->is_si == (*unit)->is_si,
          "a comment does not change the unit");
}

std::vector<std::string> ifc_unit_seeds() {
  const std::string head =
      "ISO-10303-21;\nDATA;\n#1=IFCPROJECT('x',$,'it''s',$,$,$,$,(#9),#2);\n"
      "#2=IFCUNITASSIGNMENT((#3,#4));\n#4=IFCSIUNIT(*,.PLANEANGLEUNIT.,$,.RADIAN.);\n";
  return {head + "#3=IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.);\nENDSEC;\n",
          head + "#3=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);\n",
          head +
              "#3=IFCCONVERSIONBASEDUNIT(#5,.LENGTHUNIT.,'FOOT',#6);\n"
              "#6=IFCMEASUREWITHUNIT(IFCLENGTHMEASURE(0.3048),#7);\n/* of */\n"
              "#7=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);\n"};
}

const Registered registered_ifc_unit{{"ifc_unit", 2000, "ifc", run_ifc_unit, ifc_unit_seeds}};

}  // namespace
}  // namespace vernier::fuzz
