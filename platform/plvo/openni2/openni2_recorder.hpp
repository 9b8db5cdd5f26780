// SPDX-License-Identifier: Apache-2.0
// Records what an open OpenNi2Camera receives into an .oni file. OpenNI2 writes on its own threads as images
// arrive, read or not. Two things the format loses: each stream's stamps start at zero (the offset between
// colour and depth is gone, less than a frame), and whether depth was registered (it is, unless the camera
// was opened otherwise).
#pragma once

#include <memory>
#include <string>

#include "plvo/base/status.hpp"

namespace plvo {

class OpenNi2Camera;

class OpenNi2Recorder {
 public:
  OpenNi2Recorder();
  ~OpenNi2Recorder();
  OpenNi2Recorder(const OpenNi2Recorder&) = delete;
  OpenNi2Recorder& operator=(const OpenNi2Recorder&) = delete;

  // path ends in .oni (it is replaced if it exists). The camera must stay open while recording: closing it,
  // or an unplug, ends the recording with a valid file. kUnsupported while a camera registers in software
  // (the file would hold the unregistered depth), kIo when the folder cannot be written to.
  Status start(OpenNi2Camera& camera, const std::string& path);

  // Call now and then: kIo, after having ended the recording with a valid file, when the disk is about to be
  // full (OpenNI2 itself does not notice and would leave a file that cannot be opened).
  Status check();

  // Ends the recording; the file is complete when this returns.
  void stop();
  bool recording() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plvo
