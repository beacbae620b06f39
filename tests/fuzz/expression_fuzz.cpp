// Any text is either an expression that has a value or none for any values of its parameters, or a
// mistake with a place in the text.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "service/model/expression.hpp"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  auto parsed = reident::Expression::parse(text);
  if (const auto* mistake = std::get_if<reident::ExpressionMistake>(&parsed)) {
    require(mistake->message.starts_with("at byte "));
    return 0;
  }
  const auto& expression = std::get<reident::Expression>(parsed);
  require(postfix_is_sound(expression.program().data(), expression.program().size()) != 0);
  std::vector<double> values(expression.variables().size(), 2.5);
  for (const double first : {0.0, -1.0, 1e300}) {
    if (!values.empty()) values[0] = first;
    require(!std::isinf(expression.evaluate(values)));
  }
  return 0;
}
