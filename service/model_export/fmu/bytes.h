/* Bytes that are the same on every machine: a checksum, and numbers of eight bytes, the lowest
 * byte first. */
#ifndef REIDENT_BYTES_H
#define REIDENT_BYTES_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* FNV-1a of 64 bits: finds damage by accident, not forgery. */
static uint64_t bytes_checksum(const unsigned char* bytes, size_t count) {
  uint64_t sum = 0xcbf29ce484222325u;
  for (size_t i = 0; i < count; ++i) sum = (sum ^ bytes[i]) * 0x100000001b3u;
  return sum;
}

/* Each put_ writes eight bytes at `at` and returns where the next ones go; each get_ reads eight. A
 * double keeps its bits, those of a NaN too. */
static unsigned char* put_whole(unsigned char* at, uint64_t value) {
  for (int i = 0; i < 8; ++i) at[i] = (unsigned char)(value >> (8 * i));
  return at + 8;
}

static uint64_t get_whole(const unsigned char* at) {
  uint64_t value = 0;
  for (int i = 0; i < 8; ++i) value |= (uint64_t)at[i] << (8 * i);
  return value;
}

static unsigned char* put_real(unsigned char* at, double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return put_whole(at, bits);
}

static double get_real(const unsigned char* at) {
  const uint64_t bits = get_whole(at);
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

#endif
