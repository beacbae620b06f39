// The one digest of the project: of models, samples, configurations and kept files.
#pragma once

#include <string>
#include <string_view>

namespace reident {

/// Returns SHA-256 of the bytes as 64 lower-case hexadecimal digits. Throws std::runtime_error
/// where OpenSSL does not provide it (a restricted provider). Any thread may call it.
std::string sha256_hex(std::string_view bytes);

}  // namespace reident
