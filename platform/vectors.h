// platform/vectors.h — functions compiled for each width of vectors; the widest is chosen at the start.
//
// FRESHET_WIDE stands before a function whose loops the compiler vectorises. One binary then holds the
// function for AVX-512, for AVX2 and for plain x86-64. All give the same bits: nothing is contracted to fused
// multiply-add (CMakeLists.txt), and a sum's order is written in its loop, never left to the vectors' width.
// What such a function calls is compiled for the width only where it is inlined. With the CMake option
// FRESHET_WIDE_VECTORS off, on other processors, and under the sanitizers, whose start-up comes after the choice,
// there is the one plain version.
//
// Where the code itself needs the width, vector_bytes() says it, and the file has a function for each
// (query/index/bit_sums.cc), under the sanitizers too.
#pragma once

#if defined(FRESHET_WIDE_VECTORS) && defined(__x86_64__)
#define FRESHET_HAS_WIDE 1
#else
#define FRESHET_HAS_WIDE 0
#endif
#if FRESHET_HAS_WIDE && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define FRESHET_WIDE __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define FRESHET_WIDE
#endif

namespace freshet {

/// Bytes of the widest vectors that code may use here: 64, 32 or 16.
inline int vector_bytes() {
#if FRESHET_HAS_WIDE
  if (__builtin_cpu_supports("x86-64-v4")) return 64;
  if (__builtin_cpu_supports("x86-64-v3")) return 32;
#endif
  return 16;
}

}  // namespace freshet
