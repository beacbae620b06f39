// Any file is an XTCE database, by which any packet is decoded or refused with a reason, or an
// error with a message. The bytes are the file, or places and new bytes of a good one; a packet
// follows the first zero.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "service/satcs/gateway/packet_decoder.hpp"
#include "service/satcs/gateway/xtce_reader.hpp"
#include "tests/fuzz/memory_file.hpp"

namespace {

using namespace reident;
using Bytes = std::span<const std::uint8_t>;

void require(bool condition) {
  if (!condition) std::abort();
}

/// Small, since each input is a whole file.
const std::string good_database = R"(<SpaceSystem name="S"><TelemetryMetaData><ParameterTypeSet>
<IntegerParameterType name="B"><IntegerDataEncoding sizeInBits="8"/></IntegerParameterType>
<FloatParameterType name="F"><IntegerDataEncoding sizeInBits="12" encoding="twosComplement">
<DefaultCalibrator><PolynomialCalibrator><Term coefficient="-1" exponent="0"/><Term coefficient="2"
exponent="1"/></PolynomialCalibrator></DefaultCalibrator></IntegerDataEncoding></FloatParameterType>
<FloatParameterType name="L"><IntegerDataEncoding sizeInBits="4"><DefaultCalibrator>
<SplineCalibrator order="1" extrapolate="true"><SplinePoint raw="0" calibrated="1"/><SplinePoint
raw="9" calibrated="5"/></SplineCalibrator></DefaultCalibrator></IntegerDataEncoding>
</FloatParameterType><FloatParameterType name="R"><FloatDataEncoding sizeInBits="32"/>
</FloatParameterType><EnumeratedParameterType name="E"><IntegerDataEncoding sizeInBits="8"/>
<EnumerationList><Enumeration value="1" label="ON"/></EnumerationList></EnumeratedParameterType>
<StringParameterType name="T"><StringDataEncoding><SizeInBits><Fixed><FixedValue>32</FixedValue>
</Fixed><TerminationChar>00</TerminationChar></SizeInBits></StringDataEncoding></StringParameterType>
<BinaryParameterType name="D"><BinaryDataEncoding><SizeInBits><DynamicValue><ParameterInstanceRef
parameterRef="K"/><LinearAdjustment slope="8"/></DynamicValue></SizeInBits></BinaryDataEncoding>
</BinaryParameterType></ParameterTypeSet><ParameterSet><Parameter name="K" parameterTypeRef="B"/>
<Parameter name="f" parameterTypeRef="F"/><Parameter name="l" parameterTypeRef="L"/>
<Parameter name="r" parameterTypeRef="R"/><Parameter name="e" parameterTypeRef="E"/>
<Parameter name="t" parameterTypeRef="T"/><Parameter name="d" parameterTypeRef="D"/></ParameterSet>
<ContainerSet><SequenceContainer name="P" abstract="true"><EntryList>
<ParameterRefEntry parameterRef="K"/></EntryList></SequenceContainer><SequenceContainer name="Q">
<EntryList><ParameterRefEntry parameterRef="f"/><ParameterRefEntry parameterRef="l"/>
<ParameterRefEntry parameterRef="r"><LocationInContainerInBits><FixedValue>3</FixedValue>
</LocationInContainerInBits></ParameterRefEntry><ParameterRefEntry parameterRef="e"/>
<ParameterRefEntry parameterRef="t"/><ParameterRefEntry parameterRef="d"><IncludeCondition>
<Comparison parameterRef="e" value="ON"/></IncludeCondition></ParameterRefEntry></EntryList>
<BaseContainer containerRef="P"><RestrictionCriteria><Comparison parameterRef="K" value="2"
comparisonOperator="&gt;="/></RestrictionCriteria></BaseContainer></SequenceContainer></ContainerSet>
</TelemetryMetaData></SpaceSystem>)";

/// What stands before the first zero, which is taken away with it.
Bytes until_zero(Bytes& data) {
  const auto zero = std::find(data.begin(), data.end(), std::uint8_t{0});
  const Bytes before(data.begin(), zero);
  data = zero == data.end() ? Bytes() : Bytes(zero + 1, data.end());
  return before;
}

std::string changed_database(Bytes changes) {
  std::string changed = good_database;
  for (; changes.size() >= 3; changes = changes.subspan(3))
    changed[(changes[0] + 256U * changes[1]) % changed.size()] = static_cast<char>(changes[2]);
  return changed;
}

void decode(const satcs::xtce::Database& database, Bytes packet) {
  satcs::PacketDecoder decoder(database);
  std::vector<storage::Sample> samples;
  for (int i = 0; i < 2; ++i) {
    const satcs::DecodedPacket decoded = decoder.decode(packet, samples);
    if (decoded.outcome == satcs::DecodedPacket::Outcome::too_short)
      require(!decoded.detail.empty());
    for (const storage::Sample& sample : samples)
      require(sample.parameter < database.parameters.size());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const test::MemoryFile file;
  if (size == 0) return 0;
  Bytes data(bytes + 1, size - 1);
  const Bytes text = until_zero(data);
  file.write(bytes[0] % 2 == 0 ? std::string(text.begin(), text.end()) : changed_database(text));
  const auto read = satcs::xtce::read_database(file.path());
  if (const auto* error = std::get_if<csv::Error>(&read)) {
    require(!error->message.empty());
    return 0;
  }
  const auto& database = std::get<satcs::xtce::Database>(read);
  for (const satcs::xtce::Note& note : database.notes) require(!note.what.empty());
  decode(database, data);
  return 0;
}
