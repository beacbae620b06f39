#include "service/web/http.hpp"

#include <stdexcept>
#include <zlib.h>

#include <nlohmann/json.hpp>

namespace reident::web {
namespace {

constexpr std::size_t least_compressed = 860;  // below that a packet carries it anyway
constexpr int gzip_window = 15 + 16;
constexpr int level = 6;

}  // namespace

std::string_view HttpRequest::parameter(std::string_view name) const {
  for (auto one = query.rbegin(); one != query.rend(); ++one)
    if (one->first == name) return one->second;
  return {};
}

void compress(HttpResponse& response) {
  if (response.is_gzip || response.body.size() < least_compressed) return;
  z_stream stream{};
  if (deflateInit2(&stream, level, Z_DEFLATED, gzip_window, 8, Z_DEFAULT_STRATEGY) != Z_OK) return;
  std::string out(deflateBound(&stream, response.body.size()) + 32, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(response.body.data());
  stream.avail_in = static_cast<uInt>(response.body.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const bool done = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  out.resize(stream.total_out);
  deflateEnd(&stream);
  if (!done) return;
  response.body = std::move(out);
  response.is_gzip = true;
}

HttpResponse problem(int status, std::string_view code, std::string_view message) {
  const nlohmann::ordered_json body = {{"error", {{"code", code}, {"message", message}}}};
  HttpResponse response;
  response.status = status;
  response.body =
      body.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  return response;
}

}  // namespace reident::web
