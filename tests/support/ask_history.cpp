// Asks a service for pages of its history, from one console after another, for the end-to-end
// tests. Prints how many rows came.
// Usage: ask_history DOMAIN PARTITION SUBJECT QUESTIONS CONSOLES

#include <cstdlib>
#include <iostream>

#include "service/history/remote_history.hpp"

namespace {

using namespace std::chrono_literals;
using reident::history::RemoteHistory;

std::size_t ask(char** argv) {
  reident::dds::Participant participant({static_cast<std::uint32_t>(std::stoul(argv[1])), argv[2]});
  const unsigned long questions = std::stoul(argv[4]), consoles = std::stoul(argv[5]);
  reident::HistoryQuery query;
  query.subject = argv[3];
  std::size_t rows = 0;
  for (unsigned long console = 0; console < consoles; ++console) {
    RemoteHistory remote(participant);
    for (unsigned long i = 0; i < questions / consoles; ++i) {
      auto answer = remote.page(query, 30s);
      if (const auto* failure = std::get_if<RemoteHistory::Failure>(&answer))
        throw std::runtime_error(failure->message);
      rows += std::get<reident::HistoryPage>(answer).rows.size();
    }
  }
  return rows;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 6) return 2;
    std::cout << ask(argv) << "\n";
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
