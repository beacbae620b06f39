#include "service/security/openssl.hpp"

#include <algorithm>
#include <ctime>
#include <initializer_list>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <openssl/bn.h>
#include <openssl/ec.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

namespace reident::security {
namespace {

constexpr std::int64_t second = 1'000'000'000;
constexpr int serial_bits = 120;

template <auto Free>
struct Freeing {
  template <class T>
  void operator()(T* object) const {
    Free(object);
  }
};
using Bio = std::unique_ptr<BIO, Freeing<BIO_free_all>>;
using Digest = std::unique_ptr<EVP_MD_CTX, Freeing<EVP_MD_CTX_free>>;
using SignedDocument = std::unique_ptr<PKCS7, Freeing<PKCS7_free>>;
using Number = std::unique_ptr<BIGNUM, Freeing<BN_free>>;
using Serial = std::unique_ptr<ASN1_INTEGER, Freeing<ASN1_INTEGER_free>>;
using Instant = std::unique_ptr<ASN1_TIME, Freeing<ASN1_TIME_free>>;

void demand(bool done, const char* what) {
  if (!done) throw std::runtime_error(std::string("OpenSSL cannot ") + what);
}

Bio memory() {
  Bio bio(BIO_new(BIO_s_mem()));
  demand(bio != nullptr, "have memory");
  return bio;
}

Bio reading(std::string_view text) {
  Bio bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
  demand(bio != nullptr, "have memory");
  return bio;
}

std::string text_of(const Bio& bio) {
  char* begin = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &begin);
  return {begin, static_cast<std::size_t>(size)};
}

Instant instant(std::int64_t time) {
  Instant result(ASN1_TIME_set(nullptr, time / second));
  demand(result != nullptr, "write a time");
  return result;
}

std::int64_t time_of(const ASN1_TIME* time) {
  std::tm parts{};
  demand(time != nullptr && ASN1_TIME_to_tm(time, &parts) == 1, "read a time");
  return static_cast<std::int64_t>(timegm(&parts)) * second;
}

void add_entry(X509_NAME* name, const char* field, const std::string& value) {
  if (value.empty()) return;
  demand(X509_NAME_add_entry_by_txt(name, field, MBSTRING_UTF8,
                                    reinterpret_cast<const unsigned char*>(value.data()),
                                    static_cast<int>(value.size()), -1, 0) == 1,
         "name a subject");
}

std::string entry(const X509_NAME* name, int field) {
  const int at = X509_NAME_get_index_by_NID(name, field, -1);
  if (at < 0) return {};
  unsigned char* text = nullptr;
  const int size =
      ASN1_STRING_to_UTF8(&text, X509_NAME_ENTRY_get_data(X509_NAME_get_entry(name, at)));
  if (size < 0) return {};
  std::string result(reinterpret_cast<char*>(text), static_cast<std::size_t>(size));
  OPENSSL_free(text);
  return result;
}

void add_extension(X509* certificate, int field, const char* value) {
  X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, nullptr, field, value);
  const bool added = extension != nullptr && X509_add_ext(certificate, extension, -1) == 1;
  X509_EXTENSION_free(extension);
  demand(added, "extend a certificate");
}

void extend(X509* certificate, Purpose purpose) {
  switch (purpose) {
    case Purpose::identity_authority:
      add_extension(certificate, NID_basic_constraints, "critical,CA:TRUE,pathlen:0");
      add_extension(certificate, NID_key_usage, "critical,keyCertSign,cRLSign");
      return;
    case Purpose::permissions_authority:  // signs documents and no certificate but its own
      add_extension(certificate, NID_basic_constraints, "critical,CA:TRUE,pathlen:0");
      add_extension(certificate, NID_key_usage, "critical,digitalSignature,keyCertSign");
      return;
    case Purpose::member:
      add_extension(certificate, NID_basic_constraints, "critical,CA:FALSE");
      add_extension(certificate, NID_key_usage, "critical,digitalSignature,keyAgreement");
      return;
  }
}

void number(X509* certificate) {
  const Number random(BN_new());
  demand(random != nullptr &&
             BN_rand(random.get(), serial_bits, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY) == 1 &&
             BN_to_ASN1_INTEGER(random.get(), X509_get_serialNumber(certificate)) != nullptr,
         "draw a serial number");
}

int no_password(char*, int, int, void*) {
  return 0;  // an encrypted key is refused rather than asked about
}

std::optional<std::vector<unsigned char>> from_hexadecimal(std::string_view text) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
  };
  if (text.size() % 2 != 0) return std::nullopt;
  std::vector<unsigned char> bytes;
  for (std::size_t i = 0; i < text.size(); i += 2) {
    const int high = digit(text[i]), low = digit(text[i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    bytes.push_back(static_cast<unsigned char>(16 * high + low));
  }
  return bytes;
}

}  // namespace

