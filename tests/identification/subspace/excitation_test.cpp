#include "identification/subspace/excitation.hpp"

#include <gmock/gmock.h>

#include "tests/support/systems.hpp"

namespace reident::identification::excitation_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Redundancy, ASumOfOtherInputsIsNamedWithThem) {
  test::Noise noise(1);
  Matrix u = noise.normal(200, 4);
  u.col(3) = u.col(0) + 2 * u.col(2);
  const auto found = redundant_inputs(u);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].input, 3);
  EXPECT_THAT(found[0].explained_by, ElementsAre(0, 2));
}

TEST(Redundancy, ASumWithNoiseOfItsOwnIsKept) {
  test::Noise noise(2);
  Matrix u = noise.normal(200, 3);
  u.col(2) = u.col(0) + u.col(1) + 1e-4 * noise.normal(200, 1);
  EXPECT_THAT(redundant_inputs(u), IsEmpty());
}

TEST(Excitation, CountsBlockRowsUntilAllInputsAreForetold) {
  Matrix innovations = Matrix::Ones(5, 2);
  EXPECT_EQ(excitation_of(innovations).order, 5);
  innovations(3, 1) = 1e-12;
  EXPECT_EQ(excitation_of(innovations).order, 5);
  innovations.col(1).tail(2).setConstant(1e-12);
  innovations(4, 0) = 1e-12;
  EXPECT_EQ(excitation_of(innovations).order, 4);
  EXPECT_EQ(excitation_of(innovations).strongest_input, 0);
}

}  // namespace
}  // namespace reident::identification::excitation_test
