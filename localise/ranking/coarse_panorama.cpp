// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/ranking/coarse_panorama.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "localise/ranking/panorama.h"

namespace vernier::localise::internal {

namespace {

using Fine = PanoramaBins;
using Coarse = CoarseBins;
constexpr std::size_t padding = 32;

/// Calls add(fine bin, coarse bin) for the channels of a bearing.
template <class Add>
void visit_channels(const Add& add) {
  for (int kind = 0; kind < 2; ++kind) {
    for (int height = 0; height < Fine::heights; ++height) {
      for (int range = 0; range < Fine::ranges; ++range) {
        add((kind * Fine::heights + height) * Fine::ranges + range,
            (kind * Coarse::heights + height / 2) * Coarse::ranges + range / 2);
      }
    }
  }
}

}  // namespace

CoarseView::CoarseView(std::span<const float> view) {
  const std::size_t bearings = view.size() / Fine::channels;
  const std::size_t size = (bearings + 1) / 2 * Coarse::channels;
  std::vector<float> mass(size, 0.0f);
  for (std::size_t b = 0; b < bearings; ++b) {
    visit_channels([&](int fine, int coarse) {
      const float root = view[b * Fine::channels + fine];
      mass[b / 2 * Coarse::channels + coarse] += root * root;
    });
  }
  bins.assign((size + padding - 1) / padding * padding, 0);
  for (std::size_t i = 0; i < size; ++i) {
    bins[i] = static_cast<std::int16_t>(std::min(1.0f, std::sqrt(mass[i])) * steps + 0.5f);
  }
}

void CoarsePanoramas::add(const Panorama& panorama) {
  const std::vector<Panorama::Window>& windows = panorama.windows;
  // The width of all windows: the bearings of a run are one less than it and its windows together.
  std::size_t runs = 0;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    runs += i == 0 || windows[i].bearing != windows[i - 1].bearing + 1;
  }
  if (runs > 0) {
    const std::size_t bearings = panorama.bins.size() / Fine::channels;
    const auto in_view = static_cast<int>((bearings - windows.size()) / runs + 1);
    std::size_t first = 0;
    for (std::size_t i = 1; i <= windows.size(); ++i) {
      if (i < windows.size() && windows[i].bearing == windows[i - 1].bearing + 1) continue;
      add_run(panorama, first, i, in_view);
      first = i;
    }
  }
  ++places_;
}

void CoarsePanoramas::add_run(const Panorama& panorama,
                              std::size_t first,
                              std::size_t end,
                              int in_view) {
  first += panorama.windows[first].bearing % 2;
  if (first >= end) return;
  const int begin = panorama.windows[first].begin;
  const int bearings = panorama.windows[end - 1].begin + in_view - begin;
  const std::size_t size = static_cast<std::size_t>((bearings + 1) / 2) * Coarse::channels;
  std::vector<float> squares(size, 0.0f);
  for (int b = 0; b < bearings; ++b) {
    const std::uint8_t* fine_bins =
        panorama.bins.data() + static_cast<std::size_t>(begin + b) * Fine::channels;
    visit_channels([&](int fine, int coarse) {
      const auto root = static_cast<float>(fine_bins[fine]);
      squares[static_cast<std::size_t>(b) / 2 * Coarse::channels + coarse] += root * root;
    });
  }
  const float largest =
      std::sqrt(std::max(1.0f, *std::max_element(squares.begin(), squares.end())));
  const float scale = std::numeric_limits<std::uint8_t>::max() / largest;
  bins_.resize(bins_.size() - (bins_.empty() ? 0 : padding));
  Run run{bins_.size(), per_norms_.size(), places_,
          static_cast<std::int16_t>(panorama.windows[first].bearing), 0};
  for (const float x : squares) {
    bins_.push_back(static_cast<std::uint8_t>(std::sqrt(x) * scale + 0.5f));
  }
  bins_.resize(bins_.size() + padding, 0);
  for (std::size_t i = first; i < end; i += 2, ++run.windows) {
    per_norms_.push_back(panorama.windows[i].per_norm / (scale * CoarseView::steps));
  }
  runs_.push_back(run);
}

std::vector<CoarseMatch> CoarsePanoramas::best(const CoarseView& view, std::size_t most) const {
  std::vector<CoarseMatch> found;
  std::array<std::int32_t, Coarse::bearings> products;
  std::array<float, Coarse::bearings + 2> likeness;
  for (const Run& run : runs_) {
    const auto windows = static_cast<std::size_t>(run.windows);
    coarse_products(view.bins, bins_.data() + run.bins, std::span(products).first(windows));
    for (std::size_t i = 0; i < windows; ++i) {
      likeness[i + 1] = static_cast<float>(products[i]) * per_norms_[run.per_norms + i];
    }
    likeness[0] = likeness[windows + 1] = 0;
    for (std::size_t i = 1; i <= windows; ++i) {
      if (likeness[i] > likeness[i - 1] && likeness[i] >= likeness[i + 1]) {
        found.push_back({run.place, run.bearing + 2 * static_cast<int>(i - 1), likeness[i]});
      }
    }
  }
  const auto better = [](const CoarseMatch& a, const CoarseMatch& b) {
    if (a.likeness != b.likeness) return a.likeness > b.likeness;
    return a.place != b.place ? a.place < b.place : a.bearing < b.bearing;
  };
  if (found.size() > most) {
    std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(most), found.end(),
                     better);
    found.resize(most);
  }
  std::sort(found.begin(), found.end(), better);
  return found;
}

}  // namespace vernier::localise::internal
