// Keys, certificates and signed documents by OpenSSL's library, owned. service/security alone
// includes it. Calls throw std::runtime_error where OpenSSL fails on what should not fail.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <openssl/types.h>

namespace reident::security {

struct OpensslDeleter {
  void operator()(X509* certificate) const;
  void operator()(X509_CRL* list) const;
  void operator()(EVP_PKEY* key) const;
};
using Certificate = std::unique_ptr<X509, OpensslDeleter>;
using RevocationList = std::unique_ptr<X509_CRL, OpensslDeleter>;
using Key = std::unique_ptr<EVP_PKEY, OpensslDeleter>;

/// An elliptic key on P-256.
Key make_key();

// PEM in both directions. What is no such PEM text gives null.

std::string pem(const Certificate& certificate);
std::string pem(const RevocationList& list);
std::string pem(const Key& key);
Certificate read_certificate(const std::string& text);
RevocationList read_revocation_list(const std::string& text);
Key read_key(const std::string& text);

/// Subject of a certificate: O=organisation, OU=unit, CN=name; no unit for an authority.
struct Subject {
  std::string organisation, unit, name;
};

/// From the first instant to the last, nanoseconds since 1970 UTC; whole seconds.
struct Validity {
  std::int64_t begin = 0;
  std::int64_t end = 0;
};

enum class Purpose { identity_authority, permissions_authority, member };

/// A certificate for the public part of `key` with a random serial number, signed by the issuer's
/// key; by `key` itself without an issuer.
Certificate issue(const Subject& subject, Purpose purpose, const Validity& validity, const Key& key,
                  const Certificate& issuer, const Key& issuer_key);

Subject subject_of(const Certificate& certificate);
/// "CN=ana,OU=operator,O=Ground" (RFC 2253), as permissions name their subject.
std::string subject_text(const Certificate& certificate);
Validity validity_of(const Certificate& certificate);
/// Hexadecimal.
std::string serial_of(const Certificate& certificate);
bool is_pair(const Certificate& certificate, const Key& key);
bool is_signed_by(const Certificate& certificate, const Certificate& authority);
bool has_same_key(const Certificate& one, const Certificate& other);

/// A list that revokes what `before` revokes (null: nothing) and `revoked` (null: nothing more).
RevocationList revoke(const RevocationList& before, const Certificate& revoked,
                      const Validity& validity, const Certificate& authority, const Key& key);
bool is_signed_by(const RevocationList& list, const Certificate& authority);
bool is_revoked(const Certificate& certificate, const RevocationList& list);
/// Its end is the time of the next update.
Validity validity_of(const RevocationList& list);

/// The text as an S/MIME document that the authority signs, as DDS Security has it.
std::string sign_document(const std::string& text, const Certificate& authority, const Key& key);
/// The text of a document that the authority signed; absent where it did not, or nothing is signed.
std::optional<std::string> signed_text(const std::string& document, const Certificate& authority);

/// A signature (ECDSA with SHA-256) in hexadecimal.
std::string sign_bytes(std::string_view bytes, const Key& key);
bool is_signature(std::string_view signature, std::string_view bytes,
                  const Certificate& certificate);

}  // namespace reident::security
