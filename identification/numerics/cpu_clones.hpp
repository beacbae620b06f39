// For the few functions whose time counts: compiled for the baseline and for AVX2, and chosen by
// the loader; the two most frequent ones for AVX-512 too. All give the same bits, since no sum is
// reordered and none is fused (METHOD.md, "Speed"). Private to .cpp files: it silences a warning.
#pragma once

// Clones need the loader's indirect functions, which sanitizers and clang 14 do not go with. There,
// and on other processors, a function is compiled once.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"  // Four never crosses a call: all is inlined
#endif
// Marks a function that is compiled once for each processor.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define REIDENT_CLONES __attribute__((target_clones("avx2", "default")))
// Marks a function for processors with AVX-512, and is not defined elsewhere.
#define REIDENT_AVX512 __attribute__((target("avx512f")))
#else
#define REIDENT_CLONES
#endif

// Marks what a clone calls: inlined, so that each clone has its own, compiled for its processor.
#define REIDENT_INLINE inline __attribute__((always_inline))

namespace reident::identification {

/// Four doubles that the compiler keeps in one register where the processor has one for them, and
/// in two where it has not. Operations are entry by entry, and each rounds as that of a double
/// does.
typedef double Four __attribute__((vector_size(32)));

/// Eight of them, for AVX-512.
typedef double Eight __attribute__((vector_size(64)));

/// Returns the doubles from `from` on. They need no alignment: the copy becomes one move.
template <class Lanes = Four>
REIDENT_INLINE Lanes load(const double* from) {
  Lanes value;
  __builtin_memcpy(&value, from, sizeof value);
  return value;
}

/// Writes the doubles from `to` on, which need no alignment either.
template <class Lanes>
REIDENT_INLINE void store(double* to, const Lanes& value) {
  __builtin_memcpy(to, &value, sizeof value);
}

}  // namespace reident::identification
