#include <algorithm>
#include <bit>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>

#include "service/model/model_fields.hpp"
#include "service/model/model_json.hpp"
#include "service/support/sha256.hpp"

namespace reident {
namespace {

/// Appends the fields that it visits in the canonical encoding of idl/README.md, but for optional
/// ones.
class CanonicalEncoder {
 public:
  template <class Member>
  void operator()(const Field& field, const Member& member) {
    if (field.digest == Digest::undigested || field.presence == Presence::optional) return;
    if constexpr (std::same_as<Member, identification::Matrix>)
      if (field.name == "A") put(static_cast<std::uint32_t>(member.rows()));  // the order
    if (field.presence == Presence::may_be_empty)
      put(static_cast<std::uint32_t>(!is_absent(member)));
    put(member);
  }

  template <std::unsigned_integral T>
  void put(T value) {
    for (std::size_t byte = 0; byte < sizeof(T); ++byte) {
      bytes_.push_back(static_cast<char>((value >> (8 * byte)) & 0xffU));
    }
  }
  void put(std::int64_t value) { put(static_cast<std::uint64_t>(value)); }
  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }
  void put(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
  }
  void put(const std::string& text) { put(std::string_view(text)); }
  void put(const identification::Matrix& matrix) {
    for (identification::Index row = 0; row < matrix.rows(); ++row) {
      for (identification::Index column = 0; column < matrix.cols(); ++column) {
        put(matrix(row, column));
      }
    }
  }
  void put(const identification::Vector& vector) {
    for (const double value : vector) put(value);
  }
  void put(const std::vector<Signal>& signals) {
    put(static_cast<std::uint32_t>(signals.size()));
    for (const Signal& signal : signals) put(signal);
  }
  template <class Value>
  void put(const std::optional<Value>& value) {
    if (value) put(*value);
  }
  template <class Struct>
  requires std::is_class_v<Struct>
  void put(const Struct& value) { visit_fields(value, *this); }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

bool is_digested_under_a_tag(const Field& field) {
  return field.digest == Digest::digested && field.presence == Presence::optional;
}

// What older programs do not know comes last, under a tag, and only where there is any: the digests
// of models without it stay as they are. The tag of what inputs have is a plural.
void put_optional_fields(const EquipmentModel& model, CanonicalEncoder& encoder) {
  visit_signal_members([&](const Field& field, const auto member) {
    const auto absent = [member](const Signal& input) { return is_absent(input.*member); };
    if (!is_digested_under_a_tag(field) ||
        std::all_of(model.inputs.begin(), model.inputs.end(), absent))
      return;
    encoder.put(std::string(field.name) + "s");
    for (const Signal& input : model.inputs) encoder.put(input.*member);
  });
  visit_fields(model, [&](const Field& field, const auto& member) {
    if (!is_digested_under_a_tag(field) || is_absent(member)) return;
    encoder.put(field.name);
    encoder.put(member);
  });
}

}  // namespace

std::string model_digest(const EquipmentModel& model) {
  CanonicalEncoder encoder;
  encoder.put(std::string_view("reident model 1"));
  visit_fields(model, encoder);
  put_optional_fields(model, encoder);
  return sha256_hex(encoder.bytes());
}

}  // namespace reident
