// Sends a command under the number of one that was given before, as a copy of it that comes late,
// for the end-to-end tests. Prints the reply.
// Usage: repeat_command DOMAIN PARTITION SERVICE ACTION REQUESTER REQUEST ACTOR REASON

#include <chrono>
#include <iostream>
#include <stdexcept>

#include "service/cli/command_sender.hpp"

namespace {

std::string repeat(char** argv) {
  reident::storage::Command command;
  command.action = argv[4];
  command.requester = argv[5];
  command.request = std::stoull(argv[6]);
  command.actor = argv[7];
  command.reason = argv[8];
  reident::cli::CommandSender sender({static_cast<std::uint32_t>(std::stoul(argv[1])), argv[2]},
                                     {command, argv[3]});
  const auto outcome = sender.wait(std::chrono::seconds(30));
  if (!outcome) throw std::runtime_error("no reply");
  return outcome->reply;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 9) return 2;
    std::cout << repeat(argv) << "\n";
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
