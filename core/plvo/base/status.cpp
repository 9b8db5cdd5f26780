// SPDX-License-Identifier: Apache-2.0
#include "plvo/base/status.hpp"

namespace plvo {

const char* to_string(StatusCode code) {
  switch (code) {
    case StatusCode::kOk: return "ok";
    case StatusCode::kInvalidArgument: return "invalid_argument";
    case StatusCode::kOutOfMemory: return "out_of_memory";
    case StatusCode::kNotFound: return "not_found";
    case StatusCode::kPermission: return "permission";
    case StatusCode::kBusy: return "busy";
    case StatusCode::kDamaged: return "damaged";
    case StatusCode::kEndOfStream: return "end_of_stream";
    case StatusCode::kTimeout: return "timeout";
    case StatusCode::kUnplugged: return "unplugged";
    case StatusCode::kUnsupported: return "unsupported";
    case StatusCode::kIo: return "io";
    case StatusCode::kTooFewFeatures: return "too_few_features";
    case StatusCode::kNoConsensus: return "no_consensus";
    case StatusCode::kDegenerate: return "degenerate";
    case StatusCode::kNotConverged: return "not_converged";
  }
  return "unknown";
}

}  // namespace plvo
