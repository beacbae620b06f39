// Expressions as an FMU evaluates them, compared with Expression::evaluate.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/service/model_export/export_fixture.hpp"
#include "tests/service/model_export/fmu_host.hpp"

namespace reident::test::expression_test {
namespace {

/// Expressions of the whole grammar over a, b and c.
class RandomExpressions {
 public:
  explicit RandomExpressions(std::uint64_t seed) : noise_(seed) {}

  std::string next() { return conditional(4); }

 private:
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>(noise_.uniform() * static_cast<double>(count));
  }
  std::string conditional(int depth) {
    const std::string first = comparison(depth);
    if (depth == 0 || below(6) != 0) return first;
    return first + " ? " + conditional(depth - 1) + " : " + conditional(depth - 1);
  }
  std::string comparison(int depth) {
    static const char* const kinds[] = {" < ", " <= ", " > ", " >= ", " == ", " != "};
    const std::string first = sum(depth);
    return below(5) == 0 ? first + kinds[below(6)] + sum(depth) : first;
  }
  std::string sum(int depth) {
    std::string text = term(depth);
    while (below(3) == 0) text += (below(2) == 0 ? " + " : " - ") + term(depth);
    return text;
  }
  std::string term(int depth) {
    std::string text = factor(depth);
    while (below(3) == 0) text += (below(2) == 0 ? " * " : " / ") + factor(depth);
    return text;
  }
  std::string factor(int depth) {
    static const char* const signs[] = {"", "", "-", "+"};
    const std::string text = signs[below(4)] + value(depth);
    return depth > 0 && below(8) == 0 ? text + "^" + factor(depth - 1) : text;
  }
  std::string value(int depth) {
    static const char* const leaves[] = {"a", "b", "c", "2", "0.1", "1e-3", "3.25", "0"};
    if (depth == 0 || below(3) == 0) return leaves[below(8)];
    switch (below(4)) {
      case 0:
        return "abs(" + conditional(depth - 1) + ")";
      case 1:
        return "min(" + conditional(depth - 1) + ", " + conditional(depth - 1) + ")";
      case 2:
        return "max(" + conditional(depth - 1) + ", " + conditional(depth - 1) + ")";
      default:
        return "(" + conditional(depth - 1) + ")";
    }
  }

  Noise noise_;
};

/// A model whose outputs are its inputs, each an expression over a, b and c.
model_export::ExportedVersion evaluating(const std::vector<std::string>& expressions) {
  const int count = static_cast<int>(expressions.size());
  auto exported = random_version({1, count, count, true, 1, expressions}, 1);
  identification::StateSpaceModel& dynamics = exported.version.model.dynamics;
  dynamics.C.setZero();
  dynamics.D.setIdentity();
  dynamics.u0.setZero();
  dynamics.y0.setZero();
  exported.version.digest = model_digest(exported.version.model);
  return exported;
}

TEST(FmuExpressions, HaveTheBitsOfTheService) {
  RandomExpressions random(20170717);
  std::vector<std::string> texts;
  std::vector<Expression> expressions;
  std::size_t with_powers = 0;
  while (texts.size() < 400) {
    std::string text = random.next();
    auto parsed = Expression::parse(text);
    if (text.size() > Expression::max_bytes || std::get<Expression>(parsed).variables().empty())
      continue;
    if (text.find('^') != std::string::npos) ++with_powers;
    expressions.push_back(std::get<Expression>(std::move(parsed)));
    texts.push_back(std::move(text));
  }
  EXPECT_GT(with_powers, 50U);
  EXPECT_LT(with_powers, 350U);

  const auto exported = evaluating(texts);
  const UnpackedFmu fmu(
      model_export::fmu_file(exported, model_export::FmiVersion::two, REIDENT_FMU_PARTS));
  const FmuBinary binary(fmu.binary());
  const auto variables = model_export::fmu_variables(exported.version.model);
  ASSERT_EQ(variables.inputs.size(), 3U);
  FmuInstance instance(binary, exported.version.digest, fmu.resources(), 3, texts.size());
  ASSERT_NE(instance.component, nullptr) << instance.logged();
  instance.start();

  Noise noise(3);
  std::vector<double> last(texts.size(), 0);
  std::size_t finite = 0;
  for (int k = 0; k < 60; ++k) {
    std::vector<double> values = random_inputs(noise, 3);
    if (k % 5 == 0) values[static_cast<std::size_t>(k / 5 % 3)] = 0;
    if (k % 7 == 0) values[1] = values[0];
    ASSERT_EQ(instance.set(values), fmi2OK);
    const std::vector<double> outputs = instance.outputs();
    ASSERT_LE(instance.step(1), fmi2Warning);
    for (std::size_t i = 0; i < texts.size(); ++i) {
      std::vector<double> operands;
      for (const std::string& name : expressions[i].variables())
        operands.push_back(values[model_export::place_of(variables.inputs, name)]);
      const double expected = expressions[i].evaluate(operands);
      finite += std::isfinite(expected) ? 1U : 0U;
      if (std::isfinite(expected)) last[i] = expected;
      EXPECT_EQ(outputs[i], last[i]) << texts[i];
    }
  }
  EXPECT_GT(finite, texts.size() * 60 / 2);
}

}  // namespace
}  // namespace reident::test::expression_test
