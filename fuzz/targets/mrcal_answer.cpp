// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "calib/mrcal/mrcal_uncertainty.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

using namespace vernier::internal;
using Json = nlohmann::ordered_json;

/// Two points of one camera and a pair of pixels: nothing but their number matters to the answer.
const MrcalUncertaintyProblem& problem() {
  static const BoardObservations observations;
  static const BoardState state;
  static const MrcalUncertaintyProblem problem{.observations = observations,
                                               .state = state,
                                               .basis = {},
                                               .projection = {{.points = {{0, 0, 1}, {1, 0, 2}}}},
                                               .triangulation = {{.pairs = {PixelPair{}}}}};
  return problem;
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

template <int N>
Json rows(const Eigen::Matrix<double, N, N>& M) {
  Json json = Json::array();
  for (int i = 0; i < N; ++i) {
    json.push_back(Json::array());
    for (int j = 0; j < N; ++j) json.back().push_back(number(M(i, j)));
  }
  return json;
}

template <typename Matrix>
Json matrices(const std::vector<Matrix>& all) {
  Json json = Json::array();
  for (const Matrix& M : all) json.push_back(rows(M));
  return json;
}

/// As the script writes it.
std::string text_of(const MrcalUncertaintyAnswer& answer) {
  Json projection = Json::array(), triangulation = Json::array();
  for (const auto& query : answer.projection) projection.push_back(matrices(query));
  for (const MrcalTriangulationAnswer& query : answer.triangulation) {
    Json points = Json::array();
    for (const Eigen::Vector3d& p : query.points_m) {
      points.push_back({number(p.x()), number(p.y()), number(p.z())});
    }
    triangulation.push_back({{"points", points},
                             {"calibration", matrices(query.calibration)},
                             {"observation", matrices(query.observation)}});
  }
  return Json{
      {"version", answer.version}, {"projection", projection}, {"triangulation", triangulation}}
      .dump();
}

/// What the script about mrcal writes.
void run_mrcal_answer(std::string_view bytes) {
  const auto answer = accepted([&] { return parse_mrcal_answer(bytes, problem()); });
  if (!answer) return;
  require(answer->absent.empty(), "an answer is there");
  const std::string written = text_of(*answer);
  require(text_of(parse_mrcal_answer(written, problem())) == written,
          "what is written is read as the same");
}

std::vector<std::string> mrcal_answer_seeds() {
  const Eigen::Matrix2d of_pixel{{0.04, 0.01}, {0.01, 0.09}};
  const Eigen::Matrix3d of_point = Eigen::Vector3d(1e-6, 4e-6, 2.5e-3).asDiagonal();
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  MrcalUncertaintyAnswer answer;
  answer.version = "2.2";
  answer.projection = {{of_pixel, Eigen::Matrix2d::Constant(unknown)}};
  answer.triangulation = {{{{0.1, -0.2, 5}}, {of_point}, {of_point}}};
  std::vector<std::string> seeds{text_of(answer)};
  answer.triangulation.clear();  // not of this problem
  seeds.push_back(text_of(answer));
  return seeds;
}

const Registered registered_mrcal_answer{
    {"mrcal_answer", 1000, "answers", run_mrcal_answer, mrcal_answer_seeds}};

}  // namespace
}  // namespace vernier::fuzz
