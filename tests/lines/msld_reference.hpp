// SPDX-License-Identifier: Apache-2.0
// A slow reference implementation of MSLD in floating point, with an explicit gradient description matrix and
// any sampling.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "plvo/image/image_view.hpp"
#include "plvo/lines/msld.hpp"

namespace plvo::reference {

struct MsldSampling {
  int bands = kMsldBands;
  int rows_per_band = kMsldRowsPerBand;
  double row_pitch_px = kMsldRowPitch_px;
  int max_columns = kMsldMaxColumns;
};

inline Vector2 gradient(GrayView image, const Vector2& p) {
  const int x = static_cast<int>(std::floor(p.x() + 0.5)), y = static_cast<int>(std::floor(p.y() + 0.5));
  if (x < 1 || y < 1 || x >= image.width - 1 || y >= image.height - 1) return Vector2::Zero();
  return {static_cast<double>(image.at(x + 1, y) - image.at(x - 1, y)),
          static_cast<double>(image.at(x, y + 1) - image.at(x, y - 1))};
}

inline void normalise(std::vector<double>& v) {
  double norm = 0;
  for (double x : v) norm += x * x;
  if (norm > 0)
    for (double& x : v) x /= std::sqrt(norm);
}

inline std::vector<double> msld(GrayView image, double scale, const Segment& segment,
                                const MsldSampling& sampling = {}) {
  const Vector2 u = segment.direction(), n = segment.normal();
  const double length = segment.length_px() * scale;
  const int columns = std::max(1, std::min(sampling.max_columns, static_cast<int>(length)));
  const int rows = sampling.bands * sampling.rows_per_band;
  // The matrix has a row for each band and part, and a column for each position along the segment.
  std::vector<std::vector<double>> matrix(static_cast<std::size_t>(4 * sampling.bands),
                                          std::vector<double>(static_cast<std::size_t>(columns)));
  for (int c = 0; c < columns; ++c)
    for (int r = 0; r < rows; ++r) {
      const double row = r - 0.5 * (rows - 1);
      const Vector2 p =
          segment.a * scale + (c + 0.5) * length / columns * u + row * sampling.row_pitch_px * n;
      const Vector2 g = gradient(image, p);
      const double across = g.dot(n), along = g.dot(u);
      const double parts[4] = {std::max(across, 0.0), std::max(-across, 0.0), std::max(along, 0.0),
                               std::max(-along, 0.0)};
      const double weight = std::exp(-0.5 * std::pow(row / (0.5 * rows), 2));
      // Each row contributes to the bands by linear interpolation between their centres.
      for (int band = 0; band < sampling.bands; ++band) {
        const double centre = (band + 0.5 - 0.5 * sampling.bands) * sampling.rows_per_band;
        const double share = 1 - std::abs(row - centre) / sampling.rows_per_band;
        if (share <= 0) continue;
        for (int k = 0; k < 4; ++k)
          matrix[static_cast<std::size_t>(4 * band + k)][static_cast<std::size_t>(c)] +=
              weight * share * parts[k];
      }
    }
  std::vector<double> mean, deviation;
  for (const auto& line : matrix) {
    double sum = 0, squares = 0;
    for (double v : line) sum += v / columns;
    for (double v : line) squares += (v - sum) * (v - sum) / columns;
    mean.push_back(sum);
    deviation.push_back(std::sqrt(squares));
  }
  std::vector<double> result;
  for (std::vector<double>* half : {&mean, &deviation}) {
    normalise(*half);
    for (double& v : *half) v = std::min(v, 0.4);
    normalise(*half);
    result.insert(result.end(), half->begin(), half->end());
  }
  return result;
}

}  // namespace plvo::reference
