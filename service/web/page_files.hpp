// The front end as it was bundled (service/web/page), in the program itself.
#pragma once

#include <string_view>

#include "service/web/http.hpp"

namespace reident::web {

/// The file of that address: "/", "/page.js", "/page.css", "/notices.txt" or "/openapi.json"; 404
/// for any other, 304 where the client has it.
HttpResponse page_file(const HttpRequest& request);

}  // namespace reident::web
