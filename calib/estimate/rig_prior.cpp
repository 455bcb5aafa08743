// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/rig_prior.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/estimate/held_parameters.h"
#include "calib/estimate/stable_coordinates.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/scaled_root.h"

namespace vernier {

using namespace internal;

namespace {

std::vector<Eigen::Index> places_of(const std::vector<std::string>& names, const Rig& rig) {
  const std::vector<std::string> all = parameter_names(rig);
  std::vector<Eigen::Index> places;
  for (const std::string& name : names) {
    const auto found = std::find(all.begin(), all.end(), name);
    if (found == all.end()) {
      throw Error("prior of " + name, "the rig has no such parameter",
                  "see the parameter_names of a rig file of this model");
    }
    if (std::find(places.begin(), places.end(), found - all.begin()) != places.end()) {
      throw Error("prior of " + name, "it is given twice", "give it once");
    }
    places.push_back(found - all.begin());
  }
  return places;
}

std::vector<bool> all_but(const std::vector<Eigen::Index>& places, const Rig& rig) {
  std::vector<bool> others(static_cast<std::size_t>(parameter_count(rig)), true);
  for (const Eigen::Index i : places) others[static_cast<std::size_t>(i)] = false;
  return others;
}

/// Inverse of a covariance, scaled before it is factored.
Eigen::MatrixXd inverse_of(const Covariance& covariance) {
  const ScaledDecomposition decomposition(covariance);  // throws if it is invalid
  const Eigen::VectorXd sd = covariance.matrix.diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < sd.size(); ++i) {
    if (!(sd[i] > 0)) {
      throw Error("prior of " + covariance.names[static_cast<std::size_t>(i)], "its variance is 0",
                  "fix a parameter that is known exactly");
    }
  }
  if (!(decomposition.scaled_condition() < 1e13)) {
    throw Error("prior",
                "its covariance is singular: no variance where " +
                    decomposition.directions().back().description,
                "give that direction a variance, or fix its parameters");
  }
  const Eigen::MatrixXd R =
      sd.cwiseInverse().asDiagonal() * covariance.matrix * sd.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd inverse = Cholesky(0.5 * (R + R.transpose())).inverse();
  return sd.cwiseInverse().asDiagonal() * inverse * sd.cwiseInverse().asDiagonal();
}

}  // namespace

namespace {

RigPrior prior_at(const Rig& like,
                  const std::vector<HeldParameter>& values,
                  const Covariance& covariance) {
  const std::vector<Eigen::Index> places = places_of(covariance.names, like);
  const Eigen::MatrixXd P = inverse_of(covariance);
  RigPrior prior{with_held_values(like, values), {}, nullptr};
  const Eigen::MatrixXd K =
      values_by_tangent(prior.mean, all_but(places, like))(places, Eigen::all);
  prior.information = K.transpose() * (0.5 * (P + P.transpose())) * K;
  if (covariance.kind != CovarianceKind::prior && K.rows() == K.cols()) {
    prior.coordinates = std::make_shared<const StableCoordinates>(
        prior.mean, full_covariance({prior.mean, covariance}).matrix);
  }
  return prior;
}

}  // namespace

Covariance full_covariance(const GaussianRigPrior& known) {
  const std::vector<Eigen::Index> places = places_of(known.covariance.names, known.rig);
  const Eigen::MatrixXd E =
      tangent_by_values(known.rig, all_but(places, known.rig))(Eigen::all, places);
  return {known.covariance.kind, parameter_names(known.rig),
          E * known.covariance.matrix * E.transpose()};
}

RigPrior rig_prior(const Rig& like, const GaussianRigPrior& known) {
  const std::vector<Eigen::Index> places = places_of(known.covariance.names, known.rig);
  const Eigen::VectorXd a = parameters(known.rig);
  std::vector<HeldParameter> values;
  for (std::size_t i = 0; i < places.size(); ++i) {
    values.push_back({known.covariance.names[i], a[places[i]]});
  }
  return prior_at(like, values, known.covariance);
}

GaussianRigPrior gaussian_prior_of(const Rig& like, const std::vector<ParameterPrior>& known) {
  Covariance covariance;
  std::vector<HeldParameter> values;
  const auto n = static_cast<Eigen::Index>(known.size());
  covariance.matrix = Eigen::MatrixXd::Zero(n, n);
  for (const ParameterPrior& k : known) {
    if (!(k.sigma > 0) || !std::isfinite(k.sigma)) {
      throw Error("prior of " + k.name, fmt::format("{} is not a standard deviation", k.sigma),
                  "give a number above 0, or fix the parameter");
    }
    const auto i = static_cast<Eigen::Index>(covariance.names.size());
    covariance.matrix(i, i) = k.sigma * k.sigma;
    covariance.names.push_back(k.name);
    values.push_back({k.name, k.value});
  }
  places_of(covariance.names, like);  // throws if one is missing
  return {with_held_values(like, values), std::move(covariance)};
}

RigPrior rig_prior(const Rig& like, const std::vector<ParameterPrior>& known) {
  return rig_prior(like, gaussian_prior_of(like, known));
}

RigPrior with_mean(const RigPrior& prior, Rig mean) {
  RigPrior moved{std::move(mean), prior.information, nullptr};
  if (prior.coordinates) {
    const Eigen::MatrixXd white = ScaledRoot(prior.information).white;
    moved.coordinates =
        std::make_shared<const StableCoordinates>(moved.mean, white.transpose() * white);
  }
  return moved;
}

PriorOffset prior_offset(const RigPrior& prior, const Rig& rig) {
  std::optional<StablePosition> at;
  if (prior.coordinates) at = prior.coordinates->try_position(rig);
  if (!at) at = tangent_position(rig, prior.mean);
  return {std::move(at->delta), std::move(at->by_rig)};
}

double prior_chi2(const RigPrior& prior, const Rig& rig) {
  const Eigen::VectorXd delta =
      prior.coordinates ? prior.coordinates->coordinates(rig) : difference(rig, prior.mean);
  return delta.dot(prior.information * delta);
}

}  // namespace vernier
