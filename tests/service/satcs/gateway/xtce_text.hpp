// Small databases, and packets as bytes.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "service/satcs/gateway/xtce_reader.hpp"
#include "tests/support/temporary_folder.hpp"

namespace reident::test {

/// What the reader makes of the text of a file.
inline std::variant<satcs::xtce::Database, csv::Error> read_xtce(const std::string& text) {
  const TemporaryFolder folder;
  std::ofstream(folder / "database.xml") << text;
  return satcs::xtce::read_database(folder / "database.xml");
}

/// A database of one container "P" that begins with one byte "KIND". The texts go into its sets.
inline std::string xtce_text(const std::string& types, const std::string& parameters,
                             const std::string& entries, const std::string& containers = {}) {
  return "<SpaceSystem name='S' xmlns='http://www.omg.org/spec/XTCE/20180204'>\n"
         "<TelemetryMetaData><ParameterTypeSet>\n"
         "<IntegerParameterType name='Header'><IntegerDataEncoding sizeInBits='48'/>"
         "</IntegerParameterType>\n"
         "<IntegerParameterType name='Byte'><IntegerDataEncoding/></IntegerParameterType>\n" +
         types +
         "</ParameterTypeSet><ParameterSet>\n"
         "<Parameter name='HEADER' parameterTypeRef='Header'/>\n"
         "<Parameter name='KIND' parameterTypeRef='Byte'/>\n" +
         parameters +
         "</ParameterSet><ContainerSet><SequenceContainer name='P'><EntryList>\n"
         "<ParameterRefEntry parameterRef='HEADER'/><ParameterRefEntry parameterRef='KIND'/>\n" +
         entries + "</EntryList></SequenceContainer>" + containers +
         "</ContainerSet></TelemetryMetaData></SpaceSystem>\n";
}

inline satcs::xtce::Database database_of(const std::string& text) {
  auto read = read_xtce(text);
  if (const auto* error = std::get_if<csv::Error>(&read)) {
    ADD_FAILURE() << error->message;
    return {};
  }
  return std::get<satcs::xtce::Database>(std::move(read));
}

/// A space packet of APID 1 whose data, behind the primary header, are these bytes.
inline std::vector<std::uint8_t> packet_of(const std::vector<std::uint8_t>& data,
                                           std::uint16_t count = 0, std::uint16_t apid = 1) {
  const std::size_t length = data.size() - 1;
  std::vector<std::uint8_t> packet{
      static_cast<std::uint8_t>(0x08 | (apid >> 8)),  static_cast<std::uint8_t>(apid),
      static_cast<std::uint8_t>(0xc0 | (count >> 8)), static_cast<std::uint8_t>(count),
      static_cast<std::uint8_t>(length >> 8),         static_cast<std::uint8_t>(length)};
  packet.insert(packet.end(), data.begin(), data.end());
  return packet;
}

}  // namespace reident::test
