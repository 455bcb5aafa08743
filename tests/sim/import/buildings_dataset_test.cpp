// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Buildings of other people. Nothing of them tuned anything but the constants in storeys.cpp
// and route_proposal.cpp, which was looked at on Office_A and the two DAE.
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/base/atomic_file.h"
#include "sim/import/imported_world.h"
#include "sim/mesh_files/mesh_file.h"
#include "sim/routing/floor_plan.h"
#include "sim/routing/route_proposal.h"
#include "sim/world.h"
#include "tests/support/data_folder.h"
#include "tests/support/mesh_file_message.h"

namespace vernier::sim::internal {
namespace {

struct Building {
  const char* file;
  std::vector<std::string> leave_out;
  double top_m;
  double floors;                 // how many
  std::size_t segments, listed;  // at least and at most; in the list beside it, if there is one
  double route_m;                // at least
};

class Buildings : public ::testing::TestWithParam<Building> {};

TEST_P(Buildings, AreImportedWithARoute) {
  const auto data = vernier::test::data_folder();
  if (!data) GTEST_SKIP() << "VERNIER_DATA is not set";
  const Building& building = GetParam();
  const std::filesystem::path file = *data / "buildings" / building.file;
  const std::string ending = file.extension().string();
  if (ending != ".txt" && assimp_version().empty()) GTEST_SKIP() << "built without assimp";
  ImportOptions options;
  options.top_m = building.top_m;
  const ImportedWorld imported =
      import_world(read_mesh(file, {building.leave_out, 0}), options, building.file);
  const std::size_t segments = imported.world.loose.segments_m.size();
  EXPECT_EQ(static_cast<double>(imported.report.storeys_m.size()), building.floors);
  EXPECT_GT(segments, building.segments);
  EXPECT_LT(segments, building.listed + 1);
  const World world = build_world(imported.world);
  const RouteProposal proposal = propose_route(FloorPlan(world, 1.2));
  EXPECT_GT(route_length_m(proposal.route), building.route_m);
  EXPECT_GT(proposal.near_m2, 0.9 * proposal.floor_m2);
}

// Counts listed beside the data: 6186, 1320 and 697 (with edges in planes where triangles do not
// match, pieces of one line apart and door leaves); lists themselves lose what is joined or
// shorter.
INSTANTIATE_TEST_SUITE_P(
    All,
    Buildings,
    ::testing::Values(Building{"Office_A_20110811.ifc", {}, 2.55, 2, 5500, 6186, 150},
                      Building{"Office_A_20110811.ifc", {"ifcdoor"}, 2.55, 2, 4400, 6186, 600},
                      Building{"office.dae", {}, 2.55, 1, 1250, 1320, 120},
                      Building{"osrf_first_office.dae", {}, 2.55, 2, 600, 1200, 70},
                      Building{"office_a_L1.lines.txt", {}, 2.55, 0, 6100, 6186, 150},
                      Building{"cpr_office.lines.txt", {}, 2.55, 0, 1250, 1320, 100},
                      Building{"fzk_eg.lines.txt", {}, 2.55, 0, 3500, 3735, 20},
                      Building{"laas_grande_salle.lines.txt", {}, 2.55, 0, 4000, 4200, 80},
                      Building{"osrf_office.lines.txt", {}, 2.55, 0, 650, 697, 60}));

// assimp gave 90 of 7194 segments of a file without its last lines.
TEST(BuildingFiles, CutShortAreRefused) {
  const auto data = vernier::test::data_folder();
  if (!data) GTEST_SKIP() << "VERNIER_DATA is not set";
  if (assimp_version().empty()) GTEST_SKIP() << "built without assimp";
  const std::string whole =
      vernier::internal::read_whole(*data / "buildings" / "Office_A_20110811.ifc");
  for (const double share : {0.5, 0.99, 0.995, 0.9999}) {
    const auto bytes = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
    EXPECT_NE(
        vernier::test::mesh_file_message("cut.ifc", whole.substr(0, bytes)).find("is cut short"),
        std::string::npos)
        << share;
  }
}

}  // namespace
}  // namespace vernier::sim::internal
