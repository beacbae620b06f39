#include "service/satcs/gateway/xtce_reader.hpp"

#include <algorithm>
#include <set>

#include "service/satcs/gateway/xtce_context.hpp"

namespace reident::satcs::xtce {
namespace {

constexpr std::uint64_t primary_header_bits = 48;
constexpr int deepest = 64;  // space systems in each other, and aggregates

std::optional<Kind> kind_of(std::string_view element) {
  if (element == "IntegerParameterType") return Kind::integer;
  if (element == "FloatParameterType") return Kind::real;
  if (element == "BooleanParameterType") return Kind::boolean;
  if (element == "EnumeratedParameterType") return Kind::state;
  if (element == "StringParameterType") return Kind::text;
  if (element == "BinaryParameterType") return Kind::binary;
  if (element == "AggregateParameterType") return Kind::aggregate;
  if (element == "AbsoluteTimeParameterType" || element == "RelativeTimeParameterType")
    return Kind::real;
  return std::nullopt;
}

/// An element that becomes the thing of this index.
struct Found {
  XmlElement element;
  std::string space;
  Index index;
};

class Builder {
 public:
  explicit Builder(Context& context) : context_(context) {}

  void build(const XmlElement& root) {
    collect(root, "", 0);
    for (const Found& one : types_)
      if (type(one).kind == Kind::aggregate) read_members(one);
    for (const Found& one : parameters_) describe(one);
    name_parameters();
    for (const Found& one : types_) read_type(context_, one.element, one.space, type(one));
    for (const Found& one : containers_)
      read_container(context_, one.element, one.space, context_.database.containers[one.index]);
    join_containers();
    choose_published();
  }

 private:
  void collect(const XmlElement& system, const std::string& above, int depth);
  void collect_telemetry(const XmlElement& telemetry, const std::string& space);
  void add_type(const XmlElement& element, const std::string& space);
  void read_members(const Found& found);
  void describe(const Found& found);
  Index add_parameter(const std::string& path, Index type, std::string description, int depth);
  void name_parameters();
  void join_containers();
  void choose_published();
  void gather(const Container& container, std::set<Index>& reached, std::set<Index>& visited) const;
  std::set<Index> header_of(const Container& root) const;
  ParameterType& type(const Found& found) { return context_.database.types[found.index]; }

