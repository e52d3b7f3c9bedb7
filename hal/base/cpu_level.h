// SPDX-License-Identifier: Apache-2.0
// Instruction set that this build is for, by the names of the x86-64 psABI (MixrigMarch.cmake).
#pragma once

#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512CD__) && \
    defined(__AVX512DQ__) && defined(__AVX512VL__)
#define MIXRIG_CPU_LEVEL "x86-64-v4"
#elif defined(__AVX2__) && defined(__FMA__) && defined(__BMI2__) && defined(__F16C__)
#define MIXRIG_CPU_LEVEL "x86-64-v3"
#elif defined(__SSE4_2__) && defined(__POPCNT__)
#define MIXRIG_CPU_LEVEL "x86-64-v2"
#elif defined(__x86_64__)
#define MIXRIG_CPU_LEVEL "x86-64"
#elif defined(__aarch64__)
#define MIXRIG_CPU_LEVEL "arm64"
#else
#define MIXRIG_CPU_LEVEL "other"
#endif
