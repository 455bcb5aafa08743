// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/rig_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include "calib/base/atomic_file.h"
#include "calib/base/error_place.h"
#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/camera/rig_limits.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/estimate/covariance_check.h"
#include "calib/estimate/held_parameters.h"
#include "calib/formats/rig_json.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"

namespace vernier {

using namespace internal;

namespace {

using rig_json::Json;
using rig_json::Node;
using rig_json::to_json;

constexpr std::array<const char*, 9> known_keys{"format",          "version",     "cameras",
                                                "parameter_names", "parameters",  "covariance",
                                                "covariance_mvb",  "calibration", "evidence"};

/// Indices of the rig's parameters that the file lists: all, or some in the same order.
std::vector<Eigen::Index> parse_names(const Node& root, const Rig& rig) {
  const std::vector<std::string> all = parameter_names(rig);
  const std::vector<std::string> stated = rig_json::parse_texts(root, "parameter_names");
  std::vector<Eigen::Index> places;
  std::size_t next = 0;
  for (std::size_t i = 0; i < all.size() && next < stated.size(); ++i) {
    if (all[i] != stated[next]) continue;
    places.push_back(static_cast<Eigen::Index>(i));
    ++next;
  }
  if (next < stated.size() || stated.empty()) {
    throw Error(root.at("parameter_names").place(),
                "are not the rig's parameters in the rig's order",
                stated.empty()
                    ? "see docs/file-formats.md"
                    : fmt::format("check {}; see docs/file-formats.md", in_quotes(stated[next])));
  }
  return places;
}

/// parameters must repeat the cameras' values; a disagreement is an error.
void check_parameters(const Node& root, const Rig& rig, const std::vector<Eigen::Index>& listed) {
  const Node node = root.at("parameters");
  const Eigen::VectorXd stated = node.vector(), actual = parameters(rig);
  if (stated.size() != static_cast<Eigen::Index>(listed.size())) {
    throw Error(node.place(), fmt::format("{} values for {} names", stated.size(), listed.size()),
                "give one per name");
  }
  for (Eigen::Index i = 0; i < stated.size(); ++i) {
    const double value = actual[listed[i]];
    if (std::abs(stated[i] - value) > 1e-9 * (1 + std::abs(value))) {
      throw Error(node.place(),
                  fmt::format("{} is {} here and {} in cameras", parameter_names(rig)[listed[i]],
                              stated[i], value),
                  "make them agree");
    }
  }
}

/// One flag per parameter: true if it is not listed, hence held.
std::vector<bool> unlisted(const Rig& rig, const std::vector<Eigen::Index>& listed) {
  std::vector<bool> held(static_cast<std::size_t>(parameter_count(rig)), true);
  for (const Eigen::Index i : listed) held[static_cast<std::size_t>(i)] = false;
  return held;
}

/// The matrix at `node`, one row per listed parameter, in the tangent; zero for the others.
Eigen::MatrixXd parse_parameter_matrix(const Node& node,
                                       const Rig& rig,
                                       const std::vector<Eigen::Index>& listed) {
  const Node stated = node.at("matrix");
  const Eigen::MatrixXd matrix = stated.matrix();
  if (matrix.rows() != static_cast<Eigen::Index>(listed.size())) {
    throw Error(stated.place(),
                fmt::format("is {0}x{0} for {1} parameters", matrix.rows(), listed.size()),
                "give one row and column per parameter");
  }
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    if (matrix(i, i) >= 0) continue;
    throw Error(
        stated.place(),
        fmt::format("the variance of {} is {}",
                    parameter_names(rig)[static_cast<std::size_t>(listed[i])], matrix(i, i)),
        "give 0 or more");
  }
  rig_json::check_bounded(matrix, most_variance, stated);
  const std::vector<bool> held = unlisted(rig, listed);
  check_covariance(matrix, free_names(rig, held), stated.place());
  const Eigen::MatrixXd E = free_directions(rig, held);
  return E * matrix * E.transpose();
}

Covariance parse_covariance(const Node& node,
                            const Rig& rig,
                            const std::vector<Eigen::Index>& listed) {
  const Node kind = node.at("kind");
  CovarianceKind source{};
  try {
    source = covariance_kind(kind.text());
  } catch (const Error& error) {
    throw Error(kind.place(), error.place() + " is unknown", error.remedy());
  }
  return {source, parameter_names(rig), parse_parameter_matrix(node, rig, listed)};
}

/// Throws Error for a parameter that the calibration at `calibration` held, and that is listed with
/// a variance in the matrix at `covariance`.
void check_held(const std::vector<std::string>& held,
                const Node& calibration,
                const std::vector<std::string>& listed,
                const Node& covariance) {
  for (std::size_t i = 0; i < held.size(); ++i) {
    const auto found = std::find(listed.begin(), listed.end(), held[i]);
    if (found == listed.end()) continue;
    const auto row = static_cast<std::size_t>(found - listed.begin());
    if (covariance.at("matrix").at(row).at(row).number() == 0) continue;
    throw Error(calibration.at("held").at(i).place(),
                in_quotes(held[i]) + " has a variance in the covariance",
                "take it out of one of them");
  }
}

/// JSON has no NaN: it would be written as null, which a rig file may contain only for the residual
/// of an outlier whose frame was excluded too.
void require_finite(const Json& json, const std::string& place) {
  if (json.is_number_float() && !std::isfinite(json.get<double>())) {
    throw Error(place, "is not a finite number", "a rig file cannot hold it");
  }
  if (json.is_object()) {
    for (const auto& [key, value] : json.items()) {
      if (key != "residual_px") require_finite(value, place + "." + key);
    }
  } else if (json.is_array()) {
    for (std::size_t i = 0; i < json.size(); ++i) {
      require_finite(json[i], place + "[" + std::to_string(i) + "]");
    }
  }
}

/// Throws Error if the rig cannot have the estimate's covariances.
void check_covariances(const RigEstimate& estimate) {
  const auto check_one = [&](const Eigen::MatrixXd& matrix, const std::string& key) {
    const std::string place = "rig." + key + ".matrix";
    require_finite(to_json(matrix), place);
    check_covariance(matrix, estimate.rig, place);
  };
  if (estimate.covariance) {
    check_names(*estimate.covariance, estimate.rig, "rig.covariance");
    check_one(estimate.covariance->matrix, "covariance");
  }
  if (estimate.covariance_mvb) check_one(*estimate.covariance_mvb, "covariance_mvb");
}

/// A prior in the form of a rig file.
Json prior_json(const GaussianRigPrior& prior) {
  RigEstimate estimate;
  estimate.rig = prior.rig;
  estimate.covariance = full_covariance(prior);
  return Json::parse(format_rig(estimate, KeepEvidence::no));
}

std::vector<GaussianRigPrior> parse_priors(const Node& evidence);

}  // namespace

