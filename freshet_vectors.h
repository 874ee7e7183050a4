// freshet_vectors.h — functions compiled once for each width of vectors, the widest chosen when the program
// starts.
//
// FRESHET_WIDE stands before a function whose loops the compiler vectorises. One binary then holds the
// function for AVX-512, for AVX2 and for plain x86-64. All give the same bits: nothing is contracted to fused
// multiply-add (CMakeLists.txt), and a sum's order is written in its loop, never left to the vectors' width.
// What such a function calls is compiled for the width only where it is inlined. With the CMake option
// FRESHET_WIDE_VECTORS off, on other processors, and under the sanitizers whose start-up comes after the
// choice, there is the one plain version.
#pragma once

#if defined(FRESHET_WIDE_VECTORS) && defined(__x86_64__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__SANITIZE_ADDRESS__)
#define FRESHET_WIDE __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define FRESHET_WIDE
#endif
