// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/sequences/rendered_sequence.hpp"

#include <fmt/core.h>

#include <memory>

#include "plvo/simulator/simulated_camera.hpp"
#include "plvo/simulator/tum_folder.hpp"

namespace plvo::bench {

namespace fs = std::filesystem;

Status render_sequence(const SimulatorOptions& options, const fs::path& folder) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return {};
  std::unique_ptr<SimulatedCamera> camera;
  if (Status status = SimulatedCamera::create(options, camera); !status.ok()) return status;
  const fs::path part = folder.string() + ".part";
  fs::remove_all(part, error);
  fs::create_directories(folder.parent_path(), error);
  if (Status status = write_tum_folder(*camera, part.string()); !status.ok()) return status;
  fs::rename(part, folder, error);
  if (error) return {StatusCode::kIo, fmt::format("{}: {}", folder.string(), error.message())};
  return {};
}

}  // namespace plvo::bench
