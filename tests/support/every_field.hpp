// Walks over every field of a version and its model, for tests of what writes or reads them: a
// field that visit_fields names and a format forgets makes such a test fail, with its name.
#pragma once

#include <bit>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "service/model/model_fields.hpp"
#include "service/model/model_json.hpp"

namespace reident::test {

/// Calls leaf(path, Field, member) for each text, number and matrix below a struct, such as
/// "inputs[0].name". Optional fields that are absent have none.
template <class Leaf>
class LeafWalk {
 public:
  LeafWalk(std::string prefix, Leaf& leaf) : prefix_(std::move(prefix)), leaf_(leaf) {}

  template <class Member>
  void operator()(const Field& field, Member& member) const {
    if (field.presence == Presence::optional && is_absent(member)) return;
    walk(prefix_ + std::string(field.name), field, member);
  }

 private:
  template <class Member>
  void walk(const std::string& path, const Field& field, Member& member) const {
    if constexpr (std::is_same_v<std::remove_const_t<Member>, std::vector<Signal>>) {
      for (std::size_t i = 0; i < member.size(); ++i)
        visit_fields(member[i], LeafWalk(path + "[" + std::to_string(i) + "].", leaf_));
    } else if constexpr (requires { member.has_value(); }) {
      walk(path, field, *member);
    } else if constexpr (requires { visit_fields(member, *this); }) {
      visit_fields(member, LeafWalk(path + ".", leaf_));
    } else {
      leaf_(path, field, member);
    }
  }

  std::string prefix_;
  Leaf& leaf_;
};

template <class Leaf>
void visit_leaves(StructOf<EquipmentModel> auto& model, Leaf&& leaf) {
  visit_fields(model, LeafWalk("", leaf));
}
template <class Leaf>
void visit_leaves(StructOf<ModelVersion> auto& version, Leaf&& leaf) {
  visit_fields(version, LeafWalk("", leaf));
  visit_leaves(version.model, leaf);
}

/// "inputs.name" of "inputs[0].name".
inline std::string without_places(const std::string& path) {
  std::string name;
  bool in_brackets = false;
  for (const char c : path) {
    in_brackets = c == '[' || (in_brackets && c != ']');
    if (!in_brackets && c != ']') name += c;
  }
  return name;
}

inline std::string bits_of(const std::string& text) {
  return text;
}
inline std::string bits_of(std::int64_t number) {
  return std::to_string(number);
}
inline std::string bits_of(bool truth) {
  return truth ? "true" : "false";
}
inline std::string bits_of(double number) {
  return std::to_string(std::bit_cast<std::uint64_t>(number));
}
inline std::string bits_of(const identification::Matrix& matrix) {
  std::string text = std::to_string(matrix.rows()) + "x" + std::to_string(matrix.cols());
  for (const double number : matrix.reshaped()) text += " " + bits_of(number);
  return text;
}

template <class Struct>
std::map<std::string, std::string> bits_of_leaves(const Struct& value) {
  std::map<std::string, std::string> leaves;
  visit_leaves(value, [&leaves](const std::string& path, const Field&, const auto& leaf) {
    leaves[path] = bits_of(leaf);
  });
  return leaves;
}

/// The paths of the fields that one has and the other has not, or with other bits.
template <class Struct>
std::vector<std::string> differing_fields(const Struct& a, const Struct& b) {
  std::vector<std::string> paths;
  const auto of_a = bits_of_leaves(a), of_b = bits_of_leaves(b);
  for (const auto& [path, bits] : of_a)
    if (const auto other = of_b.find(path); other == of_b.end() || other->second != bits)
      paths.push_back(path);
  for (const auto& [path, bits] : of_b)
    if (!of_a.contains(path)) paths.push_back(path);
  return paths;
}

/// Gives each field a value that no other field has, such as a receiver takes.
class DistinctValues {
 public:
  template <class Member>
  void operator()(const Field& field, Member& member) {
    set(field, member);
  }

 private:
  static identification::Index size(Extent extent) {
    switch (extent) {
      case Extent::n:
        return 5;
      case Extent::m:
        return 3;
      case Extent::p:
        return 2;
      case Extent::two_p:
        return 4;
      case Extent::one:
        break;
    }
    return 1;
  }

  /// Also an expression.
  void set(const Field&, std::string& text) {
    const std::string number = std::to_string(++last_);
    text = number + " * T" + number;
  }
  void set(const Field&, std::int64_t& number) { number = ++last_; }
  void set(const Field&, double& number) { number = ++last_ + 1.0 / 3; }
  void set(const Field&, bool& truth) { truth = true; }
  void set(const Field& field, identification::Matrix& matrix) {
    matrix.resize(size(field.rows), size(field.columns));
    for (double& number : matrix.reshaped()) set(field, number);
  }
  void set(const Field& field, identification::Vector& vector) {
    vector.resize(size(field.rows));
    for (double& number : vector) set(field, number);
  }
  void set(const Field& field, std::vector<Signal>& signals) {
    signals.resize(static_cast<std::size_t>(size(field.rows)));
    for (Signal& signal : signals) set(field, signal);
  }
  template <class Value>
  void set(const Field& field, std::optional<Value>& value) {
    set(field, value.emplace());
  }
  void set(const Field&, const identification::Index&) {}
  template <class Struct>
  void set(const Field&, Struct& value) {
    visit_fields(value, *this);
  }

  int last_ = 0;
};

/// A version with all that a version can have.
inline ModelVersion distinct_version() {
  ModelVersion version;
  DistinctValues values;
  visit_fields(version, values);
  visit_fields(version.model, values);
  for (Signal& output : version.model.outputs) output.expression.clear();  // it is measured
  return version;
}

inline void change(std::string& text) {
  text += " + 1";
}
inline void change(std::int64_t& number) {
  ++number;
}
inline void change(bool& truth) {
  truth = !truth;
}
/// By the last bit.
inline void change(double& number) {
  number = std::bit_cast<double>(std::bit_cast<std::uint64_t>(number) ^ 1U);
}
inline void change(identification::Matrix& matrix) {
  change(matrix(matrix.size() - 1));
}
inline void change(identification::Vector& vector) {
  change(vector(vector.size() - 1));
}

/// Calls visit(path, Field, changed struct) once for each field, where that alone is changed.
template <class Struct, class Visit>
void for_each_change(const Struct& value, Visit&& visit) {
  Struct changed = value;
  visit_leaves(changed, [&](const std::string& path, const Field& field, auto& leaf) {
    if constexpr (!std::is_const_v<std::remove_reference_t<decltype(leaf)>>) {
      const auto before = leaf;
      change(leaf);
      visit(path, field, std::as_const(changed));
      leaf = before;
    }
  });
}

}  // namespace reident::test
