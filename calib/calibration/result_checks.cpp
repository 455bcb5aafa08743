// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/result_checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <variant>
#include <vector>

#include "calib/base/shown_text.h"
#include "calib/calibration/lens_field.h"
#include "calib/calibration/residual_diagnosis.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/data_and_prior.h"
#include "calib/error.h"
#include "calib/estimate/prior_consistency.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/scaled_root.h"

namespace vernier::internal {
namespace {

/// Below this a prior and the rest are said to disagree.
constexpr double least_p = 1e-4;

/// The ninth of the image that contains a position, `x` and `y` from 0 to 1: "top left", "bottom",
/// ….
std::string ninth_of(double x, double y) {
  const std::string row = y < 1.0 / 3 ? "top" : y > 2.0 / 3 ? "bottom" : "";
  const std::string column = x < 1.0 / 3 ? "left" : x > 2.0 / 3 ? "right" : "";
  if (row.empty() && column.empty()) return "middle";
  return row + (row.empty() || column.empty() ? "" : " ") + column;
}

std::optional<std::string> inversion_warning(const Camera& camera) {
  constexpr int columns = 33, rows = 25;
  const Eigen::Vector2d last_px = (camera.size_px - Eigen::Vector2i::Ones()).cast<double>();
  const Eigen::Vector2d centre_px(camera.ox_px(), camera.oy_px());
  int folded = 0, beyond = 0;
  double least_px = std::numeric_limits<double>::infinity();
  std::vector<std::string> regions;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double x = static_cast<double>(i) / (columns - 1);
      const double y = static_cast<double>(j) / (rows - 1);
      const Eigen::Vector2d pixel(x * last_px.x(), y * last_px.y());
      if (is_beyond(camera, pixel, fisheye_field_rad)) {
        ++beyond;
        continue;
      }
      if (try_unproject(camera, pixel)) continue;
      ++folded;
      least_px = std::min(least_px, (pixel - centre_px).norm());
      const std::string region = ninth_of(x, y);
      if (std::find(regions.begin(), regions.end(), region) == regions.end()) {
        regions.push_back(region);
      }
    }
  }
  const double percent = 100.0 * (folded > 0 ? folded : beyond) / (columns * rows);
  if (folded == 0 && beyond == 0) return {};
  if (folded == 0) {
    return fmt::format(
        "camera \"{}\" sees {} degrees from its axis and beyond in {:.{}f} % of its image, where "
        "{} has no rays: functions that need one fail there; crop or mask these pixels, or leave "
        "them unused",
        camera.name, fisheye_field_deg, percent, percent < 10 ? 1 : 0, model_name(camera.model));
  }
  return fmt::format(
      "the distortion of camera \"{}\" cannot be inverted in {:.{}f} % of its image ({}; from "
      "{:.0f} "
      "px of its principal point on): pixels there have no ray, and functions that need one "
      "fail; use a model with fewer distortion parameters, fisheye4 for a wide lens, or add views "
      "at the image's border",
      camera.name, percent, percent < 10 ? 1 : 0, fmt::join(regions, ", "), least_px);
}

}  // namespace

std::string residual_warning(double rms_px, const std::vector<ResidualFinding>& findings) {
  std::string words = fmt::format("residuals of {:.2f} px exceed corner noise", rms_px);
  if (findings.empty()) words += ": corners are wrong, or the board or the rig moved or bent";
  for (std::size_t i = 0; i < findings.size(); ++i) {
    words += (i == 0 ? ": " : ". Further, ") + findings[i].text;
  }
  return words;
}

std::vector<std::string> inversion_warnings(const Rig& rig) {
  std::vector<std::string> warnings;
  for (const Camera& camera : rig.cameras) {
    if (const auto warning = inversion_warning(camera)) warnings.push_back(*warning);
  }
  return warnings;
}

std::optional<std::string> ill_conditioning_warning(const Covariance& bound, const Rig& rig) {
  if (bound.matrix.rows() == 0) return {};
  double condition = INFINITY;
  std::string words;
  try {
    const ScaledDecomposition decomposition(bound);
    condition = decomposition.scaled_condition();
    words = decomposition.directions().front().description;
  } catch (const Error&) {  // not even positive any more
  }
  if (condition <= largest_scaled_condition) return {};
  const bool richest = std::any_of(
      rig.cameras.begin(), rig.cameras.end(),
      [](const Camera& camera) { return std::holds_alternative<OpenCv8>(camera.model); });
  return fmt::format(
      "the views hardly determine this model: the scaled condition number of its parameters is "
      "{:.1e}{}, so the standard deviations are not reliable; {}",
      condition, words.empty() ? "" : " (" + words + ")",
      richest ? "use --model opencv5"
              : "use a model with fewer parameters, or add tilted views that fill the image");
}

