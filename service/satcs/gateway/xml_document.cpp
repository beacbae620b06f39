#include "service/satcs/gateway/xml_document.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>

#include <libxml/parser.h>
#include <libxml/tree.h>

#include "service/support/text.hpp"

namespace reident::satcs {
namespace {

std::string_view view(const xmlChar* text) {
  return text == nullptr ? std::string_view() : reinterpret_cast<const char*>(text);
}

struct FreeText {
  void operator()(xmlChar* text) const { xmlFree(text); }
};
using OwnedText = std::unique_ptr<xmlChar, FreeText>;

struct FreeContext {
  void operator()(xmlParserCtxtPtr context) const { xmlFreeParserCtxt(context); }
};

/// The first error of a reading, with its line.
void keep_first(void* context, xmlErrorPtr error) {
  auto* first = static_cast<std::string*>(static_cast<xmlParserCtxtPtr>(context)->_private);
  if (!first->empty()) return;
  *first = "line " + std::to_string(error->line) + ": is no XML: " + error->message;
  while (!first->empty() && first->back() == '\n') first->pop_back();
}

std::string name_in_path(_xmlNode* node) {
  std::string text(view(node->name));
  const XmlElement element(node);
  for (const char* key : {"name", "parameterRef", "containerRef"})
    if (const auto name = element.attribute(key)) return text + "[" + *name + "]";
  return text;
}

}  // namespace

std::string_view XmlElement::name() const {
  return view(node_->name);
}

std::optional<std::string> XmlElement::attribute(const char* name) const {
  const OwnedText value(xmlGetNoNsProp(node_, reinterpret_cast<const xmlChar*>(name)));
  if (!value) return std::nullopt;
  return std::string(trimmed(view(value.get())));
}

std::vector<std::string> XmlElement::attributes() const {
  std::vector<std::string> names;
  for (const xmlAttr* one = node_->properties; one != nullptr; one = one->next)
    if (one->ns == nullptr) names.emplace_back(view(one->name));
  return names;
}

std::vector<XmlElement> XmlElement::children() const {
  std::vector<XmlElement> elements;
  for (_xmlNode* one = node_->children; one != nullptr; one = one->next)
    if (one->type == XML_ELEMENT_NODE) elements.emplace_back(one);
  return elements;
}

std::optional<XmlElement> XmlElement::child(std::string_view name) const {
  for (const XmlElement& one : children())
    if (one.name() == name) return one;
  return std::nullopt;
}

std::string XmlElement::text() const {
  const OwnedText text(xmlNodeGetContent(node_));
  return std::string(trimmed(view(text.get())));
}

long XmlElement::line() const {
  return xmlGetLineNo(node_);
}

std::string XmlElement::path() const {
  std::string path;
  for (_xmlNode* one = node_; one != nullptr && one->type == XML_ELEMENT_NODE; one = one->parent)
    path = name_in_path(one) + (path.empty() ? "" : "/") + path;
  return path;
}

void XmlDocument::Free::operator()(_xmlDoc* document) const {
  xmlFreeDoc(document);
}

std::variant<XmlDocument, csv::Error> XmlDocument::read(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file))
    return csv::Error{file.string() + ": cannot be read; check the path"};
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (bytes.size() > std::numeric_limits<int>::max())
    return csv::Error{file.string() + ": is larger than 2 GiB, and no database"};
  const std::unique_ptr<xmlParserCtxt, FreeContext> context(xmlNewParserCtxt());
  if (!context) throw std::bad_alloc();
  std::string first_error;
  context->_private = &first_error;
  context->sax->serror = keep_first;
  // Entities stay as they are, and no other file is opened.
  constexpr int options = XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING |
                          XML_PARSE_NOBLANKS | XML_PARSE_BIG_LINES;
  XmlDocument document(xmlCtxtReadMemory(
      context.get(), bytes.data(), static_cast<int>(bytes.size()), file.c_str(), nullptr, options));
  if (document.document_ && xmlDocGetRootElement(document.document_.get()) != nullptr)
    return document;
  return csv::Error{file.string() + ": " + (first_error.empty() ? "is no XML" : first_error)};
}

XmlElement XmlDocument::root() const {
  return XmlElement(xmlDocGetRootElement(document_.get()));
}

}  // namespace reident::satcs