void OpensslDeleter::operator()(X509* certificate) const {
  X509_free(certificate);
}
void OpensslDeleter::operator()(X509_CRL* list) const {
  X509_CRL_free(list);
}
void OpensslDeleter::operator()(EVP_PKEY* key) const {
  EVP_PKEY_free(key);
}

Key make_key() {
  Key key(EVP_EC_gen("P-256"));
  demand(key != nullptr, "make a key");
  return key;
}

std::string pem(const Certificate& certificate) {
  const Bio bio = memory();
  demand(PEM_write_bio_X509(bio.get(), certificate.get()) == 1, "write a certificate");
  return text_of(bio);
}

std::string pem(const RevocationList& list) {
  const Bio bio = memory();
  demand(PEM_write_bio_X509_CRL(bio.get(), list.get()) == 1, "write a list of revocations");
  return text_of(bio);
}

std::string pem(const Key& key) {
  const Bio bio = memory();
  demand(PEM_write_bio_PrivateKey(bio.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr) == 1,
         "write a key");
  return text_of(bio);
}

Certificate read_certificate(const std::string& text) {
  return Certificate(PEM_read_bio_X509(reading(text).get(), nullptr, no_password, nullptr));
}

RevocationList read_revocation_list(const std::string& text) {
  return RevocationList(PEM_read_bio_X509_CRL(reading(text).get(), nullptr, no_password, nullptr));
}

Key read_key(const std::string& text) {
  return Key(PEM_read_bio_PrivateKey(reading(text).get(), nullptr, no_password, nullptr));
}

Certificate issue(const Subject& subject, Purpose purpose, const Validity& validity, const Key& key,
                  const Certificate& issuer, const Key& issuer_key) {
  Certificate certificate(X509_new());
  demand(certificate != nullptr && X509_set_version(certificate.get(), X509_VERSION_3) == 1,
         "make a certificate");
  number(certificate.get());
  X509_NAME* name = X509_get_subject_name(certificate.get());
  add_entry(name, "O", subject.organisation);
  add_entry(name, "OU", subject.unit);
  add_entry(name, "CN", subject.name);
  X509* const by = issuer ? issuer.get() : certificate.get();
  extend(certificate.get(), purpose);
  demand(X509_set_issuer_name(certificate.get(), X509_get_subject_name(by)) == 1 &&
             X509_set1_notBefore(certificate.get(), instant(validity.begin).get()) == 1 &&
             X509_set1_notAfter(certificate.get(), instant(validity.end).get()) == 1 &&
             X509_set_pubkey(certificate.get(), key.get()) == 1 &&
             X509_sign(certificate.get(), (issuer ? issuer_key : key).get(), EVP_sha256()) > 0,
         "sign a certificate");
  return certificate;
}

Subject subject_of(const Certificate& certificate) {
  const X509_NAME* name = X509_get_subject_name(certificate.get());
  return {entry(name, NID_organizationName), entry(name, NID_organizationalUnitName),
          entry(name, NID_commonName)};
}

std::string subject_text(const Certificate& certificate) {
  const Bio bio = memory();
  demand(X509_NAME_print_ex(bio.get(), X509_get_subject_name(certificate.get()), 0,
                            XN_FLAG_RFC2253) >= 0,
         "write a subject");
  return text_of(bio);
}

Validity validity_of(const Certificate& certificate) {
  return {time_of(X509_get0_notBefore(certificate.get())),
          time_of(X509_get0_notAfter(certificate.get()))};
}

std::string serial_of(const Certificate& certificate) {
  const Number serial(ASN1_INTEGER_to_BN(X509_get0_serialNumber(certificate.get()), nullptr));
  char* text = BN_bn2hex(serial.get());
  demand(text != nullptr, "write a serial number");
  std::string result(text);
  OPENSSL_free(text);
  return result;
}

bool is_pair(const Certificate& certificate, const Key& key) {
  return X509_check_private_key(certificate.get(), key.get()) == 1;
}

bool is_signed_by(const Certificate& certificate, const Certificate& authority) {
  return X509_NAME_cmp(X509_get_issuer_name(certificate.get()),
                       X509_get_subject_name(authority.get())) == 0 &&
         X509_verify(certificate.get(), X509_get0_pubkey(authority.get())) == 1;
}

bool has_same_key(const Certificate& one, const Certificate& other) {
  return EVP_PKEY_eq(X509_get0_pubkey(one.get()), X509_get0_pubkey(other.get())) == 1;
}

