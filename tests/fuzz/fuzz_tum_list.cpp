// SPDX-License-Identifier: Apache-2.0
// Any bytes as the lists of a TUM folder: rgb.txt and depth.txt (split at the first zero byte), or an
// associations file.
#include <algorithm>
#include <string_view>

#include "plvo/replay/index/tum_index.hpp"
#include "scratch_file.hpp"

namespace {

void check(const plvo::Status& status, const plvo::SequenceIndex& index) {
  using plvo::fuzz::require;
  if (!status.ok()) return require(!std::string_view(status.message()).empty());
  require(!index.pairs.empty());
  for (std::size_t i = 1; i < index.pairs.size(); ++i)
    require(index.pairs[i - 1].colour.stamp_ns < index.pairs[i].colour.stamp_ns);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plvo;
  const std::uint8_t* split = std::find(data, data + size, std::uint8_t{0});
  const auto first = static_cast<std::size_t>(split - data);
  const std::size_t rest = first < size ? first + 1 : size;
  fuzz::write_scratch("rgb.txt", data, first);
  fuzz::write_scratch("depth.txt", data + rest, size - rest);
  SequenceIndex lists;
  check(read_tum_index(fuzz::scratch_folder(), {}, 20'000'000, lists), lists);
  SequenceIndex associated;
  const auto associations = fuzz::write_scratch("associations.txt", data, size);
  check(read_tum_index(fuzz::scratch_folder(), associations, 20'000'000, associated), associated);
  return 0;
}