  Context& context_;
  std::vector<Found> types_, parameters_, containers_;
  std::map<Index, std::string> short_names_;
};

void Builder::collect(const XmlElement& system, const std::string& above, int depth) {
  if (depth > deepest) return context_.note(system, "systems are nested too deep; it is left out");
  const std::string space = above + "/" + system.attribute("name").value_or("");
  for (const XmlElement& child : system.children()) {
    if (child.name() == "TelemetryMetaData") collect_telemetry(child, space);
    if (child.name() == "SpaceSystem") collect(child, space, depth + 1);
  }
  context_.note_others(system,
                       {"TelemetryMetaData", "SpaceSystem", "CommandMetaData", "ServiceSet"},
                       "it is left out");
}

void Builder::collect_telemetry(const XmlElement& telemetry, const std::string& space) {
  Database& database = context_.database;
  for (const XmlElement& set : telemetry.children()) {
    for (const XmlElement& element : set.children()) {
      const std::string path = space + "/" + element.attribute("name").value_or("");
      if (set.name() == "ParameterTypeSet") add_type(element, space);
      if (set.name() == "ParameterSet" && element.name() == "Parameter")
        parameters_.push_back({element, space, 0});
      if (set.name() == "ContainerSet" && element.name() == "SequenceContainer") {
        if (!context_.containers.add(path, database.containers.size())) {
          context_.note(element, "a second container of this name is left out");
          continue;
        }
        containers_.push_back({element, space, database.containers.size()});
        database.containers.push_back({.path = path,
                                       .name = element.attribute("name").value_or(""),
                                       .is_abstract = element.attribute("abstract") == "true"});
      }
    }
    if (set.name() == "ParameterSet") context_.note_others(set, {"Parameter"}, "it is left out");
    if (set.name() == "ContainerSet")
      context_.note_others(set, {"SequenceContainer"}, "it is left out");
  }
  context_.note_others(telemetry, {"ParameterTypeSet", "ParameterSet", "ContainerSet"},
                       "it is left out");
}

void Builder::add_type(const XmlElement& element, const std::string& space) {
  const auto kind = kind_of(element.name());
  const std::string name = element.attribute("name").value_or("");
  if (!kind) {
    if (element.name() != "LongDescription")
      context_.note(element, "a type that is not known; its parameters are left out");
    return;
  }
  Database& database = context_.database;
  if (!context_.types.add(space + "/" + name, database.types.size()))
    return context_.note(element, "a second type of this name is left out");
  types_.push_back({element, space, database.types.size()});
  database.types.push_back({});
  database.types.back().name = name;
  database.types.back().kind = *kind;
}

void Builder::read_members(const Found& found) {
  const auto list = found.element.child("MemberList");
  if (!list) return;
  for (const XmlElement& member : list->children()) {
    const auto of = context_.types.find(found.space, member.attribute("typeRef").value_or(""));
    if (of)
      type(found).members.emplace_back(member.attribute("name").value_or(""), *of);
    else
      context_.note(member, "its type is not known; what follows it has no known place");
    if (!of) type(found).is_usable = false;
  }
}

void Builder::describe(const Found& found) {
  const XmlElement& element = found.element;
  const auto of =
      context_.types.find(found.space, element.attribute("parameterTypeRef").value_or(""));
  const std::string path = found.space + "/" + element.attribute("name").value_or("");
  if (!of) return context_.note(element, "its type is not known; it is left out");
  if (context_.parameters.find("", path))
    return context_.note(element, "a second parameter of this name is left out");
  std::string description = element.attribute("shortDescription").value_or("");
  if (const auto text = element.child("LongDescription"); description.empty() && text)
    description = text->text();
  const Index index = add_parameter(path, *of, description, 0);
  short_names_[index] = element.attribute("name").value_or("");
  context_.note_others(element, {"ParameterProperties"}, "it is not used");
}

Index Builder::add_parameter(const std::string& path, Index of, std::string description,
                             int depth) {
  Database& database = context_.database;
  const Index index = database.parameters.size();
  context_.parameters.add(path, index);
  database.parameters.push_back({path, {}, of, description, {}});
  if (depth > deepest) return index;
  for (const auto& [name, member] : database.types[of].members) {
    const Index part = add_parameter(path + "/" + name, member, description, depth + 1);
    database.parameters[index].members.push_back(part);
  }
  return index;
}

void Builder::name_parameters() {
  Database& database = context_.database;
  const auto dotted = [](std::string path) {
    std::replace(path.begin(), path.end(), '/', '.');
    return path;
  };
  // A member's short name begins with that of its aggregate.
  for (Index i = 0; i < database.parameters.size(); ++i)
    for (const Index member : database.parameters[i].members)
      short_names_[member] = short_names_[i] + database.parameters[member].path.substr(
                                                   database.parameters[i].path.size());
  std::map<std::string, int> uses;
  for (const auto& [index, name] : short_names_) ++uses[name];
  for (Index i = 0; i < database.parameters.size(); ++i) {
    Parameter& one = database.parameters[i];
    const std::size_t below_root = one.path.find('/', 1) + 1;
    one.name = dotted(uses[short_names_[i]] == 1 ? short_names_[i] : one.path.substr(below_root));
  }
}

void Builder::join_containers() {
  Database& database = context_.database;
  std::set<Index> included;
  for (Index i = 0; i < database.containers.size(); ++i) {
    const Container& one = database.containers[i];
    std::size_t steps = 0;
    auto base = one.base;
    while (base && ++steps <= database.containers.size()) base = database.containers[*base].base;
    if (base) {
      context_.note(containers_[i].element, "its base is itself; it is left out");
      database.containers[i].base.reset();
      database.containers[i].entries.clear();
      included.insert(i);
    } else if (one.base) {
      database.containers[*one.base].heirs.push_back(i);
    }
    for (const Entry& entry : one.entries)
      if (entry.what == Entry::What::container) included.insert(entry.index);
  }
  for (Index i = 0; i < database.containers.size(); ++i) {
    const Container& one = database.containers[i];
    const bool leads_nowhere = one.is_abstract && one.heirs.empty();
    if (!one.base && one.is_decidable && !included.contains(i) && !leads_nowhere)
      database.roots.push_back(i);
  }
}

void Builder::gather(const Container& container, std::set<Index>& reached,
                     std::set<Index>& visited) const {
  const Database& database = context_.database;
  const auto add = [&](const auto& self, Index parameter) -> void {
    reached.insert(parameter);
    for (const Index member : database.parameters[parameter].members) self(self, member);
  };
  for (const Entry& entry : container.entries) {
    if (entry.what == Entry::What::parameter) add(add, entry.index);
    if (entry.what == Entry::What::container && visited.insert(entry.index).second)
      gather(database.containers[entry.index], reached, visited);
  }
  if (container.base && visited.insert(*container.base).second)
    gather(database.containers[*container.base], reached, visited);
  for (const Index heir : container.heirs)
    if (visited.insert(heir).second) gather(database.containers[heir], reached, visited);
}

std::set<Index> Builder::header_of(const Container& root) const {
  const Database& database = context_.database;
  std::set<Index> header;
  std::uint64_t bits = 0;
  const auto add = [&](const auto& self, Index parameter) -> void {
    const Parameter& one = database.parameters[parameter];
    for (const Index member : one.members) self(self, member);
    if (!one.members.empty() || bits >= primary_header_bits) return;
    const auto& encoding = database.types[one.type].encoding;
    if (encoding) header.insert(parameter);
    bits += encoding ? encoding->size.bits : primary_header_bits;
  };
  for (const Entry& entry : root.entries) {
    if (entry.what != Entry::What::parameter || entry.location.from_begin) break;
    add(add, entry.index);
  }
  return header;
}

void note_compared(const Condition& condition, std::set<Index>& parameters) {
  if (condition.kind == Condition::Kind::comparison) parameters.insert(condition.parameter);
  for (const Condition& part : condition.parts) note_compared(part, parameters);
}

void Builder::choose_published() {
  Database& database = context_.database;
  for (const Container& container : database.containers)
    if (container.criteria) note_compared(*container.criteria, database.identifying);
  std::set<Index> reached, visited, header;
  for (const Index root : database.roots) {
    gather(database.containers[root], reached, visited);
    header.merge(header_of(database.containers[root]));
  }
  for (const Index parameter : reached) {
    const ParameterType& of = database.types[database.parameters[parameter].type];
    const bool is_number = of.kind == Kind::integer || of.kind == Kind::real ||
                           of.kind == Kind::boolean || of.kind == Kind::state;
    if (is_number && of.is_usable && of.encoding && !header.contains(parameter))
      database.published.push_back(parameter);
  }
}

}  // namespace

std::variant<Database, csv::Error> read_database(const std::filesystem::path& file) {
  auto document = XmlDocument::read(file);
  if (auto* error = std::get_if<csv::Error>(&document)) return std::move(*error);
  const XmlElement root = std::get<XmlDocument>(document).root();
  if (root.name() != "SpaceSystem")
    return csv::Error{file.string() + ": line " + std::to_string(root.line()) + ": the root is '" +
                      std::string(root.name()) + "'; an XTCE database begins with SpaceSystem"};
  Context context;
  context.database.name = root.attribute("name").value_or("");
  Builder(context).build(root);
  if (context.database.roots.empty())
    return csv::Error{file.string() +
                      ": no container can be a packet; the database needs a SequenceContainer "
                      "without a base"};
  auto& notes = context.database.notes;
  std::stable_sort(notes.begin(), notes.end(),
                   [](const Note& a, const Note& b) { return a.line < b.line; });
  return std::move(context.database);
}

}  // namespace reident::satcs::xtce
