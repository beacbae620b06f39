#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "service/satcs/faults/fault_injector.hpp"
#include "tests/service/satcs/faults/faults_fixture.hpp"

namespace reident::satcs::fault_text_test {
namespace {

using namespace test;
using testing::HasSubstr;

TEST(FaultText, SaysAllOfAFault) {
  const Fault fault = fault_of("swapped@2017-07-01T00:10:00Z/+1h:V_BAT1,V_BAT2");
  EXPECT_EQ(fault.kind, FaultKind::swapped);
  EXPECT_EQ(fault.when, (storage::TimeRange{start + 600 * second, start + 3600 * second}));
  EXPECT_EQ(fault.parameter, "V_BAT1");
  EXPECT_EQ(fault.other, "V_BAT2");
  EXPECT_FALSE(fault.magnitude);
  const Fault jump = fault_of("time_jump@2017-07-01T00:10/2017-07-01T00:20:30*-1.5");
  EXPECT_EQ(jump.when, (storage::TimeRange{start + 600 * second, start + 1230 * second}));
  EXPECT_EQ(jump.parameter, "");
  EXPECT_EQ(jump.magnitude, -1.5);
  const auto seed_of = [](std::string_view text) {
    return std::get<Fault>(parse_fault(text, start, 7)).seed;
  };
  EXPECT_EQ(seed_of("spikes@+1h/+2h:A*0.5#18446744073709551615"), UINT64_MAX);
  EXPECT_EQ(seed_of("spikes@+1h/+2h:A*0.5"), 7U);
  for (std::size_t k = 0; k < fault_kinds; ++k) {
    const auto kind = static_cast<FaultKind>(k);
    EXPECT_EQ(fault_of(std::string(name(kind)) + "@+1s/+2s").kind, kind);
  }
}

TEST(FaultText, RefusesWhatCannotBeTold) {
  struct Case {
    std::string text;
    std::string complaint;
  };
  for (const auto& [text, complaint] : {
           Case{"", "is not KIND@FROM/TO[:PARAMETER[,OTHER]][*MAGNITUDE][#SEED]"},
           Case{"stuck@+1h:A", "is not KIND@FROM/TO"},
           Case{"stuk@+1h/+2h:A", "there is no fault 'stuk'; the faults are: stuck, bias_step,"},
           Case{"stuck@noon/+2h:A", "'noon' is neither a time such as"},
           Case{"stuck@+1h/-2h:A", "'-2h' is neither a time such as"},
           Case{"stuck@+1h/+2h:A*much", "'much' is not a number"},
           Case{"stuck@+1h/+2h:A#-1", "'-1' is not a seed, a whole number from 0"},
           Case{"stuck@+2h/+2h:A",
                "the fault stuck ends at 2017-07-01T02:00:00Z, which is not after"},
           Case{"stuck@+1h/+2h", "the fault stuck needs a parameter, such as :V_BUS"},
           Case{"stuck@+1h/+2h:X",
                "the fault stuck names no parameter: 'X'; the parameters are: A, B, S"},
           Case{"spikes@+1h/+2h:S", "the fault spikes needs an analog parameter; 'S' is digital"},
           Case{"stops@+1h/+2h:A,B", "the fault stops is about one parameter; leave out 'B'"},
           Case{"stops@+1h/+2h:A*3", "the fault stops has no magnitude; leave out '*3'"},
           Case{"swapped@+1h/+2h:A", "the fault swapped needs two parameters"},
           Case{"swapped@+1h/+2h:A,A", "the fault swapped swaps 'A' with itself"},
           Case{"frames_lost@+1h/+2h:A", "is about whole frames; leave out 'A'"},
           Case{"frames_lost@+1h/+2h*1.5", "takes a share from 0 to 1 as its magnitude; 1.5 is"},
           Case{"repeated_day@+1h/+2h*-1", "takes seconds from 0 to 1e+09 as its magnitude; -1 is"},
           Case{"time_jump@+1h/+2h*1e10", "takes seconds from -1e+09 to 1e+09 as its magnitude"},
       }) {
    auto parsed = parse_fault(text, start);
    std::optional<FaultError> error;
    if (auto* wrong = std::get_if<FaultError>(&parsed))
      error = *wrong;
    else
      error = obstacle(std::get<Fault>(parsed), parameters());
    ASSERT_TRUE(error) << text;
    EXPECT_THAT(error->message, HasSubstr(complaint));
  }
  const std::vector<Fault> impossible = {fault_of("stuck@+1h/+2h:X")};
  EXPECT_THROW(FaultInjector(impossible, parameters()), std::invalid_argument);
}

}  // namespace
}  // namespace reident::satcs::fault_text_test
