// SPDX-License-Identifier: Apache-2.0
// Sequences as named on the command line.
#pragma once

#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/bench/jobs/job.hpp"

namespace plvo::bench {

// Parses DIR or DIR=MODEL. The last part of each path, made printable, names the sequence. Returns
// kInvalidArgument if two names are equal or the model is unknown, and kNotFound if the folder does not
// exist.
Status name_folders(const std::vector<std::string>& folders, std::vector<NamedFolder>& sequences);

}  // namespace plvo::bench
