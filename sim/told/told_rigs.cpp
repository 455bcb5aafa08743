// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/told_rigs.h"

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "calib/camera.h"
#include "calib/camera/same_lens_models.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "sim/told/possible_rig.h"
#include "sim/told/scaled_error.h"

namespace vernier::sim {

using namespace internal;

namespace {

class DrawnRigs : public ToldRigs {
 public:
  DrawnRigs(RigSampler sampler, double psi_c, std::uint64_t seed)
      : sampler_(std::move(sampler)), psi_c_(psi_c), seed_(seed) {}

  ToldRig told(std::uint32_t draw) const override {
    if (psi_c_ == 0) return {sampler_.mean(), {}};
    try {
      return possible_only(sampler_.sample(psi_c_, seed_, draw));
    } catch (const Error& error) {  // the draw overflows
      return {{}, error.place() + ": " + error.fault()};
    }
  }

 private:
  RigSampler sampler_;
  double psi_c_;
  std::uint64_t seed_;
};

class GivenRig : public ToldRigs {
 public:
  explicit GivenRig(ToldRig rig) : rig_(std::move(rig)) {}
  ToldRig told(std::uint32_t) const override { return rig_; }

 private:
  ToldRig rig_;
};

}  // namespace

namespace internal {

void check_same_cameras(const Rig& truth, const Rig& rig, const std::string& place) {
  if (rig.cameras.size() != truth.cameras.size()) {
    throw Error(
        place,
        fmt::format("has {} cameras and the true rig {}", rig.cameras.size(), truth.cameras.size()),
        "give rigs of the same cameras");
  }
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const Eigen::Vector2i &told = rig.cameras[c].size_px, &true_px = truth.cameras[c].size_px;
    if (told == true_px) continue;
    throw Error(place,
                fmt::format("the images of camera {} are {}x{} and the true rig's {}x{}", c,
                            told.x(), told.y(), true_px.x(), true_px.y()),
                "give rigs of the same cameras");
  }
}

void check_scale(const Rig& truth, const Rig& rig, double psi_c, const std::string& place) {
  if (psi_c == 0 || psi_c == 1 || vernier::internal::same_lens_models(truth, rig)) return;
  throw Error(
      place,
      fmt::format("sources.calibration = {} cannot scale the difference of lens models: they "
                  "are not those of the true rig",
                  psi_c),
      "use 1, which tells the rig as it is, or 0, which tells the truth");
}

Rig with_scaled_error(const Rig& truth, const Rig& rig, double psi_c) {
  if (psi_c == 0) return truth;
  if (psi_c == 1) return rig;
  return retract(truth, psi_c * difference(rig, truth));
}

ToldRig possible_only(Rig rig) {
  if (std::string why = impossible(rig); !why.empty()) {
    return {{}, "no cameras can be like the rig that is told: " + why};
  }
  return {std::move(rig), {}};
}

}  // namespace internal

std::shared_ptr<const ToldRigs> drawn_rigs(const Rig& truth,
                                           const Covariance& covariance,
                                           double psi_c,
                                           std::uint64_t seed,
                                           const std::string& place) {
  if (covariance.names != parameter_names(truth)) {
    throw Error(place, "its covariance is over other parameters than the true rig has",
                "give a rig with the same cameras and lens models, or rig.error = \"given\"");
  }
  RigEstimate around;
  around.rig = truth;
  around.covariance = covariance;
  return drawn_rigs(RigSampler(around, place), psi_c, seed);
}

std::shared_ptr<const ToldRigs> drawn_rigs(RigSampler sampler, double psi_c, std::uint64_t seed) {
  return std::make_shared<const DrawnRigs>(std::move(sampler), psi_c, seed);
}

std::shared_ptr<const ToldRigs> given_rig(const Rig& truth,
                                          const Rig& rig,
                                          double psi_c,
                                          const std::string& place) {
  check_same_cameras(truth, rig, place);
  check_scale(truth, rig, psi_c, place);
  if (psi_c == 0) return std::make_shared<const GivenRig>(ToldRig{truth, {}});
  return std::make_shared<const GivenRig>(possible_only(with_scaled_error(truth, rig, psi_c)));
}

}  // namespace vernier::sim