std::optional<std::string> noise_warning(double chi2, double dof, double pixel_sigma_px) {
  constexpr double most = 9, chance = 1e-4, no_chance_dof = 60;
  constexpr double exact_px = 1e-3;  // computed corners; no detector is as good
  const double ratio = chi2 / dof;
  const bool too_small = !(ratio <= most);
  if (pixel_sigma_px * std::sqrt(ratio) < exact_px && !too_small) return {};
  if (!too_small && ratio >= 1 / most) return {};
  if (dof < no_chance_dof && chi2 < 1e3) {  // with more, neither limit is reached by chance
    const double p = too_small ? chi_squared_survival(chi2, dof) : chi_squared_cdf(chi2, dof);
    if (p > chance) return {};
  }
  return fmt::format(
      "the residuals do not have the stated noise of {:.3g} px: chi² is {:.3g} for {:.0f} degrees "
      "of "
      "freedom, as for a noise of {:.3g} px{}; state that noise, or leave it to be estimated",
      pixel_sigma_px, chi2, dof, pixel_sigma_px * std::sqrt(ratio),
      too_small ? ", so corners or models are wrong, or the noise is understated"
                : ", so the noise is overstated");
}

namespace {

/// A prior beside values that are held far from what it states.
std::optional<std::string> held_conflict_warning(const RigPrior& prior,
                                                 const PriorOffset& at,
                                                 const std::vector<Eigen::Index>& held,
                                                 const std::vector<std::string>& names) {
  if (held.empty()) return {};
  std::vector<Eigen::Index> informed;
  for (Eigen::Index i = 0; i < prior.information.rows(); ++i) {
    if (prior.information(i, i) > 0) informed.push_back(i);
  }
  const Eigen::MatrixXd white = ScaledRoot(prior.information(informed, informed)).white;
  if (white.rows() < white.cols()) return {};  // its covariance has no digits
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(at.delta.size(), at.delta.size());
  covariance(informed, informed) = white.transpose() * white;
  const Eigen::MatrixXd of_held = covariance(held, held);
  const Eigen::VectorXd offset = at.delta(held);
  const double p = chi_squared_survival(offset.dot(of_held.ldlt().solve(offset)),
                                        static_cast<double>(held.size()));
  if (!(p < least_p)) return {};
  Eigen::Index most = 0;
  const double sigmas = (offset.array().abs() / of_held.diagonal().array().sqrt()).maxCoeff(&most);
  return fmt::format(
      "what is held and the prior disagree: {} is held {:.1f} of its prior's standard deviations "
      "away (p = {:.1e} over {}); check the value, or leave it free",
      names[held[most]], sigmas, p,
      counted(static_cast<std::int64_t>(held.size()), "held parameter"));
}

}  // namespace

std::optional<std::string> prior_conflict_warning(const RigPrior& prior,
                                                  const Rig& rig,
                                                  const Eigen::MatrixXd& bound,
                                                  const Eigen::MatrixXd& honest,
                                                  int clusters) {
  std::vector<Eigen::Index> known, held;
  for (Eigen::Index i = 0; i < bound.rows(); ++i) {
    if (prior.information(i, i) > 0) (bound(i, i) > 0 ? known : held).push_back(i);
  }
  const std::vector<std::string> all_names = parameter_names(rig);
  const PriorOffset at = prior_offset(prior, rig);
  if (const auto conflict = held_conflict_warning(prior, at, held, all_names)) return conflict;
  if (known.empty()) return {};
  std::vector<std::string> names;
  names.reserve(known.size());
  for (const Eigen::Index i : known) names.push_back(all_names[i]);
  const Eigen::MatrixXd before = prior.information(known, known).inverse();
  Eigen::VectorXd offset = at.delta(known);
  // What is held moves the prior's mean of the rest.
  if (!held.empty()) offset += before * prior.information(known, held) * at.delta(held);
  const auto in_prior = [&](const Eigen::MatrixXd& C) -> Eigen::MatrixXd {
    return (at.by_rig * C * at.by_rig.transpose())(known, known);
  };
  PriorConsistency agreement;
  try {
    agreement = prior_consistency(
        offset, names, {.prior = before, .bound = in_prior(bound), .honest = in_prior(honest)},
        {.clusters = clusters});
  } catch (const Error&) {  // a prior that cannot be inverted in double precision is not checked
    return {};
  }
  if (agreement.dof == 0 || agreement.p_value >= least_p) return {};
  Eigen::Index most = 0;
  const double sigmas = (offset.array() / before.diagonal().array().sqrt()).abs().maxCoeff(&most);
  return fmt::format(
      "data and prior disagree: {} moved by {:.1f} of its prior's standard deviations (p = {:.1e} "
      "over {} direction{}); check the prior's value, or give it a larger standard deviation",
      names[most], sigmas, agreement.p_value, agreement.dof, agreement.dof == 1 ? "" : "s");
}

}  // namespace vernier::internal
