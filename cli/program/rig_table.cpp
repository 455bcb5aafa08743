// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/rig_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/shown_text.h"
#include "calib/covariance.h"
#include "calib/estimate/outlier_lines.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/statistics/distributions.h"
#include "cli/program/session.h"

namespace vernier::cli {
namespace {

Eigen::VectorXd deviations(const Eigen::MatrixXd& covariance) {
  return covariance.diagonal().cwiseMax(0).cwiseSqrt();
}

/// The rejected pairs with the largest residuals.
std::string pair_outlier_lines(std::vector<PairOutlier> outliers) {
  constexpr std::size_t most = 10;
  std::stable_sort(outliers.begin(), outliers.end(), [](const auto& a, const auto& b) {
    return std::abs(a.residual_px) > std::abs(b.residual_px);
  });
  std::string text;
  for (std::size_t i = 0; i < std::min(most, outliers.size()); ++i) {
    const PairOutlier& o = outliers[i];
    text += fmt::format(
        "rejected: ({:.1f}, {:.1f}) with ({:.1f}, {:.1f}) of image pair {}, {:.1f} px from its "
        "epipolar line\n",
        o.pixels_px[0], o.pixels_px[1], o.pixels_px[2], o.pixels_px[3], o.image_pair,
        std::abs(o.residual_px));
  }
  if (outliers.size() > most) text += fmt::format("… and {} more\n", outliers.size() - most);
  return text;
}

/// The estimated board warp, if any.
std::optional<Eigen::Vector2d> estimated_warp_m(const RigEstimate& estimate) {
  if (!estimate.evidence || estimate.evidence->warp_m.isZero(0)) return {};
  return estimate.evidence->warp_m;
}

/// How well the data are fitted; nothing of priors alone.
std::string fit_line(const RigEstimate& estimate) {
  const CalibrationSummary& s = *estimate.calibration;
  if (s.views == 0 && s.dof == 0) return "no corners and no pairs, priors alone\n";
  const auto& evidence = estimate.evidence;
  const bool has_pairs = evidence ? evidence->pairs.size() > 0 : s.source != "board";
  const bool has_boards = evidence ? !evidence->observations.views.empty() : s.source != "pairs";
  const std::string views = has_boards && has_pairs
                                ? fmt::format("{} board frames and image pairs", s.views)
                                : counted(s.views, has_boards ? "view" : "image pair");
  return fmt::format(
      "{}, rms {:.4f} px{}, pixel sigma {:.4f} px, chi² {:.1f} for {} degrees of freedom{}\n",
      views, s.rms_px,
      !has_boards ? " from the epipolar line"
      : has_pairs ? " per coordinate of the boards"
                  : " per coordinate",
      s.pixel_sigma_px, s.chi2, s.dof, s.effects ? " (without random effects)" : "");
}

std::string parameter_lines(const RigEstimate& estimate) {
  const std::vector<std::string> names = parameter_names(estimate.rig);
  const Eigen::VectorXd values = parameters(estimate.rig);
  const std::vector<bool> held = held_parameters(estimate);
  std::string text =
      fmt::format("{:<14} {:>14} {:>12} {:>12}\n", "parameter", "value", "sigma", "bound sigma");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const auto sigma = [&](const Eigen::MatrixXd* C) {
      if (!C) return std::string("unknown");
      return held[i] ? "fixed" : fmt::format("{:.3g}", std::sqrt((*C)(k, k)));
    };
    text += fmt::format("{:<14} {:>14.8g} {:>12} {:>12}\n", names[i], values[k],
                        sigma(estimate.covariance ? &estimate.covariance->matrix : nullptr),
                        sigma(estimate.covariance_mvb ? &*estimate.covariance_mvb : nullptr));
  }
  return text;
}

/// Where a covariance of this kind comes from.
std::string_view origin(CovarianceKind kind) {
  switch (kind) {
    case CovarianceKind::mvb:
      return "the bound of white noise";
    case CovarianceKind::clustered:
      return "by the scatter of the views";
    case CovarianceKind::jackknife:
      return "by the scatter of the views, few for so many parameters";
    case CovarianceKind::prior:
      return "as given";
    case CovarianceKind::combined:
      return "of all that was combined";
  }
  return "";
}

}  // namespace

std::string direction_lines(const ScaledDecomposition& decomposition, std::size_t most) {
  std::string text;
  for (std::size_t k = 0; k < std::min(most, decomposition.directions().size()); ++k) {
    const CovarianceDirection& direction = decomposition.directions()[k];
    text += fmt::format("  {:>2}. {:4.1f} % of the scaled variance; {}\n", k + 1,
                        100 * direction.variance_share, direction.description);
  }
  return text;
}

