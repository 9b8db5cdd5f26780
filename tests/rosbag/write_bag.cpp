// SPDX-License-Identifier: Apache-2.0
// usage: plvo_write_bag FOLDER FILE.bag PREFIX [imu]. Writes the folder as a bag, for tests in other
// languages. PREFIX precedes each topic; imu adds the folder's gyro and accelerometer on PREFIX/imu.
#include <cstdio>
#include <fstream>

#include "bag_of_folder.hpp"

int main(int argc, char** argv) {
  using namespace plvo::test;
  if (argc != 4 && argc != 5) return 2;
  const std::string prefix = argv[3];
  std::vector<RecordedMessage> messages;
  if (argc == 5) messages = published_imu(argv[1], "/imu", ImuContent::kBoth);
  const std::vector<RecordedMessage> images = published(argv[1], true);
  messages.insert(messages.end(), images.begin(), images.end());
  for (RecordedMessage& message : messages)
    if (message.topic != kNotRead) message.topic = prefix + message.topic;
  std::ofstream file(argv[2], std::ios::binary);
  file << bag_of(messages, "none");
  return file.flush() ? 0 : 1;
}
