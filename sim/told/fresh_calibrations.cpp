// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/told/fresh_calibrations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "calib/base/thread_clock.h"
#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/camera/model_nesting.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/shuffled.h"
#include "calib/triangulation.h"
#include "calib/uncertainty/target_quantity.h"
#include "sim/told/scaled_error.h"
#include "sim/told_rigs.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

class CalibratedRigs : public ToldRigs {
 public:
  CalibratedRigs(std::shared_ptr<const FreshCalibrations> calibrations, double psi_c)
      : calibrations_(std::move(calibrations)), psi_c_(psi_c) {}

  ToldRig told(std::uint32_t draw) const override {
    if (psi_c_ == 0) return {calibrations_->truth(), {}};
    const auto calibration = calibrations_->of(draw);
    if (!calibration->failure.empty()) return {{}, calibration->failure};
    return possible_only(with_scaled_error(calibrations_->truth(), calibration->rig, psi_c_));
  }

 private:
  std::shared_ptr<const FreshCalibrations> calibrations_;
  double psi_c_;
};

std::string no_depth_reason(double range_m) {
  return fmt::format("the depth of a point at {:g} m is not found with it", range_m);
}

}  // namespace

FreshCalibrations::FreshCalibrations(Rig truth,
                                     const FreshCalibrationOptions& options,
                                     std::uint64_t seed)
    : FreshCalibrations(std::move(truth), options, seed, nullptr) {}

FreshCalibrations::FreshCalibrations(Rig truth,
                                     const FreshCalibrationOptions& options,
                                     std::uint64_t seed,
                                     std::shared_ptr<const BoardObservations> corners)
    : truth_(std::move(truth)), options_(options), seed_(seed), corners_(std::move(corners)) {
  if (!corners_) return;
  const auto frames = static_cast<int>(frames_of(*corners_).size());
  if (frames < options_.views) {
    throw Error(fmt::format("calibration.views = {}", options_.views),
                fmt::format("the corners are of {} frames", frames), "take fewer views");
  }
  if (corners_->size_px.size() != truth_.cameras.size()) {
    throw Error("calibration.observations",
                fmt::format("the corners are of {} cameras and the true rig has {}",
                            corners_->size_px.size(), truth_.cameras.size()),
                "give the corners that the rig was calibrated from");
  }
  for (std::size_t c = 0; c < truth_.cameras.size(); ++c) {
    if (corners_->size_px[c] == truth_.cameras[c].size_px) continue;
    throw Error("calibration.observations",
                fmt::format("the images of camera {} have another size than the true rig's", c),
                "give the corners that the rig was calibrated from");
  }
}

BoardObservations FreshCalibrations::views_of(std::uint32_t draw) const {
  if (!corners_) {
    BoardObservations seen = simulate_board(truth_, options_.board,
                                            {.seed = seed_,
                                             .trial = draw,
                                             .poses = draw,
                                             .frames = options_.views,
                                             .pixel_sigma_px = options_.pixel_sigma_px,
                                             .distance_m = options_.distance_m,
                                             .tilt_rad = options_.tilt_rad})
                                 .observations;
    // No detector reports a corner that noise carried out of its image.
    return with_corners(std::move(seen), [&](const BoardView& view, std::size_t corner) {
      return in_image(truth_.cameras[static_cast<std::size_t>(view.camera)],
                      view.pixels_px[corner]);
    });
  }
  std::vector<int> frames = shuffled(
      frames_of(*corners_), {.seed = seed_,
                             .trial = draw,
                             .source = static_cast<std::uint32_t>(DrawSource::calibration_views)});
  frames.resize(static_cast<std::size_t>(options_.views));
  std::sort(frames.begin(), frames.end());
  return at_frames(*corners_, frames);
}

FreshCalibration FreshCalibrations::compute(std::uint32_t draw) const {
  CalibrationOptions how;
  how.models = models_of(truth_);
  if (options_.model) how.models.assign(truth_.cameras.size(), *options_.model);
  try {
    RigEstimate estimate = calibrate(views_of(draw), how);
    const auto& doubts = estimate.calibration->trust_warnings;
    return {std::move(estimate.rig),
            std::move(estimate.covariance->matrix),
            {},
            doubts.empty() ? std::string() : doubts.front()};
  } catch (const Error& error) {
    return {{}, {}, error.place() + ": " + error.fault(), {}};
  }
}

