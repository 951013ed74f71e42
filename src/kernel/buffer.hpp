#pragma once
#include <cstddef>
#include <cstdlib>
#include <new>
#include <type_traits>

namespace strainwave::kernel {

/// Memory for scalars, however they are aligned. A kernel links no C++ library, so it is the C library's.
template <class S>
class Buffer {
    static_assert(std::is_trivially_destructible_v<S>);
    void* memory;
    S* first;

public:
    explicit Buffer(std::size_t count) : memory(std::malloc((count + 1) * sizeof(S) + alignof(S))) {
        if (!memory) std::abort();
        const auto address = reinterpret_cast<std::size_t>(memory);
        first = reinterpret_cast<S*>((address + alignof(S) - 1) / alignof(S) * alignof(S));
        for (std::size_t i = 0; i < count; ++i) new (first + i) S{};
    }
    Buffer(const Buffer&) = delete;
    Buffer& operator=(const Buffer&) = delete;
    ~Buffer() { std::free(memory); }

    S* data() { return first; }
    S& operator[](std::size_t i) { return first[i]; }
};

}  // namespace strainwave::kernel