std::string stored_warning_prefix(const std::string& place) { return place + ": stored warning: "; }

namespace {

RigFile rig_of(const Json& json, const std::string& place) {
  const Node root(json, place + ":");
  if (!root.has("format") || root.at("format").text() != "vernier/rig") {
    throw Error(place, "is not a rig file: its format is not \"vernier/rig\"",
                "write one with vernier calibrate");
  }
  if (root.at("version").integer() != 1) {
    throw Error(place, "its version is not 1", "use a newer vernier");
  }
  RigFile file;
  RigEstimate& estimate = file.estimate;
  estimate.rig = rig_json::parse_cameras(root.at("cameras"));
  const bool covariance = root.has("covariance");
  std::vector<Eigen::Index> listed(static_cast<std::size_t>(parameter_count(estimate.rig)));
  std::iota(listed.begin(), listed.end(), 0);
  if (covariance || root.has("parameter_names")) listed = parse_names(root, estimate.rig);
  const std::vector<std::string> names = parameter_names(estimate.rig);
  for (const Eigen::Index i : listed) file.listed.push_back(names[static_cast<std::size_t>(i)]);
  file.listed_places = listed;
  if (covariance || root.has("parameters")) check_parameters(root, estimate.rig, listed);
  if (covariance) {
    estimate.covariance = parse_covariance(root.at("covariance"), estimate.rig, listed);
  }
  if (root.has("covariance_mvb")) {
    estimate.covariance_mvb =
        parse_parameter_matrix(root.at("covariance_mvb"), estimate.rig, listed);
  }
  if (root.has("calibration")) {
    estimate.calibration = rig_json::parse_summary(root.at("calibration"), estimate.rig);
    for (const std::string& warning : estimate.calibration->trust_warnings) {
      file.warnings.push_back(stored_warning_prefix(place) + warning);
    }
    if (covariance) {
      check_held(estimate.calibration->held, root.at("calibration"), file.listed,
                 root.at("covariance"));
    }
  }
  if (root.has("evidence")) {
    estimate.evidence = rig_json::parse_evidence(root.at("evidence"), estimate.rig);
    estimate.evidence->priors = parse_priors(root.at("evidence"));
  }
  if (estimate.calibration && estimate.evidence) {
    rig_json::check_summary(*estimate.calibration, *estimate.evidence, root.at("calibration"));
  }
  Json others = Json::object();
  for (const auto& [key, value] : json.items()) {
    if (std::find(known_keys.begin(), known_keys.end(), key) != known_keys.end()) continue;
    others[key] = value;
    file.warnings.push_back(place + ": the key " + in_quotes(key) +
                            " is unknown; it is kept unchanged");
  }
  if (!others.empty()) estimate.other_keys = others.dump();
  return file;
}

std::vector<GaussianRigPrior> parse_priors(const Node& evidence) {
  std::vector<GaussianRigPrior> priors;
  if (!evidence.has("priors")) return priors;
  const Node list = evidence.at("priors");
  for (std::size_t i = 0; i < list.array().size(); ++i) {
    const Node prior = list.at(i);
    priors.push_back(
        gaussian_prior_of(rig_of(prior.json(), prior.place()).estimate, prior.place()));
  }
  return priors;
}

}  // namespace