std::string rig_table(const RigEstimate& estimate) {
  std::string text;
  if (estimate.calibration) {
    const CalibrationSummary& s = *estimate.calibration;
    text += fit_line(estimate);
    if (s.prior_dof > 0) {
      text +=
          fmt::format("prior: chi² {:.2f} for {} parameters with prior (p at most {:.2g})\n",
                      s.prior_chi2, s.prior_dof, chi_squared_survival(s.prior_chi2, s.prior_dof));
    }
    for (const std::string& line : outlier_lines(estimate)) text += "rejected: " + line + "\n";
    text += pair_outlier_lines(s.pair_outliers);
  }
  if (const auto warp_m = estimated_warp_m(estimate)) {
    text += fmt::format("board warp: {:.3f} / {:.3f} mm along x / y\n", 1e3 * warp_m->x(),
                        1e3 * warp_m->y());
  }
  if (estimate.calibration && estimate.calibration->board_aspect) {
    const AspectEstimate& aspect = *estimate.calibration->board_aspect;
    text += fmt::format("board aspect: {:+.3f} % ± {:.3f} %, x against y\n", 100 * aspect.value,
                        100 * aspect.sigma);
  }
  text += parameter_lines(estimate);
  if (estimate.covariance) {
    const ScaledDecomposition decomposition(gaussian_prior_of(estimate, "rig").covariance);
    text += fmt::format("covariance: {} ({}); condition {:.1e}, scaled {:.1e}; directions:\n",
                        name(estimate.covariance->kind), origin(estimate.covariance->kind),
                        decomposition.raw_condition(), decomposition.scaled_condition());
    text += direction_lines(decomposition);
  }
  return text;
}

Json aspect_json(const AspectEstimate& aspect) {
  return {{"value", aspect.value}, {"sigma", aspect.sigma}};
}

Json effects_json(const CalibrationEffects& effects) {
  return {{"white_px", effects.white_px},
          {"field_px", effects.field_px},
          {"field_length_m", effects.field_length_m},
          {"motion_m", effects.motion_m},
          {"motion_baseline_m", effects.motion_baseline_m},
          {"motion_rad", effects.motion_rad},
          {"shape_height_m", effects.shape_height_m},
          {"shape_plane_m", effects.shape_plane_m}};
}

Json rig_json(const RigEstimate& estimate) {
  const auto list = [](const Eigen::VectorXd& v) {
    return std::vector<double>(v.begin(), v.end());
  };
  Json json{{"parameter_names", parameter_names(estimate.rig)},
            {"parameters", list(parameters(estimate.rig))}};
  if (estimate.calibration) {
    const CalibrationSummary& s = *estimate.calibration;
    json["rms_px"] = s.rms_px;
    json["pixel_sigma_px"] = s.pixel_sigma_px;
    json["chi2"] = s.chi2;
    json["dof"] = s.dof;
    json["views"] = s.views;
    json["warnings"] = s.warnings;
    json["held"] = s.held;
    json["source"] = s.source;
    if (s.effects) json["effects"] = effects_json(*s.effects);
    json["pair_outliers"] = Json::array();
    for (const PairOutlier& o : s.pair_outliers) {
      json["pair_outliers"].push_back(
          {{"pair", o.image_pair},
           {"row", o.row},
           {"pixels_px", std::vector<double>(o.pixels_px.begin(), o.pixels_px.end())},
           {"residual_px", o.residual_px}});
    }
    json["outliers"] = Json::array();
    for (const CornerOutlier& o : s.outliers) {
      json["outliers"].push_back({{"frame", o.frame},
                                  {"camera", estimate.rig.cameras[o.camera].name},
                                  {"corner", o.id},
                                  {"residual_px", o.residual_px}});
    }
  }
  if (const auto warp_m = estimated_warp_m(estimate)) {
    json["board_warp_m"] = {warp_m->x(), warp_m->y()};
  }
  if (estimate.calibration && estimate.calibration->board_aspect) {
    json["board_aspect"] = aspect_json(*estimate.calibration->board_aspect);
  }
  if (estimate.covariance_mvb) json["sigma_mvb"] = list(deviations(*estimate.covariance_mvb));
  if (estimate.covariance) {
    json["covariance_kind"] = name(estimate.covariance->kind);
    json["sigma"] = list(deviations(estimate.covariance->matrix));
    json["directions"] = Json::array();
    const ScaledDecomposition decomposition(gaussian_prior_of(estimate, "rig").covariance);
    json["raw_condition"] = decomposition.raw_condition();
    json["scaled_condition"] = decomposition.scaled_condition();
    for (const CovarianceDirection& d : decomposition.directions()) {
      json["directions"].push_back({{"share", d.variance_share}, {"words", d.description}});
    }
  }
  return json;
}

}  // namespace vernier::cli
