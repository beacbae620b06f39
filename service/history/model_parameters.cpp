#include "service/history/model_parameters.hpp"

#include <stdexcept>

#include <nlohmann/json.hpp>

#include "service/model/derived_inputs.hpp"
#include "service/model/model_version.hpp"

namespace reident::history {
namespace {

/// Takes the signals, and ends the parser behind them.
class SignalTaker final : public nlohmann::json_sax<nlohmann::json> {
 public:
  std::vector<Signal> inputs, outputs;
  bool has_all() const { return taken_ == 2; }

  bool key(string_t& key) override {
    if (depth_ == 1) list_ = key == "inputs" ? &inputs : key == "outputs" ? &outputs : nullptr;
    key_ = key;
    return true;
  }
  bool string(string_t& text) override {
    if (!is_in_signal()) return true;
    if (key_ == "name") list_->back().name = text;
    if (key_ == "expression") list_->back().expression = text;
    return true;
  }
  bool start_object(std::size_t) override {
    ++depth_;
    if (is_in_signal()) list_->emplace_back();
    return true;
  }
  bool end_object() override {
    --depth_;
    return true;
  }
  bool start_array(std::size_t) override {
    ++depth_;
    return true;
  }
  bool end_array() override {
    --depth_;
    if (depth_ == 1 && list_ != nullptr) ++taken_;
    return !has_all();
  }
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception&) override {
    return false;
  }

 private:
  bool is_in_signal() const { return list_ != nullptr && depth_ == 3; }

  std::vector<Signal>* list_ = nullptr;  // of the key of the model that is read
  string_t key_;
  int depth_ = 0, taken_ = 0;
};

}  // namespace

std::vector<std::string> parameters_of(const std::string& model_json) {
  SignalTaker model;
  nlohmann::json::sax_parse(model_json, &model);
  if (!model.has_all()) throw std::invalid_argument("a model without inputs or outputs");
  auto names =
      InputExpressions(signal_names(model.inputs), derived_inputs(model.inputs)).parameters();
  for (const Signal& output : model.outputs) names.push_back(output.name);
  return names;
}

}  // namespace reident::history