RigFile parse_rig(const std::string& text, const std::string& place) {
  return with_errors_of(place,
                        [&] { return rig_of(rig_json::parse_rig_json(text, place), place); });
}

GaussianRigPrior gaussian_rig_prior(const RigFile& file, const std::string& place) {
  return gaussian_prior_of(file.estimate, place);
}

RigFile read_rig(const std::filesystem::path& file) {
  return parse_rig(read_whole(file), file.string());
}

std::string format_rig(const RigEstimate& estimate, KeepEvidence evidence) {
  check_covariances(estimate);
  Json json;
  json["format"] = "vernier/rig";
  json["version"] = 1;
  json["cameras"] = rig_json::cameras_json(estimate.rig);
  const std::vector<bool> held = held_parameters(estimate);
  json["parameter_names"] = free_names(estimate.rig, held);
  json["parameters"] = Json::array();
  const Eigen::VectorXd values = parameters(estimate.rig);
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (!held[i]) json["parameters"].push_back(values[static_cast<Eigen::Index>(i)]);
  }
  const auto listed = [&](const Eigen::MatrixXd& C) {
    return to_json(covariance_of_free(C, estimate.rig, held));
  };
  if (estimate.covariance) {
    json["covariance"] = {{"kind", name(estimate.covariance->kind)},
                          {"matrix", listed(estimate.covariance->matrix)}};
  }
  if (estimate.covariance_mvb) json["covariance_mvb"]["matrix"] = listed(*estimate.covariance_mvb);
  if (estimate.calibration)
    json["calibration"] = rig_json::summary_json(*estimate.calibration, estimate.rig);
  if (estimate.evidence && evidence == KeepEvidence::yes) {
    json["evidence"] = rig_json::evidence_json(*estimate.evidence, estimate.rig);
    for (const GaussianRigPrior& prior : estimate.evidence->priors) {
      json["evidence"]["priors"].push_back(prior_json(prior));
    }
  }
  require_finite(json, "rig");
  if (!estimate.other_keys.empty()) json.update(Json::parse(estimate.other_keys));
  // Names of images come from the file system, which does not promise UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_rig(const RigEstimate& estimate,
               const std::filesystem::path& file,
               KeepEvidence evidence) {
  write_atomically(file, format_rig(estimate, evidence));
}

}  // namespace vernier
