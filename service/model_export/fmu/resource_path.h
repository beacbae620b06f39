/* From the URI of an unpacked FMU's resources to the path of a file in them. */
#ifndef REIDENT_RESOURCE_PATH_H
#define REIDENT_RESOURCE_PATH_H

#include <stdlib.h>
#include <string.h>

/* Whether the URI begins with `scheme`, which is in lower case; it may be in either. */
static int scheme_ends(const char* uri, const char* scheme) {
  for (; *scheme != '\0'; ++uri, ++scheme) {
    const char c = *uri >= 'A' && *uri <= 'Z' ? (char)(*uri - 'A' + 'a') : *uri;
    if (c != *scheme) return 0;
  }
  return 1;
}

/* Returns where the path of file:/path, file:///path or file://localhost/path begins; else NULL. */
static const char* uri_path(const char* uri) {
  if (!scheme_ends(uri, "file:")) return NULL;
  const char* at = uri + 5;
  if (strncmp(at, "//", 2) == 0) {
    at += 2;
    if (scheme_ends(at, "localhost")) at += strlen("localhost");
  }
  if (*at != '/') return NULL;
#ifdef _WIN32
  if (at[1] != '\0' && at[2] == ':') ++at; /* /C:/folder */
#endif
  return at;
}

/* The value of a hexadecimal digit, or -1. */
static int uri_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/* Returns the path of `file` in the folder that the URI names, to be freed; NULL where it names
 * none or there is no memory. %XX stands for a byte other than 0. */
static char* resource_path(const char* uri, const char* file) {
  const char* at = uri_path(uri);
  if (at == NULL) return NULL;
  char* const path = malloc(strlen(at) + strlen(file) + 2);
  if (path == NULL) return NULL;
  char* end = path;
  while (*at != '\0') {
    if (*at != '%') {
      *end++ = *at++;
      continue;
    }
    const int high = uri_digit(at[1]), low = high < 0 ? -1 : uri_digit(at[2]);
    if (low < 0 || 16 * high + low == 0) {
      free(path);
      return NULL;
    }
    *end++ = (char)(16 * high + low);
    at += 3;
  }
  if (end[-1] != '/') *end++ = '/';
  strcpy(end, file);
  return path;
}

#endif
