// An XML file as elements with their lines, whatever library reads it.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "service/support/csv.hpp"

struct _xmlDoc;
struct _xmlNode;

namespace reident::satcs {

/// An element of a document, which has to live as long.
class XmlElement {
 public:
  explicit XmlElement(_xmlNode* node) : node_(node) {}

  /// Without the prefix of its namespace.
  std::string_view name() const;
  std::optional<std::string> attribute(const char* name) const;
  /// Names of all attributes, without those of namespaces.
  std::vector<std::string> attributes() const;
  /// The elements in it, in their order.
  std::vector<XmlElement> children() const;
  /// The first element of that name.
  std::optional<XmlElement> child(std::string_view name) const;
  /// All text in it, without the blanks at both ends.
  std::string text() const;
  long line() const;
  /// From the root, each with its own name where it has one: "SpaceSystem[SAT]/TelemetryMetaData".
  std::string path() const;

 private:
  _xmlNode* node_;
};

class XmlDocument {
 public:
  /// Reads no other file, whatever the document refers to, and nothing from a network. The error
  /// names the file, and the line where it is no XML.
  static std::variant<XmlDocument, csv::Error> read(const std::filesystem::path& file);

  XmlElement root() const;

 private:
  struct Free {
    void operator()(_xmlDoc* document) const;
  };
  explicit XmlDocument(_xmlDoc* document) : document_(document) {}
  std::unique_ptr<_xmlDoc, Free> document_;
};

}  // namespace reident::satcs
