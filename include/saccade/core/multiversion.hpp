#pragma once

/// Put before a hot loop's function: the compiler makes one version for any x86-64 and one for AVX2 + FMA processors,
/// and the program picks at run time. Elsewhere (other processors, clang, sanitizer builds) it is nothing.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define SACCADE_MULTIVERSION __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define SACCADE_MULTIVERSION
#endif
