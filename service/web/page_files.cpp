#include "service/web/page_files.hpp"

#include <algorithm>
#include <array>

#include "service/support/sha256.hpp"

// A symbol at the first byte of a file and one behind its last.
#define REIDENT_FILE(symbol, file)                                                                \
  asm(".section .rodata\n.global " #symbol "\n.global " #symbol "_end\n" #symbol                  \
      ":\n.incbin \"" REIDENT_PAGE_FOLDER "/" file "\"\n" #symbol "_end:\n.byte 0\n.previous\n"); \
  extern "C" const char symbol, symbol##_end

REIDENT_FILE(reident_page_html, "dist/index.html");
REIDENT_FILE(reident_page_js, "dist/page.js");
REIDENT_FILE(reident_page_css, "dist/page.css");
REIDENT_FILE(reident_page_notices, "dist/notices.txt");
REIDENT_FILE(reident_page_icon, "dist/icon.svg");
REIDENT_FILE(reident_page_api, "../openapi.json");

namespace reident::web {
namespace {

struct PageFile {
  std::string_view path;
  std::string_view content_type;
  HttpResponse plain{}, compressed{};
  std::string etag{};
};

PageFile loaded(std::string_view path, std::string_view content_type, const char& begin,
                const char& end) {
  PageFile file{path, content_type};
  file.plain.body.assign(&begin, &end);
  file.plain.content_type = content_type;
  file.etag = "\"" + sha256_hex(file.plain.body).substr(0, 16) + "\"";
  file.plain.headers = {{"ETag", file.etag}, {"Cache-Control", "no-cache"}};
  file.compressed = file.plain;
  compress(file.compressed);
  return file;
}

const auto& files() {
  static const std::array all = {
      loaded("/", "text/html; charset=utf-8", reident_page_html, reident_page_html_end),
      loaded("/page.js", "text/javascript; charset=utf-8", reident_page_js, reident_page_js_end),
      loaded("/page.css", "text/css; charset=utf-8", reident_page_css, reident_page_css_end),
      loaded("/icon.svg", "image/svg+xml", reident_page_icon, reident_page_icon_end),
      loaded("/notices.txt", "text/plain; charset=utf-8", reident_page_notices,
             reident_page_notices_end),
      loaded("/openapi.json", "application/json", reident_page_api, reident_page_api_end)};
  return all;
}

}  // namespace

HttpResponse page_file(const HttpRequest& request) {
  const auto file = std::find_if(files().begin(), files().end(), [&request](const PageFile& one) {
    return one.path == request.path;
  });
  if (file == files().end())
    return problem(404, "not_found",
                   "there is no such address; / is the page, /openapi.json lists "
                   "the addresses for programs");
  if (request.etag == file->etag) {
    HttpResponse unchanged;
    unchanged.status = 304;
    unchanged.content_type = file->content_type;
    unchanged.headers = file->plain.headers;
    return unchanged;
  }
  return request.accepts_gzip ? file->compressed : file->plain;
}

}  // namespace reident::web
