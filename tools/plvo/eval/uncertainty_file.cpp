// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/uncertainty_file.hpp"

#include <fmt/core.h>

#include "plvo/host/files/input_file.hpp"
#include "plvo/host/files/stamp_text.hpp"
#include "plvo/host/files/table_reader.hpp"
#include "plvo/host/files/trajectory_reader.hpp"

namespace plvo::eval {
namespace {

constexpr std::size_t kFull = 36;
constexpr std::size_t kUpper = 21;
constexpr std::size_t kMostMatrices = kMostRows / 4;  // a matrix is up to four times as large as a pose

// Parses the covariance in the columns from `first` to the end of the row.
Status parse_covariance(const std::filesystem::path& path, const TableRow& row, std::size_t first,
                        Matrix6& covariance) {
  const std::size_t columns = row.words.size();
  if (columns != first + kFull && columns != first + kUpper) {
    return row_error(path, row,
                     fmt::format("has {} columns where {} (full) or {} (upper triangle) are expected",
                                 columns, first + kFull, first + kUpper));
  }
  std::vector<double> values(columns - first);
  if (Status status = parse_numbers(path, row, first, values); !status.ok()) return status;
  std::size_t next = 0;
  for (int r = 0; r < 6; ++r)
    for (int c = values.size() == kFull ? 0 : r; c < 6; ++c) covariance(r, c) = values[next++];
  if (values.size() == kUpper)
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < r; ++c) covariance(r, c) = covariance(c, r);
  return {};
}

}  // namespace

Status read_covariances(const std::filesystem::path& path, std::vector<StampedCovariance>& covariances) {
  covariances.clear();
  const Status status = each_row(
      path, kMaxTextBytes,
      [&](const TableRow& row) -> Status {
        StampedCovariance next;
        if (!parse_stamp_ns(row.words[0], next.stamp_ns))
          return row_error(path, row, stamp_error(row.words[0]));
        if (Status parsed = parse_covariance(path, row, 1, next.covariance); !parsed.ok()) return parsed;
        covariances.push_back(next);
        return {};
      },
      kMostMatrices);
  sort_by_stamp(covariances);
  return status;
}

Status read_motions(const std::filesystem::path& path, std::vector<UncertainMotion>& motions) {
  motions.clear();
  const Status status = each_row(
      path, kMaxTextBytes,
      [&](const TableRow& row) -> Status {
        UncertainMotion next;
        if (row.words.size() < 2 || !parse_stamp_ns(row.words[0], next.stamp_ns) ||
            !parse_stamp_ns(row.words[1], next.reference_stamp_ns))
          return row_error(path, row, "expected two stamps in seconds first");
        if (Status parsed = parse_pose(path, row, 2, next.T_camera_reference); !parsed.ok()) return parsed;
        if (Status parsed = parse_covariance(path, row, 9, next.covariance); !parsed.ok()) return parsed;
        motions.push_back(next);
        return {};
      },
      kMostMatrices);
  sort_by_stamp(motions);
  return status;
}

}  // namespace plvo::eval
