// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "calib/base/json_reader.h"
#include "calib/error.h"
#include "calib/mrcal/mrcal_uncertainty.h"

namespace vernier::internal {
namespace {

using AnswerJson = nlohmann::ordered_json;

/// The script writes null for NaN.
double number(const AnswerJson& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

template <int N>
Eigen::Matrix<double, N, N> square(const AnswerJson& json) {
  Eigen::Matrix<double, N, N> M;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) M(i, j) = number(json.at(i).at(j));
  }
  return M;
}

MrcalUncertaintyAnswer answer_of(const AnswerJson& json) {
  MrcalUncertaintyAnswer answer;
  answer.version = json.at("version").get<std::string>();
  for (const AnswerJson& matrices : json.at("projection")) {
    answer.projection.emplace_back();
    for (const AnswerJson& matrix : matrices) answer.projection.back().push_back(square<2>(matrix));
  }
  for (const AnswerJson& query : json.at("triangulation")) {
    MrcalTriangulationAnswer& to = answer.triangulation.emplace_back();
    for (const AnswerJson& p : query.at("points")) {
      to.points_m.emplace_back(number(p.at(0)), number(p.at(1)), number(p.at(2)));
    }
    for (const AnswerJson& matrix : query.at("calibration"))
      to.calibration.push_back(square<3>(matrix));
    for (const AnswerJson& matrix : query.at("observation"))
      to.observation.push_back(square<3>(matrix));
  }
  return answer;
}

/// Whether every query has an answer of the right size.
bool complete(const MrcalUncertaintyAnswer& answer, const MrcalUncertaintyProblem& problem) {
  bool all = answer.projection.size() == problem.projection.size() &&
             answer.triangulation.size() == problem.triangulation.size();
  for (std::size_t q = 0; all && q < answer.projection.size(); ++q) {
    all = answer.projection[q].size() == problem.projection[q].points.size();
  }
  for (std::size_t q = 0; all && q < answer.triangulation.size(); ++q) {
    const std::size_t pairs = problem.triangulation[q].pairs.size();
    all = answer.triangulation[q].points_m.size() == pairs &&
          answer.triangulation[q].calibration.size() == pairs &&
          answer.triangulation[q].observation.size() == pairs;
  }
  return all;
}

}  // namespace

MrcalUncertaintyAnswer parse_mrcal_answer(std::string_view text,
                                          const MrcalUncertaintyProblem& problem) {
  const Error broken("mrcal", "its Python script gave an unexpected answer", "leave mrcal out");
  try {
    MrcalUncertaintyAnswer answer = answer_of(parse_json(text, "mrcal's answer"));
    if (complete(answer, problem)) return answer;
  } catch (const AnswerJson::exception&) {
    throw broken;
  } catch (const Error&) {
    throw broken;
  }
  throw broken;
}

}  // namespace vernier::internal
