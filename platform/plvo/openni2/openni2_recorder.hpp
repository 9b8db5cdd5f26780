// SPDX-License-Identifier: Apache-2.0
// Records what an open OpenNi2Camera receives into an .oni file. OpenNI2 writes all images on its own threads
// as they arrive, whether they are read or not. The format loses two facts: the offset between colour and
// depth (less than a frame), because each stream's stamps start at zero, and whether depth is registered (it
// is, unless the camera was opened otherwise).
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

  // path must end in .oni; an existing file is replaced. The camera must stay open while recording: closing
  // or unplugging it ends the recording with a valid file. Returns kUnsupported if the camera registers in
  // software (the file would contain the unregistered depth), and kIo if the folder is not writable.
  Status start(OpenNi2Camera& camera, const std::string& path);

  // To be called regularly. If the disk is almost full, ends the recording with a valid file and returns kIo
  // (OpenNI2 itself does not notice and would leave a file that cannot be opened).
  Status check();

  // Ends the recording; the file is complete when this returns.
  void stop();
  bool recording() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plvo