RevocationList revoke(const RevocationList& before, const Certificate& revoked,
                      const Validity& validity, const Certificate& authority, const Key& key) {
  RevocationList list(before ? X509_CRL_dup(before.get()) : X509_CRL_new());
  demand(list != nullptr && X509_CRL_set_version(list.get(), X509_CRL_VERSION_2) == 1 &&
             X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(authority.get())) == 1,
         "make a list of revocations");
  if (revoked && !is_revoked(revoked, list)) {
    X509_REVOKED* row = X509_REVOKED_new();
    const Serial serial(ASN1_INTEGER_dup(X509_get0_serialNumber(revoked.get())));
    demand(row != nullptr && serial != nullptr &&
               X509_REVOKED_set_serialNumber(row, serial.get()) == 1 &&
               X509_REVOKED_set_revocationDate(row, instant(validity.begin).get()) == 1 &&
               X509_CRL_add0_revoked(list.get(), row) == 1,
           "revoke a certificate");
  }
  demand(X509_CRL_set1_lastUpdate(list.get(), instant(validity.begin).get()) == 1 &&
             X509_CRL_set1_nextUpdate(list.get(), instant(validity.end).get()) == 1 &&
             X509_CRL_sort(list.get()) == 1 &&
             X509_CRL_sign(list.get(), key.get(), EVP_sha256()) > 0,
         "sign a list of revocations");
  return list;
}

bool is_signed_by(const RevocationList& list, const Certificate& authority) {
  return X509_CRL_verify(list.get(), X509_get0_pubkey(authority.get())) == 1;
}

bool is_revoked(const Certificate& certificate, const RevocationList& list) {
  X509_REVOKED* row = nullptr;
  return X509_CRL_get0_by_cert(list.get(), &row, certificate.get()) == 1;
}

Validity validity_of(const RevocationList& list) {
  return {time_of(X509_CRL_get0_lastUpdate(list.get())),
          time_of(X509_CRL_get0_nextUpdate(list.get()))};
}

std::string sign_document(const std::string& text, const Certificate& authority, const Key& key) {
  constexpr int flags = PKCS7_DETACHED | PKCS7_TEXT;
  const SignedDocument document(
      PKCS7_sign(authority.get(), key.get(), nullptr, reading(text).get(), flags));
  demand(document != nullptr, "sign a document");
  const Bio out = memory();
  demand(SMIME_write_PKCS7(out.get(), document.get(), reading(text).get(), flags) == 1,
         "write a signed document");
  return text_of(out);
}

std::optional<std::string> signed_text(const std::string& document, const Certificate& authority) {
  BIO* raw_content = nullptr;
  const SignedDocument parsed(SMIME_read_PKCS7(reading(document).get(), &raw_content));
  const Bio content(raw_content);
  if (!parsed || !content) return std::nullopt;
  STACK_OF(X509)* signers = sk_X509_new_null();
  demand(signers != nullptr && sk_X509_push(signers, authority.get()) > 0, "have memory");
  const Bio out = memory();
  // The signer is this authority, whatever certificates the document brings.
  const int verified = PKCS7_verify(parsed.get(), signers, nullptr, content.get(), out.get(),
                                    PKCS7_TEXT | PKCS7_NOINTERN | PKCS7_NOVERIFY);
  sk_X509_free(signers);
  if (verified != 1) return std::nullopt;
  return text_of(out);
}

std::string sign_bytes(std::string_view bytes, const Key& key) {
  const Digest digest(EVP_MD_CTX_new());
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  std::size_t size = 0;
  demand(digest != nullptr &&
             EVP_DigestSignInit(digest.get(), nullptr, EVP_sha256(), nullptr, key.get()) == 1 &&
             EVP_DigestSign(digest.get(), nullptr, &size, data, bytes.size()) == 1,
         "sign");
  std::vector<unsigned char> signature(size);
  demand(EVP_DigestSign(digest.get(), signature.data(), &size, data, bytes.size()) == 1, "sign");
  std::string text;
  for (std::size_t i = 0; i < size; ++i) text += fmt::format("{:02x}", signature[i]);
  return text;
}

bool is_signature(std::string_view signature, std::string_view bytes,
                  const Certificate& certificate) {
  const auto raw = from_hexadecimal(signature);
  const Digest digest(EVP_MD_CTX_new());
  return raw && digest != nullptr &&
         EVP_DigestVerifyInit(digest.get(), nullptr, EVP_sha256(), nullptr,
                              X509_get0_pubkey(certificate.get())) == 1 &&
         EVP_DigestVerify(digest.get(), raw->data(), raw->size(),
                          reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()) == 1;
}

}  // namespace reident::security