std::shared_ptr<const FreshCalibration> FreshCalibrations::of(std::uint32_t draw) const {
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = known_.find(draw); found != known_.end()) return found->second;
  }
  const ThreadClock clock;
  FreshCalibration made = compute(draw);
  made.cpu_ms = clock.cpu_ms();
  made.wall_ms = clock.wall_ms();
  auto computed = std::make_shared<const FreshCalibration>(std::move(made));
  const std::lock_guard lock(mutex_);
  const auto [kept, is_new] = known_.emplace(draw, std::move(computed));
  std::shared_ptr<const FreshCalibration> result = kept->second;
  if (is_new) latest_.push_back(draw);
  while (latest_.size() > options_.most_kept) {
    known_.erase(latest_.front());
    latest_.pop_front();
  }
  return result;
}

std::size_t FreshCalibrations::kept() const {
  const std::lock_guard lock(mutex_);
  return known_.size();
}

std::shared_ptr<const ToldRigs> calibrated_rigs(
    std::shared_ptr<const FreshCalibrations> calibrations, double psi_c) {
  if (const auto& model = calibrations->options().model) {
    Rig like = calibrations->truth();
    for (Camera& camera : like.cameras) camera.model = *model;
    check_scale(calibrations->truth(), like, psi_c, "calibration.model");
  }
  return std::make_shared<const CalibratedRigs>(std::move(calibrations), psi_c);
}

std::optional<MeasuredDepth> measured_depth(const FreshCalibration& calibration,
                                            const Rig& truth,
                                            double range_m) {
  const std::optional<PixelPair> pair = pixel_pair(truth, {0, 0, range_m});
  if (!pair) return {};
  const std::optional<double> depth_m = try_triangulated_depth_m(calibration.rig, *pair);
  if (!depth_m) return {};
  try {
    const Eigen::RowVectorXd g = target_quantity(calibration.rig, "depth", range_m).gradient.row(0);
    return MeasuredDepth{*depth_m, g.dot(calibration.covariance * g.transpose())};
  } catch (const Error&) {
    return {};
  }
}

CalibrationRecord record_of(const FreshCalibrations& calibrations, int count) {
  std::vector<std::shared_ptr<const FreshCalibration>> all;
  for (int draw = 0; draw < count; ++draw) {
    all.push_back(calibrations.of(static_cast<std::uint32_t>(draw)));
  }
  return record_of(calibrations.truth(), all);
}

CalibrationRecord record_of(
    const Rig& truth, const std::vector<std::shared_ptr<const FreshCalibration>>& calibrations) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  CalibrationRecord record;
  record.calibrations = static_cast<int>(calibrations.size());
  const bool has_depth =
      truth.cameras.size() == 2 && pixel_pair(truth, {0, 0, record.range_m}).has_value();
  double errors = 0, variances = 0;
  int measured = 0;
  for (const auto& c : calibrations) {
    if (!c->failure.empty()) {
      if (record.failed++ == 0) record.why_failed = c->failure;
      continue;
    }
    const std::optional<MeasuredDepth> depth =
        has_depth ? measured_depth(*c, truth, record.range_m) : std::nullopt;
    const bool no_depth = has_depth && !depth;
    if ((!c->doubt.empty() || no_depth) && record.doubtful++ == 0) {
      record.why_doubtful = c->doubt.empty() ? no_depth_reason(record.range_m) : c->doubt;
    }
    if (!depth) continue;
    errors += (depth->m - record.range_m) * (depth->m - record.range_m);
    variances += depth->variance_m2;
    ++measured;
  }
  record.depth_error_m = measured > 0 ? std::sqrt(errors / measured) : nan;
  record.depth_sd_m = measured > 0 ? std::sqrt(variances / measured) : nan;
  return record;
}

}  // namespace vernier::sim::internal
