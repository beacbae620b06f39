#include "service/web/accounts.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/rand.h>

#include "service/config/config_document.hpp"

namespace reident::web {
namespace {

constexpr std::uint64_t scrypt_cost = 1 << 15, scrypt_blocks = 8, scrypt_lanes = 1;
constexpr std::uint64_t scrypt_memory = 64 << 20;
constexpr std::size_t hash_bytes = 32, salt_bytes = 16;

constexpr std::array role_names = {std::pair{Role::viewer, std::string_view("viewer")},
                                   std::pair{Role::controller, std::string_view("operator")},
                                   std::pair{Role::approver, std::string_view("approver")}};

std::string hexadecimal(std::span<const unsigned char> bytes) {
  std::string text;
  for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

std::string scrypt(std::string_view password, std::string_view salt, std::uint64_t cost,
                   std::uint64_t blocks, std::uint64_t lanes) {
  std::array<unsigned char, hash_bytes> hash{};
  if (EVP_PBE_scrypt(password.data(), password.size(),
                     reinterpret_cast<const unsigned char*>(salt.data()), salt.size(), cost, blocks,
                     lanes, scrypt_memory, hash.data(), hash.size()) != 1)
    throw std::runtime_error("OpenSSL refuses scrypt with these parameters");
  return hexadecimal(hash);
}

/// The parts of a hashed password; fewer than six where it is none.
std::vector<std::string_view> parts_of(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t at = 0; at != std::string_view::npos;) {
    const std::size_t end = text.find(':', at);
    parts.push_back(text.substr(at, end == std::string_view::npos ? end : end - at));
    at = end == std::string_view::npos ? end : end + 1;
  }
  return parts;
}

std::uint64_t number(std::string_view text) {
  std::uint64_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

bool is_hashed(std::string_view text) {
  const auto parts = parts_of(text);
  return parts.size() == 6 && parts[0] == "scrypt" && number(parts[1]) >= 2 &&
         parts[5].size() == 2 * hash_bytes;
}

void read_account(const toml::table& table, ConfigDocument& document, Accounts& accounts) {
  TableReader reader(table, "[[account]]", document);
  Account account;
  reader.require("name", "name = \"Ana\"");
  account.name = reader.text("name").value_or("");
  reader.require("role", "role = \"viewer\"");
  const std::string role = reader.text("role").value_or("viewer");
  const auto* found = std::find_if(role_names.begin(), role_names.end(),
                                   [&role](const auto& one) { return one.second == role; });
  if (found == role_names.end())
    reader.mistake("role", "role is viewer, operator or approver, not " + role);
  else
    account.role = found->first;
  account.spacecraft = reader.texts("spacecraft").value_or(std::vector<std::string>());
  account.password = reader.text("password").value_or("");
  if (!account.password.empty() && !is_hashed(account.password))
    reader.mistake("password", "password is none that 'reident-web --hash-password' printed");
  reader.refuse_unknown_keys();
  const std::uint32_t line = reader.line_of("name");
  if (account.name == "gate")
    document.mistakes.push_back({line, "gate is the name of the gate; choose another"});
  else if (!accounts.emplace(account.name, account).second)
    document.mistakes.push_back({line, account.name + " has an account already; remove one"});
}

}  // namespace

std::string_view name(Role role) {
  for (const auto& [one, text] : role_names)
    if (one == role) return text;
  return "viewer";
}

bool Account::may(Role asked, std::string_view of_spacecraft) const {
  return role >= asked && (spacecraft.empty() || std::find(spacecraft.begin(), spacecraft.end(),
                                                           of_spacecraft) != spacecraft.end());
}

std::variant<Accounts, std::vector<ConfigMistake>> load_accounts(
    const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file)
    return std::vector<ConfigMistake>{{0, "cannot be read; check the path and its permissions"}};
  ConfigDocument document = parse_document(text);
  Accounts accounts;
  if (document.readable) {
    TableReader reader(document.table, "", document);
    for (const toml::table* table : reader.sections("account"))
      read_account(*table, document, accounts);
    reader.refuse_unknown_keys();
  }
  if (document.mistakes.empty()) return accounts;
  std::stable_sort(document.mistakes.begin(), document.mistakes.end(),
                   [](const auto& a, const auto& b) { return a.line < b.line; });
  return document.mistakes;
}

std::string random_text(std::size_t bytes) {
  std::vector<unsigned char> random(bytes);
  if (RAND_bytes(random.data(), static_cast<int>(bytes)) != 1)
    throw std::runtime_error("OpenSSL has no random numbers");
  return hexadecimal(random);
}

std::string hash_password(std::string_view password) {
  const std::string salt = random_text(salt_bytes);
  return fmt::format("scrypt:{}:{}:{}:{}:{}", scrypt_cost, scrypt_blocks, scrypt_lanes, salt,
                     scrypt(password, salt, scrypt_cost, scrypt_blocks, scrypt_lanes));
}

bool matches(std::string_view password, std::string_view hashed) {
  if (!is_hashed(hashed)) return false;
  const auto parts = parts_of(hashed);
  const std::string hash =
      scrypt(password, parts[4], number(parts[1]), number(parts[2]), number(parts[3]));
  return hash.size() == parts[5].size() &&
         CRYPTO_memcmp(hash.data(), parts[5].data(), hash.size()) == 0;
}

}  // namespace reident::web
