// SPDX-License-Identifier: Apache-2.0
// Sequences as the command line names them.
#pragma once

#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/bench/jobs/job.hpp"

namespace plvo::bench {

// DIR, or DIR=MODEL. The last part of each path, made printable, names the sequence: kInvalidArgument when
// two are alike or the model is unknown, kNotFound when there is no such folder.
Status name_folders(const std::vector<std::string>& folders, std::vector<NamedFolder>& sequences);

}  // namespace plvo::bench
