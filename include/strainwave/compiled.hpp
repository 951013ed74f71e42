#pragma once

/// Mark of the functions that take most of the time of a step: a kernel inlines every call in them, once, not for each stage.
/// NVRTC inlines every call anyway, and compiles for minutes where it does that for each stage. Local structs of them are not
/// const: GCC keeps a const one in memory, where reading what was just written takes a twentieth of a step.
#if defined(__CUDACC_RTC__)
#define SW_RATES __noinline__
#elif defined(SW_INLINE_RATES)
#define SW_RATES [[gnu::flatten, gnu::noinline]]
#else
#define SW_RATES
#endif

namespace strainwave {

/// The law as the integrator wants it: rearranged for speed where the law knows how.
template <class Law>
constexpr auto compiled(const Law& law) {
    if constexpr (requires { law.compile(); })
        return law.compile();
    else
        return law;
}

}  // namespace strainwave
