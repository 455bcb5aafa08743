// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "calib/rig.h"
#include "fuzz/example_rigs.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/program_answer.h"
#include "sim/sources/program_source.h"
#include "sim/uncertainty_source.h"

namespace vernier::fuzz {
namespace {

using sim::SensedEdge;
using sim::SensedView;

/// Three upright edges 5 m ahead.
SensedView view() {
  SensedView view;
  for (int i = 0; i < 3; ++i) {
    SensedEdge edge;
    edge.truth.a_m = {0.5 * i - 0.5, -1, 5};
    edge.truth.b_m = {0.5 * i - 0.5, 1, 5};
    edge.truth.segment = edge.truth.feature = static_cast<std::uint32_t>(i);
    view.edges.push_back(edge);
  }
  return view;
}

/// What a program that is a source of errors answers to a view.
void run_source_answer(std::string_view bytes) {
  static const Rig rig = example_rig("radial1", 2);
  SensedView changed = view();
  const auto taken = accepted_answer(bytes, [&](const auto& said) {
    sim::internal::apply_answer(said, rig, changed);
    return true;
  });
  if (!taken) return;
  for (const SensedEdge& edge : changed.edges) {
    require(edge.truth.a_m.allFinite() && edge.truth.b_m.allFinite(), "edges are somewhere");
    for (int eye = 0; eye < 2; ++eye) {
      const auto at = static_cast<std::size_t>(eye);
      require(edge.offset_px[at][0].allFinite() && edge.offset_px[at][1].allFinite(),
              "displacements are finite");
    }
  }
}

std::vector<std::string> source_answer_seeds() {
  const std::string images = R"("left_px":[100,50,100,250],"right_px":[90,50,90,250])";
  return {R"({"edges":[]})", R"({"edges":[{"id":0},{"id":2,"in_stereo":false}]})",
          R"({"edges":[{"id":4,)" + images + "}]}",
          R"({"edges":[{"id":null,)" + images + "},{" + images + "}]}"};
}

const Registered registered_source_answer{
    {"source_answer", 1000, "views", run_source_answer, source_answer_seeds}};

}  // namespace
}  // namespace vernier::fuzz
